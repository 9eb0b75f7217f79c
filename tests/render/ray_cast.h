// Which point of a mesh each pixel of a picture sees, in double precision.
#pragma once

#include <array>
#include <cstddef>
#include <glm/vec3.hpp>
#include <vector>

struct Triangle {
    std::array<glm::dvec3, 3> positions;
    std::array<glm::dvec3, 3> normals;
    std::size_t material = 0;
    std::array<glm::dvec3, 3> colors{glm::dvec3(1.0), glm::dvec3(1.0), glm::dvec3(1.0)};
};

/// Right-handed, up +Y; pixel centres at + 0.5, row 0 at the top.
struct PinholeCamera {
    glm::dvec3 position;
    glm::dvec3 target;
    double vertical_fov;  ///< degrees
    int width;
    int height;
};

struct Hit {
    glm::dvec3 position;
    glm::dvec3 normal;  ///< interpolated, unit length
    glm::dvec3 color;   ///< interpolated
};

/// Where the ray through the point (x, y) of the picture, in pixels from its upper left corner,
/// meets the plane of `triangle`, inside the triangle or beside it.
Hit hit(const Triangle& triangle, const PinholeCamera& camera, double x, double y);

enum class Coverage {
    background,
    surface,
    edge,  ///< within 1/32 of a pixel another triangle or none is seen
};

struct PixelTruth {
    Coverage coverage;
    std::size_t triangle;  ///< that is seen, unless this is background
};

/// What each pixel's centre sees, row by row from the top.
std::vector<PixelTruth> cast_rays(const std::vector<Triangle>& triangles,
                                  const PinholeCamera& camera);
