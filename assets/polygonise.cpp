#include "assets/polygonise.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "assets/noise.h"

namespace assets {
namespace {

using glm::ivec3;
using glm::vec3;

constexpr int kBlock = 8;  // cells a side that are skipped or sampled together
constexpr float kSlack = 1.5f;

/// Samples at the points of a lattice, taken only near the surface.
class Samples {
 public:
    Samples(const Field& field, const std::vector<float>& x, const std::vector<float>& y,
            const std::vector<float>& z)
        : planes_{x, y, z},
          size_(x.size(), y.size(), z.size()),
          values_(x.size() * y.size() * z.size()) {
        for_each({0, 0, 0}, size_, kBlock, [&](ivec3 block) {
            const ivec3 end = glm::min(block + kBlock, size_);
            const vec3 low = position(vec3(block));
            const vec3 high = position(vec3(glm::min(end, size_ - 1)));
            const float centre = field(0.5f * (low + high));
            const bool far = std::fabs(centre) > kSlack * 0.6f * glm::length(high - low);
            for_each(block, end, 1,
                     [&](ivec3 i) { values_[index(i)] = far ? centre : field(position(vec3(i))); });
        });
    }

    /// A point of the lattice, or between its points.
    vec3 position(vec3 lattice) const {
        vec3 p;
        for (int axis = 0; axis < 3; ++axis) {
            const std::vector<float>& planes = planes_[static_cast<std::size_t>(axis)];
            const auto i = std::min(static_cast<std::size_t>(lattice[axis]), planes.size() - 2);
            const float t = lattice[axis] - static_cast<float>(i);
            p[axis] = planes[i] + t * (planes[i + 1] - planes[i]);
        }
        return p;
    }
    float at(ivec3 i) const { return values_[index(i)]; }
    ivec3 size() const { return size_; }
    std::size_t index(ivec3 i) const {
        return (static_cast<std::size_t>(i.z) * static_cast<std::size_t>(size_.y) +
                static_cast<std::size_t>(i.y)) *
                   static_cast<std::size_t>(size_.x) +
               static_cast<std::size_t>(i.x);
    }

    template <typename Function>
    static void for_each(ivec3 from, ivec3 to, int step, const Function& function) {
        for (int z = from.z; z < to.z; z += step) {
            for (int y = from.y; y < to.y; y += step) {
                for (int x = from.x; x < to.x; x += step) function(ivec3(x, y, z));
            }
        }
    }

 private:
    std::array<std::vector<float>, 3> planes_;
    ivec3 size_;
    std::vector<float> values_;
};

vec3 gradient(const Field& field, vec3 p, float step) {
    const vec3 x(step, 0, 0);
    const vec3 y(0, step, 0);
    const vec3 z(0, 0, step);
    return vec3(field(p + x) - field(p - x), field(p + y) - field(p - y),
                field(p + z) - field(p - z)) /
           (2.0f * step);
}

/// The mean of the points where the cell's edges cross the surface; whether there are any.
bool place_vertex(const Samples& samples, ivec3 cell, vec3& vertex) {
    vec3 sum(0.0f);
    int count = 0;
    for (int axis = 0; axis < 3; ++axis) {
        for (int k = 0; k < 4; ++k) {
            ivec3 from = cell;
            from[(axis + 1) % 3] += k & 1;
            from[(axis + 2) % 3] += k >> 1;
            ivec3 to = from;
            ++to[axis];
            const float a = samples.at(from);
            const float b = samples.at(to);
            if ((a < 0.0f) == (b < 0.0f)) continue;
            vec3 crossing(from);
            crossing[axis] += a / (a - b);
            sum += crossing;
            ++count;
        }
    }
    if (count > 0) vertex = samples.position(sum / static_cast<float>(count));
    return count > 0;
}

/// Newton's steps along the gradient, no further than half a cell in all.
void project(const Field& field, Vertex& vertex, float cell) {
    // A step that sees as little as the grid shows: creases shade as they are meshed.
    const float reach = 0.3f * cell;
    const vec3 start = vertex.position;
    for (int step = 0; step < 3; ++step) {
        const vec3 slope = gradient(field, vertex.position, reach);
        const float squared = glm::dot(slope, slope);
        if (squared < 1e-6f) break;
        const vec3 moved = vertex.position - slope * (field(vertex.position) / squared);
        if (glm::length(moved - start) > 0.5f * cell) break;
        vertex.position = moved;
    }
    vertex.normal = glm::normalize(gradient(field, vertex.position, reach));
}

}  // namespace

Mesh polygonise(const Field& field, const std::vector<float>& x, const std::vector<float>& y,
                const std::vector<float>& z) {
    const Samples samples(field, x, y, z);
    const ivec3 cells = samples.size() - 1;
    Mesh mesh;
    std::vector<float> cell_sizes;
    std::unordered_map<std::size_t, std::uint32_t> vertex_of_cell;
    Samples::for_each({0, 0, 0}, cells, 1, [&](ivec3 i) {
        Vertex vertex{};
        if (!place_vertex(samples, i, vertex.position)) return;
        vertex_of_cell[samples.index(i)] = static_cast<std::uint32_t>(mesh.vertices.size());
        mesh.vertices.push_back(vertex);
        const vec3 diagonal = samples.position(vec3(i + 1)) - samples.position(vec3(i));
        cell_sizes.push_back(glm::length(diagonal) / std::sqrt(3.0f));
    });
    // An edge that crosses the surface is shared by four cells: one quad.
    Samples::for_each({1, 1, 1}, cells, 1, [&](ivec3 i) {
        for (int axis = 0; axis < 3; ++axis) {
            ivec3 to = i;
            ++to[axis];
            const bool inside = samples.at(i) < 0.0f;
            if (inside == (samples.at(to) < 0.0f)) continue;
            ivec3 b(0);
            ivec3 c(0);
            b[(axis + 1) % 3] = 1;
            c[(axis + 2) % 3] = 1;
            const auto at = [&](ivec3 p) { return vertex_of_cell.at(samples.index(p)); };
            Face quad{at(i - b - c), at(i - c), at(i), at(i - b)};
            if (!inside) std::swap(quad[1], quad[3]);
            mesh.faces.push_back(quad);
        }
    });
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
        project(field, mesh.vertices[i], cell_sizes[i]);
    }
    return mesh;
}

std::vector<float> planes(float low, float high, float fine_low, float fine_high, float fine,
                          float coarse) {
    std::vector<float> result{low};
    while (result.back() < high) {
        const float at = result.back();
        const float outside = std::fmax(fine_low - at, at - fine_high);
        result.push_back(at + mix(fine, coarse, smooth_step(0.0f, 0.3f, outside)));
    }
    return result;
}

}  // namespace assets
