// Triangles without any order, for tests of compressed meshes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

/// The same ones every time.
inline std::vector<std::uint16_t> random_triangles(std::uint32_t vertices, std::size_t count) {
    std::mt19937 random(3);
    std::vector<std::uint16_t> indices(3 * count);
    for (std::uint16_t& index : indices) index = static_cast<std::uint16_t>(random() % vertices);
    return indices;
}
