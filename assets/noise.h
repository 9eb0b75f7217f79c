// Deterministic randomness: an integer hash and the periodic noises built on it.
#pragma once

#include <cmath>
#include <cstdint>
#include <glm/glm.hpp>

namespace assets {

inline constexpr float kPi = 3.14159265358979f;

/// One step of an LCG and the RXS-M-XS output permutation (O'Neill, PCG, 2014).
inline std::uint32_t hash(std::uint32_t x) {
    x = x * 747796405u + 2891336453u;
    x = ((x >> ((x >> 28u) + 4u)) ^ x) * 277803737u;
    return (x >> 22u) ^ x;
}

inline std::uint32_t hash(std::int32_t x, std::int32_t y, std::uint32_t seed) {
    return hash(static_cast<std::uint32_t>(x) + hash(static_cast<std::uint32_t>(y) + hash(seed)));
}

/// To [0, 1).
inline float unit(std::uint32_t bits) {
    return static_cast<float>(bits >> 8) * 0x1p-24f;
}

class Random {
 public:
    explicit Random(std::uint32_t seed) : state_(hash(seed)) {}
    float next() { return unit(state_ = hash(state_ + 0x9E3779B9u)); }  ///< in [0, 1)
    float range(float low, float high) { return low + (high - low) * next(); }

 private:
    std::uint32_t state_;
};

inline float mix(float a, float b, float t) {
    return a + (b - a) * t;
}
inline float saturate(float x) {
    return std::fmin(std::fmax(x, 0.0f), 1.0f);
}
inline float smooth_step(float low, float high, float x) {
    const float t = saturate((x - low) / (high - low));
    return t * t * (3.0f - 2.0f * t);
}

inline std::int32_t wrap(std::int32_t x, std::int32_t period) {
    x %= period;
    return x < 0 ? x + period : x;
}

/// Gradient noise, about [-1, 1], that repeats every `period` units in x and y.
inline float noise(glm::vec2 p, std::int32_t period, std::uint32_t seed) {
    const glm::vec2 cell = glm::floor(p);
    const glm::vec2 f = p - cell;
    const auto x = static_cast<std::int32_t>(cell.x);
    const auto y = static_cast<std::int32_t>(cell.y);
    const auto corner = [&](std::int32_t dx, std::int32_t dy) {
        const std::uint32_t h = hash(wrap(x + dx, period), wrap(y + dy, period), seed);
        const glm::vec2 gradient(unit(h) * 2.0f - 1.0f, unit(hash(h)) * 2.0f - 1.0f);
        return glm::dot(gradient, f - glm::vec2(dx, dy));
    };
    const glm::vec2 s = f * f * f * (f * (f * 6.0f - 15.0f) + 10.0f);
    return 1.6f *
           mix(mix(corner(0, 0), corner(1, 0), s.x), mix(corner(0, 1), corner(1, 1), s.x), s.y);
}

/// Octaves of noise, each twice as fine and half as strong; about [-1, 1].
inline float fbm(glm::vec2 p, std::int32_t period, int octaves, std::uint32_t seed) {
    float sum = 0.0f;
    float amplitude = 0.6f;
    for (int octave = 0; octave < octaves; ++octave) {
        sum += amplitude * noise(p, period, seed + static_cast<std::uint32_t>(octave));
        p *= 2.0f;
        period *= 2;
        amplitude *= 0.5f;
    }
    return sum;
}

/// The nearest and second nearest feature point of a jittered grid (Worley 1996).
struct Cell {
    float nearest;
    float second;
    std::uint32_t id;
};

inline Cell cells(glm::vec2 p, std::int32_t period, std::uint32_t seed) {
    const glm::ivec2 base(glm::floor(p));
    Cell cell{9.0f, 9.0f, 0};
    for (int dy = -1; dy <= 1; ++dy) {
        for (int dx = -1; dx <= 1; ++dx) {
            const std::uint32_t h =
                hash(wrap(base.x + dx, period), wrap(base.y + dy, period), seed);
            const glm::vec2 point =
                glm::vec2(base + glm::ivec2(dx, dy)) + glm::vec2(unit(h), unit(hash(h)));
            const float distance = glm::length(point - p);
            if (distance < cell.nearest) {
                cell = {distance, cell.nearest, h};
            } else if (distance < cell.second) {
                cell.second = distance;
            }
        }
    }
    return cell;
}

}  // namespace assets
