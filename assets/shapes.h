// Meshes of simple shapes. All lengths in metres; +Y up; outside is where the normals point.
#pragma once

#include <functional>
#include <span>

#include "assets/model.h"

namespace assets {

/// A (nu x nv)-quad patch over [0, 1]^2. Outside is dP/du x dP/dv, from which the normals come
/// by differences.
Mesh patch(int nu, int nv, const std::function<glm::vec3(float, float)>& position,
           const std::function<glm::vec2(float, float)>& uv);

/// A smooth run of points of a profile, (outward, up). Outside is to the right of its direction,
/// so a profile runs from bottom to top.
using Stroke = std::vector<glm::vec2>;
using Profile = std::vector<Stroke>;

/// One stroke a segment: every corner sharp.
Profile sharp(const Stroke& points);

/// A smooth curve through the points (Catmull and Rom 1974), `steps` segments between two.
Stroke curve(const Stroke& points, int steps);

/// A profile turned about the Y axis. u runs `u_repeats` times around, v grows by `v_scale` per
/// metre of the profile. The points at radius 0 close the surface.
Mesh lathe(const Profile& profile, int segments, float u_repeats, float v_scale);

/// A profile moved along a horizontal polyline; outward is to the right of the path, corners are
/// mitred. u grows by `uv_scale` per metre of the path, v of the profile. A closed path repeats
/// its first point.
Mesh extrude(const Profile& profile, std::span<const glm::vec3> path, float uv_scale);

/// A box with rounded-looking edges, `bevel` wide. UVs are planar, `uv_scale` per metre.
Mesh box(glm::vec3 low, glm::vec3 high, float bevel, float uv_scale);

/// A tube around a polyline with `sides` corners, of radius_from at its start to radius_to at its
/// end (closed there if 0).
Mesh tube(std::span<const glm::vec3> path, float radius_from, float radius_to, int sides,
          float uv_scale);

/// A horizontal rectangle facing up (or down), in cells of about one metre; UVs from x and -z.
Mesh floor(glm::vec2 low_xz, glm::vec2 high_xz, float y, float uv_scale, bool facing_down = false);

/// A vertical rectangle from `from` to `to` (their y are its bottom and top), facing to the right
/// of that direction; u along it, v = y, both times `uv_scale`.
Mesh wall(glm::vec3 from, glm::vec3 to, float uv_scale);

}  // namespace assets
