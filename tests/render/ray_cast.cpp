#include "tests/render/ray_cast.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <limits>

namespace {

constexpr double kEdge = 1.0 / 32.0;  // pixels
constexpr std::size_t kNothing = std::numeric_limits<std::size_t>::max();

struct Axes {
    glm::dvec3 right, up, forward;
    double half_width, half_height;  ///< of the picture at distance 1
};

Axes axes_of(const PinholeCamera& camera) {
    Axes axes{};
    axes.forward = glm::normalize(camera.target - camera.position);
    axes.right = glm::normalize(glm::cross(axes.forward, glm::dvec3(0.0, 1.0, 0.0)));
    axes.up = glm::cross(axes.right, axes.forward);
    axes.half_height = std::tan(camera.vertical_fov * M_PI / 360.0);
    axes.half_width = axes.half_height * camera.width / camera.height;
    return axes;
}

/// The pixels that may see a triangle, the last of each row and column included.
struct Window {
    int left, top, right, bottom;
};

Window window_of(const Triangle& triangle, const PinholeCamera& camera, const Axes& axes) {
    const Window everything{0, 0, camera.width - 1, camera.height - 1};
    double left = 1e9, top = 1e9, right = -1e9, bottom = -1e9;
    for (const glm::dvec3& position : triangle.positions) {
        const glm::dvec3 arm = position - camera.position;
        const double depth = glm::dot(arm, axes.forward);
        if (depth <= 1e-6) return everything;
        const double x = glm::dot(arm, axes.right) / (depth * axes.half_width);
        const double y = glm::dot(arm, axes.up) / (depth * axes.half_height);
        left = std::min(left, (0.5 + 0.5 * x) * camera.width);
        right = std::max(right, (0.5 + 0.5 * x) * camera.width);
        top = std::min(top, (0.5 - 0.5 * y) * camera.height);
        bottom = std::max(bottom, (0.5 - 0.5 * y) * camera.height);
    }
    const auto clamp = [](double value, int size) {
        return static_cast<int>(std::clamp(std::floor(value), 0.0, size - 1.0));
    };
    return {clamp(left - 1.0, camera.width), clamp(top - 1.0, camera.height),
            clamp(right + 1.0, camera.width), clamp(bottom + 1.0, camera.height)};
}

/// The direction of the ray through (x, y), pixels from the upper left corner.
glm::dvec3 direction_of(const PinholeCamera& camera, const Axes& axes, double x, double y) {
    const double right = 2.0 * x / camera.width - 1.0;
    const double up = 1.0 - 2.0 * y / camera.height;
    return axes.forward + right * axes.half_width * axes.right + up * axes.half_height * axes.up;
}

struct Intersection {
    double distance;  ///< in lengths of the ray's direction
    glm::dvec3 weights;

    bool inside() const { return weights.x >= 0.0 && weights.y >= 0.0 && weights.z >= 0.0; }
};

/// With the triangle's plane.
Intersection intersect(const Triangle& triangle, const glm::dvec3& origin,
                       const glm::dvec3& direction) {
    const glm::dvec3 a = triangle.positions[0];
    const glm::dvec3 ab = triangle.positions[1] - a;
    const glm::dvec3 ac = triangle.positions[2] - a;
    const glm::dvec3 area = glm::cross(ab, ac);
    const double distance = glm::dot(area, a - origin) / glm::dot(area, direction);
    const glm::dvec3 arm = origin + distance * direction - a;
    const double size = glm::dot(area, area);
    const double b = glm::dot(glm::cross(arm, ac), area) / size;
    const double c = glm::dot(glm::cross(ab, arm), area) / size;
    return {distance, {1.0 - b - c, b, c}};
}

/// The number of the triangle that is seen at `offset` from each pixel's centre, or kNothing.
std::vector<std::size_t> seen_triangles(const std::vector<Triangle>& triangles,
                                        const PinholeCamera& camera, glm::dvec2 offset) {
    const Axes axes = axes_of(camera);
    const auto pixels = static_cast<std::size_t>(camera.width * camera.height);
    std::vector<std::size_t> seen(pixels, kNothing);
    std::vector<double> distances(pixels, std::numeric_limits<double>::infinity());
    for (std::size_t i = 0; i < triangles.size(); ++i) {
        const Window window = window_of(triangles[i], camera, axes);
        for (int y = window.top; y <= window.bottom; ++y) {
            for (int x = window.left; x <= window.right; ++x) {
                const Intersection found =
                    intersect(triangles[i], camera.position,
                              direction_of(camera, axes, x + 0.5 + offset.x, y + 0.5 + offset.y));
                const auto pixel = static_cast<std::size_t>(y * camera.width + x);
                if (found.inside() && found.distance > 0.0 && found.distance < distances[pixel]) {
                    distances[pixel] = found.distance;
                    seen[pixel] = i;
                }
            }
        }
    }
    return seen;
}

}  // namespace

Hit hit(const Triangle& triangle, const PinholeCamera& camera, double x, double y) {
    const Intersection found =
        intersect(triangle, camera.position, direction_of(camera, axes_of(camera), x, y));
    Hit result{glm::dvec3(0.0), glm::dvec3(0.0), glm::dvec3(0.0)};
    for (int k = 0; k < 3; ++k) {
        const auto corner = static_cast<std::size_t>(k);
        result.position += found.weights[k] * triangle.positions[corner];
        result.normal += found.weights[k] * triangle.normals[corner];
        result.color += found.weights[k] * triangle.colors[corner];
    }
    result.normal = glm::normalize(result.normal);
    return result;
}

std::vector<PixelTruth> cast_rays(const std::vector<Triangle>& triangles,
                                  const PinholeCamera& camera) {
    std::vector<PixelTruth> truth;
    for (const std::size_t triangle : seen_triangles(triangles, camera, {0.0, 0.0})) {
        truth.push_back(
            {triangle == kNothing ? Coverage::background : Coverage::surface, triangle});
    }
    for (const double x : {-kEdge, kEdge}) {
        for (const double y : {-kEdge, kEdge}) {
            const std::vector<std::size_t> beside = seen_triangles(triangles, camera, {x, y});
            for (std::size_t i = 0; i < truth.size(); ++i) {
                if (beside[i] != truth[i].triangle) truth[i].coverage = Coverage::edge;
            }
        }
    }
    return truth;
}
