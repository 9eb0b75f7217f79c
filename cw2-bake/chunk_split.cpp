#include "cw2-bake/chunk_split.h"

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <limits>
#include <vector>

#include "cw2-bake/raw_vector.h"

namespace bake {
namespace {

constexpr std::size_t kBins = 256;
constexpr float kLastBin = kBins - 1;

/// Sorts coordinates roughly: of two bins, all of one come before all of the other.
class Bins {
 public:
    Bins(float low, float high) : low_(low), scale_(high > low ? kLastBin / (high - low) : 0.0f) {}

    std::uint8_t of(float coordinate) const {
        // In this order the last bin takes what is not a number, too.
        return static_cast<std::uint8_t>(std::min(kLastBin, (coordinate - low_) * scale_));
    }

 private:
    float low_, scale_;
};

struct Key {
    float coordinate;
    std::uint32_t index;
    auto operator<=>(const Key&) const = default;
};

struct Cut {
    std::uint8_t bin;
    Key first_high;  ///< the first key of the high half; in `bin`
};

/// Writes the bin of each triangle to `bins`, and finds the key that `rank` others come before.
Cut find_cut(std::span<const CentredTriangle> triangles, int axis, const Bins& make_bin,
             std::size_t rank, std::span<std::uint8_t> bins) {
    std::array<std::uint32_t, kBins> counts{};
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        bins[i] = make_bin.of(triangles[i].centroid[axis]);
        ++counts[bins[i]];
    }
    std::size_t bin = 0;
    for (; rank >= counts[bin]; ++bin) rank -= counts[bin];
    std::vector<Key> keys;
    keys.reserve(counts[bin]);
    const auto wanted = static_cast<std::uint8_t>(bin);
    for (auto at = std::find(bins.begin(), bins.end(), wanted); at != bins.end();
         at = std::find(at + 1, bins.end(), wanted)) {
        const CentredTriangle& triangle = triangles[static_cast<std::size_t>(at - bins.begin())];
        keys.push_back({triangle.centroid[axis], triangle.index});
    }
    const auto nth = keys.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(keys.begin(), nth, keys.end());
    return {wanted, *nth};
}

}  // namespace

void halve(std::span<const CentredTriangle> triangles, std::span<CentredTriangle> out) {
    glm::vec3 low(std::numeric_limits<float>::infinity());
    glm::vec3 high = -low;
    for (const CentredTriangle& triangle : triangles) {
        low = glm::min(low, triangle.centroid);
        high = glm::max(high, triangle.centroid);
    }
    const glm::vec3 extent = high - low;
    const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0
                     : extent.y >= extent.z                       ? 1
                                                                  : 2;
    const std::size_t half = triangles.size() / 2;
    RawVector<std::uint8_t> bins(triangles.size());
    const Cut cut = find_cut(triangles, axis, Bins(low[axis], high[axis]), half, bins);

    // No branch on what no one can predict.
    std::array<CentredTriangle*, 2> next{out.data(), out.data() + half};
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const CentredTriangle& triangle = triangles[i];
        bool is_high = bins[i] > cut.bin;
        if (bins[i] == cut.bin)
            is_high = Key{triangle.centroid[axis], triangle.index} >= cut.first_high;
        *next[is_high]++ = triangle;
    }
}

}  // namespace bake
