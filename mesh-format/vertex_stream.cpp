#include "mesh-format/vertex_stream.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <limits>

#include "mesh-format/surface.h"
#include "mesh-format/vertex_prediction.h"
#include "mesh-format/vertex_rows.h"
#include "mesh-format/zigzag.h"

namespace mesh_format {

namespace {

constexpr std::uint32_t kFramePlanes = 7;  // of quat48 and quat32

/// How much more a bit of a model's streams counts: they take twice the time to decode where frames
/// come from surfaces, or once and a half where those have no UVs.
constexpr double cost_of(FrameModel model) {
    return !has_surface(model) ? 1 : has_partner(model) ? 11.0 / 10 : 6.0 / 5;
}

bool in_digits(FrameForm form) {
    return form == FrameForm::quat48 || form == FrameForm::quat32;
}

std::uint32_t plane_count(const VertexForms& forms) {
    return position_bytes(forms.position) + uv_bytes(forms.uv) + color_bytes(forms.color) +
           (in_digits(forms.frame) ? kFramePlanes : frame_bytes(forms.frame));
}

/// The bits of a float to a number of the same order, modulo 2^32; other words stay as they are.
template <typename Word>
Word ordered(Word word) {
    if constexpr (sizeof word == 4) return word >> 31 != 0 ? ~word : word | 0x8000'0000;
    return word;
}
template <typename Word>
Word unordered(Word word) {
    if constexpr (sizeof word == 4) return word >> 31 != 0 ? word & 0x7FFF'FFFF : ~word;
    return word;
}

/// Words of the numbers of one part of the vertices, in byte planes: the lowest byte of the first
/// number of all vertices, of the second, ..., then the next bytes.
template <typename Word>
void split(std::span<const Word> words, std::size_t plane, std::size_t numbers, std::byte* planes) {
    const std::size_t count = words.size();
    for (std::size_t byte = 0; byte < sizeof(Word); ++byte) {
        std::byte* const out = planes + (byte * numbers + plane) * count;
        for (std::size_t i = 0; i < count; ++i) out[i] = std::byte(words[i] >> (8 * byte) & 0xFF);
    }
}
template <typename Word>
void join(const std::byte* planes, std::size_t plane, std::size_t numbers, std::span<Word> words) {
    const std::size_t count = words.size();
    const std::byte* const in = planes + plane * count;
    for (std::size_t i = 0; i < count; ++i) {
        Word word{};
        for (std::size_t byte = 0; byte < sizeof(Word); ++byte)
            word = static_cast<Word>(word | static_cast<Word>(in[byte * numbers * count + i])
                                                << (8 * byte));
        words[i] = unzigzag(word);
    }
}

/// A part of all vertices that is kNumbers words.
template <typename Word, std::size_t kNumbers>
class Words {
 public:
    static constexpr std::size_t kPlanes = kNumbers * sizeof(Word);

    Words(std::size_t stride, std::span<const Neighbours> neighbours)
        : stride_(stride), neighbours_(neighbours) {}

    void encode(const std::byte* vertices, std::byte* planes) const {
        std::array<std::vector<Word>, kNumbers> words;
        for (auto& each : words) each.resize(neighbours_.size());
        for (std::size_t i = 0; i < neighbours_.size(); ++i) {
            const Values value = at(vertices + i * stride_);
            const Values expected = predicted(i, vertices);
            for (std::size_t k = 0; k < kNumbers; ++k)
                words[k][i] = zigzag(static_cast<Word>(value[k] - expected[k]));
        }
        for (std::size_t k = 0; k < kNumbers; ++k) split<Word>(words[k], k, kNumbers, planes);
    }

    void decode(const std::byte* planes, std::byte* vertices) const {
        std::array<std::vector<Word>, kNumbers> words;
        for (std::size_t k = 0; k < kNumbers; ++k) {
            words[k].resize(neighbours_.size());
            join<Word>(planes, k, kNumbers, words[k]);
        }
        for (std::size_t i = 0; i < neighbours_.size(); ++i) {
            Values value = predicted(i, vertices);
            for (std::size_t k = 0; k < kNumbers; ++k)
                value[k] = unordered(static_cast<Word>(value[k] + words[k][i]));
            // One by one: processors wait where words are written and read as something longer.
            for (std::size_t k = 0; k < kNumbers; ++k)
                std::memcpy(vertices + i * stride_ + k * sizeof(Word), &value[k], sizeof(Word));
        }
    }

 private:
    using Values = std::array<Word, kNumbers>;

    static Values at(const std::byte* vertex) {
        Values values;
        for (std::size_t k = 0; k < kNumbers; ++k) {
            std::memcpy(&values[k], vertex + k * sizeof(Word), sizeof(Word));
            values[k] = ordered(values[k]);
        }
        return values;
    }

    Values predicted(std::size_t i, const std::byte* vertices) const {
        if (i == 0) return {};
        const Values a = at(vertices + neighbours_[i].a * stride_);
        const Values b = at(vertices + neighbours_[i].b * stride_);
        const Values c = at(vertices + neighbours_[i].c * stride_);
        Values sum;
        for (std::size_t k = 0; k < kNumbers; ++k) sum[k] = static_cast<Word>(a[k] + b[k] - c[k]);
        return sum;
    }

    std::size_t stride_;
    std::span<const Neighbours> neighbours_;
};

/// The tangent frames of all vertices, if they are of a form in digits.
template <FrameForm kForm, bool kHasPartner, bool kHasSurface>
class Frames {
 public:
    static constexpr std::size_t kPlanes = kFramePlanes;

    /// `surfaces` are for models that use them, for whole Rotations.
    Frames(std::size_t stride, std::span<const Neighbours> neighbours,
           std::span<const Surface> surfaces)
        : stride_(stride),
          neighbours_(neighbours),
          surfaces_(surfaces),
          frames_(neighbours.size()),
          tops_(neighbours.size()) {
        for (auto& each : words_) each.resize(neighbours.size());
    }

    void encode(const std::byte* vertices, std::byte* planes) {
        for (FrameDigits& frame : frames_) {
            frame = Code::take_apart(vertices);
            vertices += stride_;
        }
        for (std::size_t i = 0; i < frames_.size(); ++i) code<true>(i);
        split<std::uint8_t>(tops_, 0, 1, planes);
        planes += tops_.size();
        for (std::size_t k = 0; k < 3; ++k) split<std::uint16_t>(words_[k], k, 3, planes);
    }

    void decode(const std::byte* planes, std::byte* vertices) {
        std::memcpy(tops_.data(), planes, tops_.size());
        planes += tops_.size();
        for (std::size_t k = 0; k < 3; ++k) join<std::uint16_t>(planes, k, 3, words_[k]);
        for (std::size_t i = 0; i < frames_.size(); ++i) {
            code<false>(i);
            Code::put_together(frames_[i], vertices + i * stride_);
        }
    }

 private:
    using Code = FrameCode<kForm>;

    /// A vertex's frame to what it differs from the expected one by, or the other way.
    template <bool kEncode>
    void code(std::size_t i) {
        if (kHasSurface && i % Rotations::kCount == 0) rotations_of(&surfaces_[i], rotations_);
        FrameDigits& frame = frames_[i];
        const std::uint16_t top = expected_top(i);
        if constexpr (kEncode)
            tops_[i] = static_cast<std::uint8_t>(frame.top ^ top);
        else
            frame.top = tops_[i] ^ top;
        Digits expected;
        expect(i, expected);
        if constexpr (kHasPartner) {
            const std::uint32_t place = partner(frame.top & 3u);
            const std::uint32_t first = place == 0 ? 1 : 0;
            const std::uint32_t second = place == 2 ? 1 : 2;
            code_digit<kEncode>(words_[0][i], expected[first], frame.others[first]);
            code_digit<kEncode>(words_[1][i], expected[second], frame.others[second]);
            code_digit<kEncode>(words_[2][i],
                                Code::of_x_tangent(frame.others[first], frame.others[second]),
                                frame.others[place]);
        } else {
            for (std::size_t k = 0; k < 3; ++k)
                code_digit<kEncode>(words_[k][i], expected[k], frame.others[k]);
        }
    }

    std::uint16_t expected_top(std::size_t i) const {
        if constexpr (kHasSurface)
            return static_cast<std::uint16_t>(rotations_.tops[i % Rotations::kCount]);
        return i > 0 ? frames_[neighbours_[i].a].top : 0;
    }

    /// Modulo 2^16.
    void expect(std::size_t i, Digits& expected) const {
        const std::uint32_t largest = frames_[i].top & 3u;
        if constexpr (kHasSurface)
            return Code::of_rotation(rotations_, i % Rotations::kCount, largest, expected);
        if (i == 0) return expected.fill(Code::kZero);
        const Neighbours& at = neighbours_[i];
        const FrameDigits& a = frames_[at.a];
        const FrameDigits& b = frames_[at.b];
        const FrameDigits& c = frames_[at.c];
        if (((a.top ^ largest) | (b.top ^ largest) | (c.top ^ largest)) & 3u) [[unlikely]]
            return Code::rebased(a, largest, expected);
        for (std::size_t k = 0; k < 3; ++k)
            expected[k] = static_cast<std::int16_t>(a.others[k] + b.others[k] - c.others[k]);
    }

    /// Differences are modulo the number of levels, and as small as that allows.
    template <bool kEncode>
    static void code_digit(std::uint16_t& word, int expected, std::int16_t& digit) {
        if constexpr (kEncode) {
            int difference = digit - expected;
            if (difference >= (Code::kLevels + 1) / 2) difference -= Code::kLevels;
            if (difference < -(Code::kLevels / 2)) difference += Code::kLevels;
            word = zigzag(static_cast<std::uint16_t>(difference));
        } else {
            digit = static_cast<std::int16_t>(
                Code::reduced(expected + static_cast<std::int16_t>(word)));
        }
    }

    std::size_t stride_;
    std::span<const Neighbours> neighbours_;
    std::span<const Surface> surfaces_;
    Rotations rotations_{};  // of the vertices at hand
    std::vector<FrameDigits> frames_;
    std::vector<std::uint8_t> tops_;  // what differs between a frame's and the expected one
    std::array<std::vector<std::uint16_t>, 3> words_;
};

/// Calls use(part, its offset in a vertex) for each part of the vertices but frames in digits, in
/// the order in which the stream holds their planes.
template <typename Use>
void for_each_words(const VertexForms& forms, std::span<const Neighbours> neighbours, Use use) {
    const VertexLayout layout = vertex_layout(forms);
    const auto words = [&]<typename Word, std::size_t kNumbers>(std::uint32_t offset) {
        use(Words<Word, kNumbers>(layout.stride, neighbours), offset);
    };
    using std::uint16_t, std::uint32_t, std::uint8_t;
    if (forms.position == PositionForm::quantised)
        words.template operator()<uint16_t, 3>(0);
    else
        words.template operator()<uint32_t, 3>(0);
    if (forms.uv == UvForm::quantised)
        words.template operator()<uint16_t, 2>(layout.uv_offset);
    else
        words.template operator()<uint32_t, 2>(layout.uv_offset);
    if (forms.color != ColorForm::none) words.template operator()<uint8_t, 4>(layout.color_offset);
    if (forms.frame == FrameForm::half3)
        words.template operator()<uint16_t, 3>(layout.frame_offset);
    if (forms.frame == FrameForm::f32) words.template operator()<uint32_t, 4>(layout.frame_offset);
}

/// Positions and UVs, both quantised.
std::vector<Row> rows_of(const MeshRecord& mesh, const std::byte* vertices) {
    const VertexLayout layout = vertex_layout(mesh.forms);
    std::vector<Row> rows(mesh.vertex_count);
    for (Row& row : rows) {
        std::array<std::uint16_t, kRowNumbers> numbers{};
        std::memcpy(numbers.data(), vertices, position_bytes(PositionForm::quantised));
        std::memcpy(&numbers[kFirstUv], vertices + layout.uv_offset, uv_bytes(UvForm::quantised));
        std::memcpy(&row, numbers.data(), sizeof row);
        vertices += layout.stride;
    }
    return rows;
}

/// Calls use(frames) for frames in digits; `rows` are for models that use surfaces.
template <typename Use>
void with_frames(const MeshRecord& mesh, std::span<const std::uint16_t> indices,
                 std::span<const Row> rows, FrameModel model, int area_shift,
                 std::span<const Neighbours> neighbours, Use use) {
    const std::size_t stride = vertex_layout(mesh.forms).stride;
    std::vector<Surface> surfaces;
    if (has_surface(model)) {
        surfaces.resize(mesh.vertex_count + Rotations::kCount);
        sum_surfaces(indices, rows.data(), surface_of(model, area_shift), surfaces);
    }
    with_model(mesh.forms.frame, model, [&]<FrameForm kForm, bool kHasPartner, bool kHasSurface>() {
        use(Frames<kForm, kHasPartner, kHasSurface>(stride, neighbours, surfaces));
    });
}

/// Whether a stream of the mesh may say so.
bool allows(const VertexForms& forms, FrameModel model) {
    if (model == FrameModel::neighbours) return true;
    return model < FrameModel::count && in_digits(forms.frame) &&
           (!has_surface(model) || has_rows(forms));
}

/// About how many bits planes will take.
std::size_t bits_of(std::span<const std::byte> planes) {
    std::size_t bits = 0;
    for (const std::byte byte : planes)
        bits += static_cast<std::size_t>(std::bit_width(std::to_integer<unsigned>(byte)));
    return bits;
}

}  // namespace

std::size_t vertex_stream_bytes(const MeshRecord& mesh) {
    return kVertexStreamHead + std::size_t{mesh.vertex_count} * plane_count(mesh.forms);
}

std::vector<std::byte> encode_vertices(const MeshRecord& mesh,
                                       std::span<const std::uint16_t> indices,
                                       std::span<const Neighbours> neighbours,
                                       const std::byte* vertices) {
    std::vector<std::byte> stream(vertex_stream_bytes(mesh));
    std::byte* planes = stream.data() + kVertexStreamHead;
    for_each_words(mesh.forms, neighbours, [&](auto part, std::uint32_t offset) {
        part.encode(vertices + offset, planes);
        planes += part.kPlanes * mesh.vertex_count;
    });
    if (!in_digits(mesh.forms.frame)) return stream;
    const std::size_t other_bits = bits_of({stream.data() + kVertexStreamHead, planes});
    std::vector<Row> rows;
    int area_shift = 0;
    if (has_rows(mesh.forms)) {
        rows = rows_of(mesh, vertices);
        area_shift = fitting_area_shift(indices, rows.data());
    }
    stream[1] = static_cast<std::byte>(area_shift);
    double least_cost = std::numeric_limits<double>::max();
    std::vector<std::byte> candidate(std::size_t{kFramePlanes} * mesh.vertex_count);
    const auto consider = [&](FrameModel model) {
        if (!allows(mesh.forms, model)) return;
        with_frames(mesh, indices, rows, model, area_shift, neighbours, [&](auto frames) {
            frames.encode(vertices + vertex_layout(mesh.forms).frame_offset, candidate.data());
        });
        const double cost = static_cast<double>(other_bits + bits_of(candidate)) * cost_of(model);
        if (cost >= least_cost) return;
        least_cost = cost;
        stream[0] = static_cast<std::byte>(model);
        std::ranges::copy(candidate, planes);
    };
    consider(FrameModel::neighbours);
    const double cost_of_neighbours = least_cost;
    consider(FrameModel::x_tangent);
    // Where tangents are the x axis that saves a part of the frames' bits, else next to none.
    const bool is_x = least_cost < 0.97 * cost_of_neighbours;
    consider(is_x ? FrameModel::x_tangent_by_area : FrameModel::surface_by_area);
    consider(is_x ? FrameModel::x_tangent_by_angle : FrameModel::surface_by_angle);
    return stream;
}

bool decode_vertices(const MeshRecord& mesh, std::span<const std::uint16_t> indices,
                     std::span<const Neighbours> neighbours, const std::byte* stream,
                     std::byte* vertices, Scratch& scratch) {
    const auto model = static_cast<FrameModel>(stream[0]);
    const int area_shift = std::to_integer<int>(stream[1]);
    if (!allows(mesh.forms, model) || area_shift > kMaxAreaShift) return false;
    const std::byte* planes = stream + kVertexStreamHead;
    if (are_rows(mesh.forms)) {
        decode_rows(mesh, model, area_shift, indices, neighbours, planes, vertices, scratch);
        return true;
    }
    for_each_words(mesh.forms, neighbours, [&](auto part, std::uint32_t offset) {
        part.decode(planes, vertices + offset);
        planes += part.kPlanes * mesh.vertex_count;
    });
    if (in_digits(mesh.forms.frame)) {
        const std::vector<Row> rows =
            has_surface(model) ? rows_of(mesh, vertices) : std::vector<Row>();
        with_frames(mesh, indices, rows, model, area_shift, neighbours, [&](auto frames) {
            frames.decode(planes, vertices + vertex_layout(mesh.forms).frame_offset);
        });
    }
    return true;
}

}  // namespace mesh_format
