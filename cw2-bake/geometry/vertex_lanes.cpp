#include "cw2-bake/geometry/vertex_lanes.h"

#include <algorithm>
#include <cmath>

#include "common/every_cpu.h"

namespace bake {
namespace {

/// The largest of what `number` returns for each vertex of a batch; none is negative.
template <typename Number>
CW2_INLINE double largest(const Number& number) {
    constexpr std::size_t kLanes = 8;
    double lanes[kLanes] = {};
    for (std::size_t first = 0; first < kBatch; first += kLanes) {
        for (std::size_t i = 0; i < kLanes; ++i) {
            const double each = number(first + i);
            lanes[i] = each > lanes[i] ? each : lanes[i];
        }
    }
    return *std::max_element(lanes, lanes + kLanes);
}

}  // namespace

CW2_EVERY_CPU void to_lattice(const Batch<float>& values, const AxisLattice& lattice,
                              Batch<std::uint16_t>& points, Batch<double>& errors) {
    const AxisLattice axis = lattice;
    const double inverse_step = 1.0 / axis.step;  // exact
    for (std::size_t i = 0; i < kBatch; ++i) {
        const double value = values[i] - axis.shift;
        double place = (value - axis.origin) * inverse_step;
        place = place > 0.0 ? place : 0.0;
        place = place < kLatticeSpan ? place : kLatticeSpan;
        // Truncating a positive number plus one half rounds to nearest.
        const auto point = static_cast<std::int32_t>(place + 0.5);
        points[i] = static_cast<std::uint16_t>(point);
        errors[i] = axis.origin + point * axis.step - value;
    }
}

CW2_EVERY_CPU double largest_square(const std::array<Batch<double>, 3>& vectors) {
    const Batch<double>&x = vectors[0], &y = vectors[1], &z = vectors[2];
    return largest([&](std::size_t i) { return x[i] * x[i] + y[i] * y[i] + z[i] * z[i]; });
}

CW2_EVERY_CPU double largest_magnitude(const Batch<double>& numbers) {
    return largest([&](std::size_t i) { return std::abs(numbers[i]); });
}

CW2_EVERY_CPU double largest_square_distance(const std::array<Batch<float>, 3>& points,
                                             const glm::dvec3& center) {
    const glm::dvec3 from = center;
    return largest([&](std::size_t i) {
        const double x = points[0][i] - from.x;
        const double y = points[1][i] - from.y;
        const double z = points[2][i] - from.z;
        return x * x + y * y + z * z;
    });
}

}  // namespace bake
