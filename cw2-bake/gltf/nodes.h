// The hierarchy of a glTF's nodes.
#pragma once

#include <glm/mat4x4.hpp>
#include <vector>

#include "cw2-bake/base/diagnostics.h"
#include "cw2-bake/gltf/file.h"

namespace bake {

struct GltfNodes {
    std::vector<glm::dmat4> world_from_node;  ///< one a node
    /// The nodes that the default scene shows, else all; each once, in the order in which a walk
    /// down the hierarchy meets it.
    std::vector<int> shown;
};

/// Warns of a scene that lists a node twice, or one that has a parent: it stands where its parents
/// put it.
GltfNodes walk_nodes(const GltfFile& file, const Warn& warn);

}  // namespace bake
