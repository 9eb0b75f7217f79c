// The arithmetic of packing vertices, on many of them at a time: loops that compilers turn into
// vector instructions.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>

namespace bake {

inline constexpr std::size_t kBatch = 64;

/// A number of each vertex of a batch.
template <typename T>
using Batch = std::array<T, kBatch>;

/// Points of a 16-bit lattice along one side, less one.
inline constexpr double kLatticeSpan = 65'535.0;

/// A lattice along one axis of positions or UVs. Point q = 0 .. kLatticeSpan stands for
/// origin + q * step.
struct AxisLattice {
    double shift;  ///< subtracted from all values first
    double origin;
    double step;  ///< a power of two
};

/// The points nearest to values, halves up, and how far from the values they lie.
void to_lattice(const Batch<float>& values, const AxisLattice& lattice,
                Batch<std::uint16_t>& points, Batch<double>& errors);

/// The largest squared length of a vector, and magnitude of a number.
double largest_square(const std::array<Batch<double>, 3>& vectors);
double largest_magnitude(const Batch<double>& numbers);

/// Of the points from `center`.
double largest_square_distance(const std::array<Batch<float>, 3>& points, const glm::dvec3& center);

}  // namespace bake
