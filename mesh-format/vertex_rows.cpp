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
    std::array<Row, 2> differences(const NumberPlanes& at, std::size_t first) const {
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
            const std::array<Row, 2> both = differences(numbers[k], first);
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

/// All but vertex 0, of which nothing is expected, is a + b - c and what it differs by. `rows` has
/// room for another after the last.
template <std::size_t kNumbers>
void decode_whole(const Planes& planes, const std::array<NumberPlanes, kNumbers>& numbers,
                  std::span<const Neighbours> neighbours, std::byte* rows) {
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
        }
    }
}

constexpr std::array<NumberPlanes, kRowNumbers> kQuat48Planes{
    {{0, 3}, {1, 4}, {2, 5}, {10, 13}, {11, 14}, {12, 15}, {6, 8}, {7, 9}}};

/// What the codes of a block's frames differ by.
void read_frames(const Planes& planes, std::size_t first,
                 std::array<std::array<Row, 3>, 2>& words) {
    for (std::size_t k = 0; k < 3; ++k) {
        const std::array<Row, 2> both =
            planes.differences({kFirstFramePlane + k, kFirstFramePlane + 3 + k}, first);
        for (std::size_t half = 0; half < 2; ++half) words[half][k] = both[half];
    }
}
void read_frames(const Planes& planes, std::size_t first,
                 std::array<std::uint32_t, kBlock>& codes) {
    const Plane bytes = planes.bytes(kFirstFramePlane, first);
    const Plane tops = bytes >> 1 ^ -(bytes & 1);
    std::array<std::array<std::uint16_t, kBlock>, 3> digits;
    for (std::size_t k = 0; k < 3; ++k) {
        const std::array<Row, 2> both =
            planes.differences({kFirstFramePlane + 1 + k, kFirstFramePlane + 4 + k}, first);
        std::memcpy(&digits[k], &both, sizeof both);
    }
    for (std::size_t i = 0; i < kBlock; ++i)
        codes[i] = code_difference({{digits[0][i], digits[1][i], digits[2][i]}, tops[i]});
}

/// Three rows of eight words to eight frames.
std::array<std::uint64_t, kFrameLanes> by_frame(const std::array<Row, 3>& words) {
    std::array<Row, kRowNumbers> rows{words[0], words[1], words[2]};
    transpose(rows);
    std::array<std::uint64_t, kFrameLanes> frames;
    for (std::size_t lane = 0; lane < kFrameLanes; ++lane)
        std::memcpy(&frames[lane], &rows[lane], sizeof frames[lane]);
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

void decode_quat32(const Planes& planes, std::span<const Neighbours> neighbours,
                   const Place* places, std::byte* out, Scratch& scratch) {
    auto* const codes = scratch.take<std::uint32_t>(neighbours.size());
    for (std::size_t first = 0; first < neighbours.size(); first += kBlock) {
        std::array<std::uint32_t, kBlock> differences;
        read_frames(planes, first, differences);
        const std::size_t size = std::min(kBlock, neighbours.size() - first);
        for (std::size_t k = 0; k < size; ++k) {
            const std::size_t i = first + k;
            const auto [a, b, c, unused] = neighbours[i];
            codes[i] = differences[k] + (i > 0 ? codes[a] - codes[c] + codes[b] : 0);
            put(places[i], codes[i], out + i * 14);
        }
    }
}

template <FrameForm kForm>
void decode_frames(const Planes& planes, const Surface* surfaces, std::size_t count,
                   const Place* places, std::byte* out) {
    constexpr std::size_t kStride =
        vertex_layout({PositionForm::quantised, kForm, UvForm::quantised, ColorForm::none}).stride;
    for (std::size_t first = 0; first < count; first += kBlock) {
        std::array<std::array<Row, 3>, 2> words;
        std::array<std::uint32_t, kBlock> codes;
        if constexpr (kForm == FrameForm::quat48)
            read_frames(planes, first, words);
        else
            read_frames(planes, first, codes);
        for (std::size_t half = 0; half < 2; ++half) {
            const std::size_t start = first + half * kFrameLanes;
            if (start >= count) break;
            const std::size_t size = std::min(kFrameLanes, count - start);
            if constexpr (kForm == FrameForm::quat48) {
                std::array<Row, 3> expected;
                expect_quat48(surfaces + start, expected);
                for (std::size_t k = 0; k < 3; ++k) expected[k] += words[half][k];
                const std::array<std::uint64_t, kFrameLanes> frames = by_frame(expected);
                for (std::size_t k = 0; k < size; ++k)
                    put(places[start + k], frames[k], out + (start + k) * kStride);
            } else {
                std::array<std::uint32_t, kFrameLanes> expected;
                expect_quat32(surfaces + start, expected);
                for (std::size_t k = 0; k < size; ++k)
                    put(places[start + k], expected[k] + codes[half * kFrameLanes + k],
                        out + (start + k) * kStride);
            }
        }
    }
}

}  // namespace

void decode_rows(const MeshRecord& mesh, const SurfaceModel* model,
                 std::span<const std::uint16_t> indices, std::span<const Neighbours> neighbours,
                 const std::byte* planes_begin, std::byte* vertices, Scratch& scratch) {
    const std::size_t count = mesh.vertex_count;
    const Planes planes(planes_begin, count);
    const bool is_wide = mesh.forms.frame == FrameForm::quat48;
    if (is_wide && !model) return decode_whole(planes, kQuat48Planes, neighbours, vertices);
    auto* const places = scratch.take<Place>(count);
    decode_whole(planes, kPlacePlanes, neighbours, reinterpret_cast<std::byte*>(places));
    if (!model) return decode_quat32(planes, neighbours, places, vertices, scratch);
    const std::span surfaces(scratch.take<Surface>(count + kBlock), count + kBlock);
    sum_surfaces(indices, places, *model, surfaces);
    if (is_wide)
        decode_frames<FrameForm::quat48>(planes, surfaces.data(), count, places, vertices);
    else
        decode_frames<FrameForm::quat32>(planes, surfaces.data(), count, places, vertices);
}

}  // namespace mesh_format
