// Axis-aligned boxes, in space and in UV.
#pragma once

#include <glm/common.hpp>
#include <limits>

namespace bake {

/// The range of vectors; empty at first.
template <typename Vector>
struct Box {
    Vector low{std::numeric_limits<float>::infinity()};
    Vector high{-std::numeric_limits<float>::infinity()};

    void add(const Vector& point) {
        low = glm::min(low, point);
        high = glm::max(high, point);
    }
    void add(const Box& other) {
        low = glm::min(low, other.low);
        high = glm::max(high, other.high);
    }
};

}  // namespace bake
