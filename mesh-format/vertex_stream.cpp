#include "mesh-format/vertex_stream.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "mesh-format/frame_differences.h"
#include "mesh-format/surface.h"
#include "mesh-format/vertex_rows.h"
#include "mesh-format/zigzag.h"

namespace mesh_format {

namespace {

/// Surfaces by area take some 10 ns a vertex to decode, those by angle some 20 more: a mesh has
/// them where they save so many of its bits, and those by angle where they save so many more.
constexpr double kLeastBitsSaved = 10;

/// A part of a vertex of so many numbers. Floats are numbers of the same order, modulo 2^32.
template <typename Number, std::size_t kCount>
struct Numbers {
    using Word = std::conditional_t<std::is_same_v<Number, float>, std::uint32_t, Number>;
    using Values = std::array<Word, kCount>;
    static constexpr std::size_t kPlanes = sizeof(Values);

    static Word ordered(Word word) {
        if constexpr (!std::is_same_v<Number, float>) return word;
        return word >> 31 != 0 ? ~word : word | 0x8000'0000;
    }
    static Word unordered(Word word) {
        if constexpr (!std::is_same_v<Number, float>) return word;
        return word >> 31 != 0 ? word & 0x7FFF'FFFF : ~word;
    }

    /// The differences of vertex `i` of `count` in byte planes: the lowest byte of the first number
    /// of all vertices, of the second, ..., then the next bytes.
    static void split(const Values& differences, std::byte* planes, std::size_t i,
                      std::size_t count) {
        for (std::size_t k = 0; k < kCount; ++k)
            for (std::size_t byte = 0; byte < sizeof(Word); ++byte)
                planes[(byte * kCount + k) * count + i] =
                    std::byte(zigzag(differences[k]) >> (8 * byte) & 0xFF);
    }
    static Values joined(const std::byte* planes, std::size_t i, std::size_t count) {
        Values differences;
        for (std::size_t k = 0; k < kCount; ++k) {
            Word word{};
            for (std::size_t byte = 0; byte < sizeof(Word); ++byte)
                word = static_cast<Word>(word |
                                         static_cast<Word>(planes[(byte * kCount + k) * count + i])
                                             << (8 * byte));
            differences[k] = unzigzag(word);
        }
        return differences;
    }
};

/// A code of quat32.
struct FrameCode : Numbers<std::uint32_t, 1> {
    static constexpr std::size_t kPlanes = 7;

    static void split(const Values& difference, std::byte* planes, std::size_t i,
                      std::size_t count) {
        const CodeDigits all = digits_of(difference[0]);
        planes[i] = std::byte(zigzag(all.top));
        Numbers<std::uint16_t, 3>::split(all.digits, planes + count, i, count);
    }
    static Values joined(const std::byte* planes, std::size_t i, std::size_t count) {
        return {code_difference({Numbers<std::uint16_t, 3>::joined(planes + count, i, count),
                                 unzigzag(std::to_integer<std::uint8_t>(planes[i]))})};
    }
};

/// Calls use(part, its offset in a vertex) for each part of the vertices, in the order in which the
/// stream holds their planes; the frame is the last.
template <typename Use>
void for_each_part(const VertexForms& forms, Use use) {
    const VertexLayout layout = vertex_layout(forms);
    if (forms.position == PositionForm::quantised)
        use(Numbers<std::uint16_t, 3>(), 0u);
    else
        use(Numbers<float, 3>(), 0u);
    if (forms.uv == UvForm::quantised)
        use(Numbers<std::uint16_t, 2>(), layout.uv_offset);
    else
        use(Numbers<float, 2>(), layout.uv_offset);
    if (forms.color != ColorForm::none) use(Numbers<std::uint8_t, 4>(), layout.color_offset);
    if (forms.frame == FrameForm::f32)
        use(Numbers<float, 4>(), layout.frame_offset);
    else if (forms.frame == FrameForm::quat32)
        use(FrameCode(), layout.frame_offset);
    else
        use(Numbers<std::uint16_t, 3>(), layout.frame_offset);
}

/// The same part of all vertices of a mesh.
template <typename Part>
class Column {
 public:
    using Values = typename Part::Values;

    /// `expected` is of all vertices, or else empty: then it is what the neighbours suggest.
    Column(std::size_t stride, std::span<const Neighbours> neighbours,
           std::span<const Values> expected)
        : stride_(stride), neighbours_(neighbours), expected_(expected) {}

    void encode(const std::byte* vertices, std::byte* planes) const {
        for (std::size_t i = 0; i < neighbours_.size(); ++i) {
            Values values = at(vertices + i * stride_);
            const Values expected = expected_at(i, vertices);
            for (std::size_t k = 0; k < values.size(); ++k) values[k] -= expected[k];
            Part::split(values, planes, i, neighbours_.size());
        }
    }

    void decode(const std::byte* planes, std::byte* vertices) const {
        for (std::size_t i = 0; i < neighbours_.size(); ++i) {
            Values values = Part::joined(planes, i, neighbours_.size());
            const Values expected = expected_at(i, vertices);
            for (std::size_t k = 0; k < values.size(); ++k) {
                values[k] += expected[k];
                values[k] = Part::unordered(values[k]);
            }
            std::memcpy(vertices + i * stride_, &values, sizeof values);
        }
    }

 private:
    static Values at(const std::byte* vertex) {
        Values values;
        std::memcpy(&values, vertex, sizeof values);
        for (auto& value : values) value = Part::ordered(value);
        return values;
    }

    Values expected_at(std::size_t i, const std::byte* vertices) const {
        if (!expected_.empty()) return expected_[i];
        if (i == 0) return {};
        Values sum = at(vertices + neighbours_[i].a * stride_);
        const Values b = at(vertices + neighbours_[i].b * stride_);
        const Values c = at(vertices + neighbours_[i].c * stride_);
        for (std::size_t k = 0; k < sum.size(); ++k) {
            sum[k] += b[k];
            sum[k] -= c[k];
        }
        return sum;
    }

    std::size_t stride_;
    std::span<const Neighbours> neighbours_;
    std::span<const Values> expected_;
};

std::vector<Place> places_of(const MeshRecord& mesh, const std::byte* vertices) {
    const VertexLayout layout = vertex_layout(mesh.forms);
    std::vector<Place> places(mesh.vertex_count);
    for (Place& place : places) {
        std::array<std::uint16_t, kRowNumbers> numbers{};
        std::memcpy(numbers.data(), vertices, position_bytes(PositionForm::quantised));
        std::memcpy(&numbers[3], vertices + layout.uv_offset, uv_bytes(UvForm::quantised));
        std::memcpy(&place, numbers.data(), sizeof place);
        vertices += layout.stride;
    }
    return places;
}

/// What surfaces suggest of the frames of all vertices.
template <typename Part>
std::vector<typename Part::Values> frames_of(std::span<const std::uint16_t> indices,
                                             std::span<const Place> places,
                                             const SurfaceModel& model) {
    const std::size_t sum_count = sums_of_vertex(model);
    std::vector<Sum> sums(sum_count * (places.size() + kFrameLanes));
    sum_surfaces(indices, places.data(), model, sums);
    std::vector<typename Part::Values> frames(places.size() + kFrameLanes);
    for (std::size_t i = 0; i < places.size(); i += kFrameLanes) {
        if constexpr (std::is_same_v<Part, FrameCode>) {
            std::array<std::uint32_t, kFrameLanes> codes;
            expect_quat32(&sums[sum_count * i], model.has_uvs, codes);
            for (std::size_t lane = 0; lane < kFrameLanes; ++lane) frames[i + lane] = {codes[lane]};
        } else if constexpr (std::is_same_v<Part, Numbers<std::uint16_t, 3>>) {
            std::array<Words, 3> words;
            expect_quat48(&sums[sum_count * i], model.has_uvs, words);
            for (std::size_t lane = 0; lane < kFrameLanes; ++lane)
                for (std::size_t k = 0; k < 3; ++k)
                    frames[i + lane][k] = words[k][lane / kRowNumbers][lane % kRowNumbers];
        }
    }
    frames.resize(places.size());
    return frames;
}

/// Whether frames of the mesh may be predicted from surfaces.
bool may_have_surfaces(const VertexForms& forms) {
    return has_places(forms) &&
           (forms.frame == FrameForm::quat48 || forms.frame == FrameForm::quat32);
}

bool have_uvs(std::span<const Place> places) {
    return std::ranges::any_of(places, [&](const Place& place) {
        return place[3] != places[0][3] || place[4] != places[0][4];
    });
}

FrameModel frame_model(const SurfaceModel& model) {
    if (model.by_angle)
        return model.has_uvs ? FrameModel::surface_by_angle
                             : FrameModel::surface_by_angle_without_uvs;
    return model.has_uvs ? FrameModel::surface : FrameModel::surface_without_uvs;
}

/// The other way, of a stream's head.
SurfaceModel surface_model(FrameModel model, const std::byte* shifts) {
    return {.has_uvs = model == FrameModel::surface || model == FrameModel::surface_by_angle,
            .by_angle = model >= FrameModel::surface_by_angle,
            .normal_shift = std::to_integer<int>(shifts[0]),
            .tangent_shift = std::to_integer<int>(shifts[1])};
}

/// How many bits a vertex's bytes in planes take at least in codes of their own.
double entropy(std::span<const std::byte> planes, std::size_t vertex_count) {
    double bits = 0;
    for (; !planes.empty(); planes = planes.subspan(vertex_count)) {
        std::array<std::uint32_t, 256> counts{};
        for (const std::byte byte : planes.first(vertex_count))
            ++counts[std::to_integer<std::size_t>(byte)];
        for (const std::uint32_t count : counts)
            if (count > 0) bits -= count * std::log2(count / static_cast<double>(vertex_count));
    }
    return bits / static_cast<double>(vertex_count);
}

}  // namespace

std::size_t vertex_stream_bytes(const MeshRecord& mesh) {
    std::size_t planes = 0;
    for_each_part(mesh.forms, [&](auto part, std::uint32_t) { planes += part.kPlanes; });
    return kVertexStreamHead + std::size_t{mesh.vertex_count} * planes;
}

std::vector<std::byte> encode_vertices(const MeshRecord& mesh,
                                       std::span<const std::uint16_t> indices,
                                       std::span<const Neighbours> neighbours,
                                       const std::byte* vertices) {
    const VertexLayout layout = vertex_layout(mesh.forms);
    std::vector<std::byte> stream(vertex_stream_bytes(mesh));
    std::byte* planes = stream.data() + kVertexStreamHead;
    for_each_part(mesh.forms, [&](auto part, std::uint32_t offset) {
        Column<decltype(part)>(layout.stride, neighbours, {}).encode(vertices + offset, planes);
        planes += part.kPlanes * mesh.vertex_count;
    });
    if (!may_have_surfaces(mesh.forms)) return stream;
    const std::vector<Place> places = places_of(mesh, vertices);
    const SurfaceModel by_area = fitting_model(indices, places.data(), have_uvs(places));
    const SurfaceModel by_angle{by_area.has_uvs, true, 0, 0};
    for_each_part(mesh.forms, [&](auto part, std::uint32_t offset) {
        if (offset != layout.frame_offset) return;
        const std::size_t count = mesh.vertex_count;
        std::vector<std::byte> candidate(part.kPlanes * count);
        const std::span own = std::span(stream).last(candidate.size());
        double bits = entropy(own, count);
        for (const SurfaceModel& model : {by_area, by_angle}) {
            const auto frames = frames_of<decltype(part)>(indices, places, model);
            Column<decltype(part)>(layout.stride, neighbours, frames)
                .encode(vertices + offset, candidate.data());
            const double other_bits = entropy(candidate, count);
            if (bits - other_bits < kLeastBitsSaved) continue;
            bits = other_bits;
            std::ranges::copy(candidate, own.begin());
            stream[0] = std::byte(frame_model(model));
            stream[1] = std::byte(model.normal_shift);
            stream[2] = std::byte(model.tangent_shift);
        }
    });
    return stream;
}

bool decode_vertices(const MeshRecord& mesh, std::span<const std::uint16_t> indices,
                     std::span<const Neighbours> neighbours, const std::byte* stream,
                     std::byte* vertices, Scratch& scratch) {
    const auto model = static_cast<FrameModel>(stream[0]);
    const SurfaceModel surface = surface_model(model, stream + 1);
    const bool has_surfaces = model != FrameModel::neighbours;
    if (model >= FrameModel::count || surface.normal_shift > kMaxSurfaceShift ||
        surface.tangent_shift > kMaxSurfaceShift ||
        (has_surfaces && !may_have_surfaces(mesh.forms)))
        return false;
    const std::byte* planes = stream + kVertexStreamHead;
    if (are_rows(mesh.forms)) {
        decode_rows(mesh, has_surfaces ? &surface : nullptr, indices, neighbours, planes, vertices,
                    scratch);
        return true;
    }
    const VertexLayout layout = vertex_layout(mesh.forms);
    for_each_part(mesh.forms, [&](auto part, std::uint32_t offset) {
        std::vector<typename decltype(part)::Values> frames;
        if (has_surfaces && offset == layout.frame_offset)
            frames = frames_of<decltype(part)>(indices, places_of(mesh, vertices), surface);
        Column<decltype(part)>(layout.stride, neighbours, frames).decode(planes, vertices + offset);
        planes += part.kPlanes * mesh.vertex_count;
    });
    return true;
}

}  // namespace mesh_format
