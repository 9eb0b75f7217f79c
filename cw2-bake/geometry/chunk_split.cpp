#include "cw2-bake/geometry/chunk_split.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <vector>

#include "cw2-bake/base/raw_vector.h"

namespace bake {
namespace {

// Four at a time: what every x86-64 processor has registers for.
constexpr std::size_t kLanes = 4;
using Floats [[gnu::vector_size(4 * kLanes)]] = float;
using Ints [[gnu::vector_size(4 * kLanes)]] = std::int32_t;

struct Key {
    float coordinate;
    std::uint32_t index;
    auto operator<=>(const Key&) const = default;
};

Key key_of(const CentredTriangle& triangle, int axis) {
    return {triangle.centroid[axis], triangle.index};
}

/// Coordinates of kLanes triangles.
Floats coordinates(const CentredTriangle* triangles, int axis) {
    return Floats{triangles[0].centroid[axis], triangles[1].centroid[axis],
                  triangles[2].centroid[axis], triangles[3].centroid[axis]};
}

/// Calls each(i, first, count) with a pointer to kLanes triangles, of which `count` are triangles
/// i and those behind it.
template <typename Each>
void by_lanes(std::span<const CentredTriangle> triangles, const Each& each) {
    std::size_t i = 0;
    for (; i + kLanes <= triangles.size(); i += kLanes) each(i, &triangles[i], kLanes);
    if (i == triangles.size()) return;
    std::array<CentredTriangle, kLanes> rest{};
    std::copy(triangles.begin() + static_cast<std::ptrdiff_t>(i), triangles.end(), rest.begin());
    each(i, rest.data(), triangles.size() - i);
}

struct Range {
    Floats low, high;
};

/// Of the centroids; the last number of each means nothing.
Range range_of(std::span<const CentredTriangle> triangles) {
    static_assert(sizeof(Floats) == sizeof(CentredTriangle) &&
                  offsetof(CentredTriangle, centroid) == 0);
    const auto load = [](const CentredTriangle& triangle) {
        Floats floats;
        std::memcpy(&floats, &triangle, sizeof floats);
        return floats;
    };
    const auto add = [](Range& range, const Floats& floats) {
        range.low = floats < range.low ? floats : range.low;
        range.high = floats > range.high ? floats : range.high;
    };
    // By turns, so that no minimum waits for the one before it.
    Range ranges[kLanes];
    for (Range& range : ranges) range = {load(triangles[0]), load(triangles[0])};
    by_lanes(triangles, [&](std::size_t, const CentredTriangle* first, std::size_t count) {
        for (std::size_t k = 0; k < count; ++k) add(ranges[k], load(first[k]));
    });
    for (const Range& range : ranges) {
        add(ranges[0], range.low);
        add(ranges[0], range.high);
    }
    return ranges[0];
}

int longest_side(const Range& range) {
    const Floats extent = range.high - range.low;
    if (extent[0] >= extent[1] && extent[0] >= extent[2]) return 0;
    return extent[1] >= extent[2] ? 1 : 2;
}

constexpr std::size_t kBins = 256;
constexpr float kLastBin = kBins - 1;

/// Sorts coordinates roughly: of two bins, all of one come before all of the other.
class Bins {
 public:
    Bins(float low, float high) : low_(low), scale_(high > low ? kLastBin / (high - low) : 0.0f) {}

    Ints of(const Floats& coordinates) const {
        const Floats last = Floats{} + kLastBin;
        const Floats place = (coordinates - low_) * scale_;
        // In this order the last bin takes what is not a number, too.
        return __builtin_convertvector(place < last ? place : last, Ints);
    }

 private:
    float low_, scale_;
};

/// The key along `axis` that `rank` others come before.
Key find_cut(std::span<const CentredTriangle> triangles, int axis, const Bins& make_bins,
             std::size_t rank) {
    RawVector<std::uint8_t> bins(triangles.size());
    // Neighbours often share a bin: two counters each, so that one need not wait for the other.
    std::array<std::array<std::uint32_t, kBins>, 2> counts{};
    by_lanes(triangles, [&](std::size_t i, const CentredTriangle* first, std::size_t count) {
        const Ints bin = make_bins.of(coordinates(first, axis));
        for (std::size_t k = 0; k < count; ++k) {
            bins[i + k] = static_cast<std::uint8_t>(bin[k]);
            ++counts[k % 2][static_cast<std::size_t>(bin[k])];
        }
    });
    const auto count = [&](std::size_t bin) { return counts[0][bin] + counts[1][bin]; };
    std::size_t bin = 0;
    for (; rank >= count(bin); ++bin) rank -= count(bin);
    std::vector<Key> keys;
    keys.reserve(count(bin));
    const std::uint8_t* const end = bins.data() + bins.size();
    for (const std::uint8_t* at = bins.data(); keys.size() < count(bin); ++at) {
        at = static_cast<const std::uint8_t*>(
            std::memchr(at, static_cast<int>(bin), static_cast<std::size_t>(end - at)));
        keys.push_back(key_of(triangles[static_cast<std::size_t>(at - bins.data())], axis));
    }
    const auto nth = keys.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(keys.begin(), nth, keys.end());
    return *nth;
}

}  // namespace

void halve(std::span<const CentredTriangle> triangles, std::span<CentredTriangle> out) {
    const Range range = range_of(triangles);
    const int axis = longest_side(range);
    const std::size_t half = triangles.size() / 2;
    const Key cut = find_cut(triangles, axis, Bins(range.low[axis], range.high[axis]), half);
    const Floats cut_coordinate = Floats{} + cut.coordinate;
    const Ints cut_index = Ints{} + static_cast<std::int32_t>(cut.index);
    std::size_t low = 0;
    by_lanes(triangles, [&](std::size_t i, const CentredTriangle* first, std::size_t count) {
        const Floats coordinate = coordinates(first, axis);
        const Ints index{int(first[0].index), int(first[1].index), int(first[2].index),
                         int(first[3].index)};
        const Ints is_high =
            (coordinate > cut_coordinate) | ((coordinate == cut_coordinate) & (index >= cut_index));
        // No branch on what no one can predict: is_high is 0 or -1.
        for (std::size_t k = 0; k < count; ++k) {
            const auto mask = static_cast<std::size_t>(std::ptrdiff_t{is_high[k]});
            out[low + (mask & (half + i + k - 2 * low))] = first[k];
            low += 1 + mask;
        }
    });
}

}  // namespace bake
