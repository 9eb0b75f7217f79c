#include "cw2-bake/geometry/weld.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>

#include <cassert>

#include "cw2-bake/geometry/index_set.h"

namespace bake {

void weld(SourceScene& scene) {
    const auto absent_uv = static_cast<std::uint32_t>(scene.uvs.size());
    scene.uvs.emplace_back(0.0f);
    std::vector<std::uint32_t> positions, normals, uvs;
    tbb::parallel_invoke(
        [&] { positions = first_equal(std::span<const glm::vec3>(scene.positions)); },
        [&] { normals = first_equal(std::span<const glm::vec3>(scene.normals)); },
        [&] { uvs = first_equal(std::span<const glm::vec2>(scene.uvs)); });

    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, scene.corners.size(), 1 << 14),
                      [&](const auto& block) {
                          for (std::size_t i = block.begin(); i < block.end(); ++i) {
                              Corner& corner = scene.corners[i];
                              assert(corner.normal != kAbsent);
                              const bool has_uv = corner.uv != kAbsent;
                              corner = {positions[corner.position], normals[corner.normal],
                                        uvs[has_uv ? corner.uv : absent_uv]};
                          }
                      });
}

}  // namespace bake
