#include "mesh-format/vertex_rows.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>

#include "mesh-format/frame_differences.h"

namespace mesh_format {

namespace {

using Plane = std::uint8_t __attribute__((vector_size(16)));

constexpr std::size_t kBlock = 16;  // vertices
constexpr std::size_t kHalves = kBlock / kRowNumbers;

constexpr std::size_t stride_of(FrameForm form) {
    return vertex_layout({PositionForm::quantised, form, UvForm::quantised, ColorForm::none})
        .stride;
}
constexpr std::size_t kStride48 = stride_of(FrameForm::quat48);
constexpr std::size_t kStride32 = stride_of(FrameForm::quat32);

/// 0, 1, 2, 3 to 0, -1, 1, -2.
Row unzigzag(Row row) {
    return row >> 1 ^ -(row & 1);
}

/// The planes of the low and of the high byte of a number.
struct NumberPlanes {
    std::size_t low, high;
};
constexpr std::array<NumberPlanes, 5> kPlacePlanes{{{0, 3}, {1, 4}, {2, 5}, {6, 8}, {7, 9}}};
constexpr std::size_t kFirstFramePlane = 10;

/// The planes of all vertices, block by block.
class Planes {
 public:
    Planes(const std::byte* planes, std::size_t count) : planes_(planes), count_(count) {}

    /// The bytes of a block's vertices; beyond the last one 0.
    Plane bytes(std::size_t plane, std::size_t first) const {
        Plane result{};
        const std::byte* const in = planes_ + plane * count_ + first;
        if (first + kBlock <= count_) [[likely]]
            std::memcpy(&result, in, kBlock);
        else
            std::memcpy(&result, in, count_ - first);
        return result;
    }

    /// The differences of a block's vertices in a number: of the first eight, and of the others.
    std::array<Row, kHalves> differences(const NumberPlanes& at, std::size_t first) const {
        const Plane low = bytes(at.low, first);
        const Plane high = bytes(at.high, first);
        const Plane first_half = __builtin_shufflevector(low, high, 0, 16, 1, 17, 2, 18, 3, 19, 4,
                                                         20, 5, 21, 6, 22, 7, 23);
        const Plane second_half = __builtin_shufflevector(low, high, 8, 24, 9, 25, 10, 26, 11, 27,
                                                          12, 28, 13, 29, 14, 30, 15, 31);
        return {unzigzag(reinterpret_cast<Row>(first_half)),
                unzigzag(reinterpret_cast<Row>(second_half))};
    }

    /// Of a block's vertices the differences in as many numbers; the others' are 0.
    template <std::size_t kNumbers>
    std::array<Row, kBlock> rows(const std::array<NumberPlanes, kNumbers>& numbers,
                                 std::size_t first) const {
        std::array<Row, kRowNumbers> halves[2]{};
        for (std::size_t k = 0; k < kNumbers; ++k) {
            const std::array<Row, kHalves> both = differences(numbers[k], first);
            for (std::size_t half = 0; half < 2; ++half) halves[half][k] = both[half];
        }
        std::array<Row, kBlock> result;
        for (std::size_t half = 0; half < 2; ++half) {
            transpose(halves[half]);
            std::ranges::copy(halves[half], result.begin() + half * kRowNumbers);
        }
        return result;
    }

 private:
    const std::byte* planes_;
    std::size_t count_;
};

/// All vertices, each a row: but for vertex 0, of which nothing is expected, a + b - c of its
/// neighbours and what it differs by. Calls each(i, row) for one after the other.
template <std::size_t kNumbers, typename Each>
void decode_whole(const Planes& planes, const std::array<NumberPlanes, kNumbers>& numbers,
                  std::span<const Neighbours> neighbours, std::byte* rows, const Each& each) {
    const auto at = [&](std::size_t i) {
        Row row;
        std::memcpy(&row, rows + i * sizeof row, sizeof row);
        return row;
    };
    for (std::size_t first = 0; first < neighbours.size(); first += kBlock) {
        const std::array<Row, kBlock> differences = planes.rows(numbers, first);
        const std::size_t size = std::min(kBlock, neighbours.size() - first);
        for (std::size_t k = 0; k < size; ++k) {
            const std::size_t i = first + k;
            Row row = differences[k];
            // In this order: mostly b is the vertex before, for which the others need not wait.
            if (i > 0) [[likely]]
                row = row + at(neighbours[i].a) - at(neighbours[i].c) + at(neighbours[i].b);
            std::memcpy(rows + i * sizeof row, &row, sizeof row);
            each(i, row);
        }
    }
}

constexpr std::array<NumberPlanes, kRowNumbers> kQuat48Planes{
    {{0, 3}, {1, 4}, {2, 5}, {10, 13}, {11, 14}, {12, 15}, {6, 8}, {7, 9}}};

/// What the codes of a block's frames differ by.
void read_codes(const Planes& planes, std::size_t first, std::uint32_t* codes) {
    const Plane bytes = planes.bytes(kFirstFramePlane, first);
    const Plane tops = bytes >> 1 ^ -(bytes & 1);
    std::array<std::array<std::uint16_t, kBlock>, 3> digits;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::array<Row, kHalves> both =
            planes.differences({kFirstFramePlane + 1 + k, kFirstFramePlane + 4 + k}, first);
        std::memcpy(&digits[k], &both, sizeof both);
    }
    for (std::size_t i = 0; i < kBlock; ++i)
        codes[i] = code_difference({{digits[0][i], digits[1][i], digits[2][i]}, tops[i]});
}

/// Eight frames of three words.
std::array<std::uint64_t, kRowNumbers> by_frame(const Row& first, const Row& second,
                                                const Row& third) {
    std::array<Row, kRowNumbers> rows{first, second, third};
    transpose(rows);
    std::array<std::uint64_t, kRowNumbers> frames;
    for (std::size_t k = 0; k < frames.size(); ++k)
        std::memcpy(&frames[k], &rows[k], sizeof frames[k]);
    return frames;
}

template <typename Frame>
void put(const Place& place, const Frame& frame, std::byte* out) {
    constexpr std::size_t kFrameBytes = sizeof frame == 8 ? 6 : 4;
    std::array<std::uint64_t, 2> words;
    std::memcpy(&words, &place, sizeof words);
    const auto uv = static_cast<std::uint32_t>(words[0] >> 48 | words[1] << 16);
    std::memcpy(out, &words[0], 8);  // two bytes more than it has
    std::memcpy(out + 6, &frame, sizeof frame);
    std::memcpy(out + 6 + kFrameBytes, &uv, sizeof uv);
}

void decode_quat32(const Planes& planes, std::span<const Neighbours> neighbours, std::byte* places,
                   std::byte* out, Scratch& scratch) {
    // What they differ by, and then the codes themselves.
    auto* const codes = scratch.take<std::uint32_t>(neighbours.size() + kBlock);
    for (std::size_t first = 0; first < neighbours.size(); first += kBlock)
        read_codes(planes, first, codes + first);
    // Together with the places: processors need not wait for one and then for the other.
    decode_whole(planes, kPlacePlanes, neighbours, places, [&](std::size_t i, const Place& place) {
        const auto [a, b, c, unused] = neighbours[i];
        if (i > 0) [[likely]]
            codes[i] += codes[a] - codes[c] + codes[b];
        put(place, codes[i], out + i * kStride32);
    });
}

/// What surfaces suggest of all frames, by their sums, and what those differ by.
class SurfaceFrames {
 public:
    SurfaceFrames(const Planes& planes, const SurfaceModel& model, std::span<const Sum> sums,
                  std::span<const Place> places)
        : planes_(planes), model_(model), sums_(sums), places_(places) {}

    void decode_quat48(std::byte* out) const {
        for (std::size_t first = 0; first < places_.size(); first += kFrameLanes) {
            std::array<Words, 3> words;
            expect_quat48(sums_at(first), model_.has_uvs, words);
            for (std::size_t at = 0; at < kFrameLanes && first + at < places_.size(); at += kBlock)
                for (std::size_t k = 0; k < 3; ++k) {
                    const std::array<Row, kHalves> differences = planes_.differences(
                        {kFirstFramePlane + k, kFirstFramePlane + 3 + k}, first + at);
                    for (std::size_t half = 0; half < kHalves; ++half)
                        words[k][at / kRowNumbers + half] += differences[half];
                }
            const std::size_t size = std::min(kFrameLanes, places_.size() - first);
            for (std::size_t at = 0; at < size; at += kRowNumbers) {
                const std::size_t i = at / kRowNumbers;
                put_all(by_frame(words[0][i], words[1][i], words[2][i]), first + at, out);
            }
        }
    }

    void decode_quat32(std::byte* out) const {
        for (std::size_t first = 0; first < places_.size(); first += kFrameLanes) {
            std::array<std::uint32_t, kFrameLanes> codes;
            expect_quat32(sums_at(first), model_.has_uvs, codes);
            for (std::size_t at = 0; at < kFrameLanes && first + at < places_.size();
                 at += kBlock) {
                std::array<std::uint32_t, kBlock> frames;
                read_codes(planes_, first + at, frames.data());
                for (std::size_t k = 0; k < kBlock; ++k) frames[k] += codes[at + k];
                put_all(frames, first + at, out);
            }
        }
    }

 private:
    const Sum* sums_at(std::size_t vertex) const { return &sums_[sums_of_vertex(model_) * vertex]; }

    /// The frames from vertex `first` on, but for those behind the last.
    template <typename Frames>
    void put_all(const Frames& frames, std::size_t first, std::byte* out) const {
        constexpr std::size_t kStride = sizeof frames[0] == 8 ? kStride48 : kStride32;
        const std::size_t size = std::min(frames.size(), places_.size() - first);
        for (std::size_t k = 0; k < size; ++k)
            put(places_[first + k], frames[k], out + (first + k) * kStride);
    }

    const Planes& planes_;
    const SurfaceModel& model_;
    std::span<const Sum> sums_;
    std::span<const Place> places_;
};

}  // namespace

void decode_rows(const MeshRecord& mesh, const SurfaceModel* model,
                 std::span<const std::uint16_t> indices, std::span<const Neighbours> neighbours,
                 const std::byte* planes_begin, std::byte* vertices, Scratch& scratch) {
    const std::size_t count = mesh.vertex_count;
    const Planes planes(planes_begin, count);
    const bool is_wide = mesh.forms.frame == FrameForm::quat48;
    const auto nothing = [](std::size_t, const Row&) {};
    if (is_wide && !model)
        return decode_whole(planes, kQuat48Planes, neighbours, vertices, nothing);
    auto* const places = scratch.take<Place>(count);
    auto* const place_bytes = reinterpret_cast<std::byte*>(places);
    if (!model) return decode_quat32(planes, neighbours, place_bytes, vertices, scratch);
    decode_whole(planes, kPlacePlanes, neighbours, place_bytes, nothing);
    const std::size_t sum_count = sums_of_vertex(*model) * (count + kFrameLanes);
    const std::span sums(scratch.take<Sum>(sum_count), sum_count);
    sum_surfaces(indices, places, *model, sums);
    const SurfaceFrames frames(planes, *model, sums, {places, count});
    if (is_wide)
        frames.decode_quat48(vertices);
    else
        frames.decode_quat32(vertices);
}

}  // namespace mesh_format
