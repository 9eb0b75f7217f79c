
#include "assets/shapes.h"

namespace assets {
namespace {

using glm::vec2;
using glm::vec3;

/// The face of a box across one axis: its normal and the directions of u and v, u x v = normal.
struct Side {
    vec3 normal;
    vec3 u;
    vec3 v;
};

const std::array<Side, 6> kSides{{{{1, 0, 0}, {0, 0, -1}, {0, 1, 0}},
                                  {{-1, 0, 0}, {0, 0, 1}, {0, 1, 0}},
                                  {{0, 1, 0}, {1, 0, 0}, {0, 0, -1}},
                                  {{0, -1, 0}, {1, 0, 0}, {0, 0, 1}},
                                  {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}},
                                  {{0, 0, -1}, {-1, 0, 0}, {0, 1, 0}}}};

class BoxBuilder {
 public:
    BoxBuilder(vec3 low, vec3 high, float bevel, float uv_scale)
        : centre_(0.5f * (low + high)),
          half_(0.5f * (high - low)),
          bevel_(bevel),
          uv_scale_(uv_scale) {}

    Mesh build() {
        for (const Side& side : kSides) {
            add(side, {{side, -side.u - side.v},
                       {side, side.u - side.v},
                       {side, side.u + side.v},
                       {side, side.v - side.u}});
        }
        if (bevel_ == 0.0f) return mesh_;
        for (std::size_t a = 0; a < 6; ++a) {
            for (std::size_t b = a + 1; b < 6; ++b) {
                if (kSides[a].normal + kSides[b].normal != vec3(0.0f)) edge(kSides[a], kSides[b]);
            }
        }
        for (int corner = 0; corner < 8; ++corner) {
            const vec3 sign(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
            const Side& x = kSides[corner & 1 ? 0 : 1];
            const Side& y = kSides[corner & 2 ? 2 : 3];
            const Side& z = kSides[corner & 4 ? 4 : 5];
            add(x, {{x, sign}, {y, sign}, {z, sign}});
        }
        return mesh_;
    }

 private:
    /// A corner of the flat part of `side`, in the octant of `sign`.
    struct Corner {
        Side side;
        vec3 sign;
    };

    void edge(const Side& a, const Side& b) {
        const vec3 along = glm::cross(a.normal, b.normal);
        const vec3 diagonal = a.normal + b.normal;
        add(a, {{a, diagonal - along},
                {a, diagonal + along},
                {b, diagonal + along},
                {b, diagonal - along}});
    }

    /// A face with the UV projection of `projection`, wound so that it faces outward.
    void add(const Side& projection, std::vector<Corner> corners) {
        std::vector<Vertex> vertices;
        vec3 outward(0.0f);
        for (const Corner& corner : corners) {
            const vec3 along_normal = corner.side.normal * corner.side.normal;
            const vec3 inset = half_ - bevel_ * (vec3(1.0f) - along_normal);
            const vec3 p = centre_ + glm::sign(corner.sign + corner.side.normal) * inset;
            vertices.push_back(
                {p, corner.side.normal,
                 vec2(glm::dot(p, projection.u), glm::dot(p, projection.v)) * uv_scale_});
            outward += corner.side.normal;
        }
        const vec3 facing = glm::cross(vertices[1].position - vertices[0].position,
                                       vertices[2].position - vertices[0].position);
        Face face{kNoCorner, kNoCorner, kNoCorner, kNoCorner};
        const auto base = static_cast<std::uint32_t>(mesh_.vertices.size());
        const auto count = static_cast<std::uint32_t>(vertices.size());
        for (std::uint32_t i = 0; i < count; ++i) {
            face[i] = base + (glm::dot(facing, outward) > 0.0f ? i : count - 1 - i);
        }
        mesh_.vertices.insert(mesh_.vertices.end(), vertices.begin(), vertices.end());
        mesh_.faces.push_back(face);
    }

    vec3 centre_;
    vec3 half_;
    float bevel_;
    float uv_scale_;
    Mesh mesh_;
};

}  // namespace

Mesh box(vec3 low, vec3 high, float bevel, float uv_scale) {
    return BoxBuilder(low, high, bevel, uv_scale).build();
}

}  // namespace assets
