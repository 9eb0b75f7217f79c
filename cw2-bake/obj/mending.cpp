#include "cw2-bake/obj/mending.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

namespace bake {
namespace {

std::size_t end_of(const ObjPolygon& polygon) {
    return std::size_t{polygon.first_triangle} + polygon.corner_count - 2;
}

}  // namespace

void add_range(std::vector<TriangleRange>& ranges, TriangleRange range) {
    if (!ranges.empty() && ranges.back().end >= range.begin)
        ranges.back().end = std::max(ranges.back().end, range.end);
    else
        ranges.push_back(range);
}

std::vector<TriangleRange> joined(const std::vector<TriangleRange>& a,
                                  const std::vector<TriangleRange>& b) {
    std::vector<TriangleRange> all = a;
    all.insert(all.end(), b.begin(), b.end());
    std::ranges::sort(all, {}, &TriangleRange::begin);
    std::vector<TriangleRange> result;
    for (const TriangleRange& range : all) add_range(result, range);
    return result;
}

template <typename T>
Mended mend_corners(const std::vector<T>& elements, std::span<const std::uint32_t> bad,
                    bool all_in_range, std::uint32_t Corner::*index,
                    std::span<const ObjPolygon> polygons, std::vector<Corner>& corners) {
    if (bad.empty() && all_in_range) return {};
    const auto element_count = static_cast<std::uint32_t>(elements.size());
    // Nearly all corners are good, and one comparison tells: what is not is in this range.
    const std::uint32_t first = bad.empty() ? element_count : bad.front();
    const std::uint32_t span = (all_in_range ? bad.back() + 1 : kAbsent) - first;
    const auto may_be_bad = [=](const Corner& corner) {
        return unsigned{corner.*index - first < span};
    };
    const auto mend_triangles = [&](std::size_t begin, std::size_t end) {
        Mended mended;
        auto polygon = std::ranges::upper_bound(polygons, begin, {}, &ObjPolygon::first_triangle);
        if (polygon != polygons.begin()) --polygon;
        for (std::size_t t = begin; t < end; ++t) {
            Corner* const corner = &corners[3 * t];
            if ((may_be_bad(corner[0]) | may_be_bad(corner[1]) | may_be_bad(corner[2])) == 0)
                continue;
            // A fan states the corners of its other triangles but for the last again.
            while (polygon != polygons.end() && t >= end_of(*polygon)) ++polygon;
            const bool is_of_fan = polygon != polygons.end() && t >= polygon->first_triangle;
            const bool goes_on = is_of_fan && t > polygon->first_triangle;
            for (std::size_t k = 0; k < 3; ++k) {
                std::uint32_t& i = corner[k].*index;
                if (i == kAbsent || (i < element_count && !std::isnan(elements[i].x))) continue;
                i = kAbsent;
                add_range(mended.ranges,
                          is_of_fan ? TriangleRange{polygon->first_triangle, end_of(*polygon)}
                                    : TriangleRange{t, t + 1});
                if (goes_on && k < 2) continue;
                if (mended.count++ == 0) mended.first_triangle = t;
            }
        }
        return mended;
    };
    constexpr std::size_t kBlock = 1 << 13;
    const std::size_t triangles = corners.size() / 3;
    std::vector<Mended> found(triangles / kBlock + 1);
    tbb::parallel_for(std::size_t{0}, found.size(), [&](std::size_t i) {
        found[i] = mend_triangles(i * kBlock, std::min(triangles, (i + 1) * kBlock));
    });
    Mended all;
    for (const Mended& mended : found) {
        if (all.count == 0) all.first_triangle = mended.first_triangle;
        all.count += mended.count;
        for (const TriangleRange& range : mended.ranges) add_range(all.ranges, range);
    }
    return all;
}

template Mended mend_corners(const std::vector<glm::vec2>&, std::span<const std::uint32_t>, bool,
                             std::uint32_t Corner::*, std::span<const ObjPolygon>,
                             std::vector<Corner>&);
template Mended mend_corners(const std::vector<glm::vec3>&, std::span<const std::uint32_t>, bool,
                             std::uint32_t Corner::*, std::span<const ObjPolygon>,
                             std::vector<Corner>&);

}  // namespace bake
