#include "cw2-bake/gltf/read_gltf.h"

#include <set>

#include "cw2-bake/geometry/origin.h"
#include "cw2-bake/gltf/draco.h"
#include "cw2-bake/gltf/file.h"
#include "cw2-bake/gltf/nodes.h"
#include "cw2-bake/gltf/primitives.h"
#include "cw2-bake/gltf/start.h"

namespace bake {
namespace {

std::set<int> shown_meshes(const GltfFile& file, const GltfNodes& nodes) {
    std::set<int> meshes;
    for (const int node : nodes.shown) {
        const int mesh = file.model.nodes[static_cast<std::size_t>(node)].mesh;
        if (mesh >= 0) meshes.insert(mesh);
    }
    return meshes;
}

SourceScene triangles_of(const GltfFile& file, const GltfNodes& nodes, const Warn& warn) {
    SourceScene scene;
    GltfPrimitives primitives(file, nodes, warn, scene);
    for (const int node : nodes.shown) primitives.expect_node(node);
    for (const int node : nodes.shown) primitives.add_node(node);
    primitives.warn_of_left_out();
    if (scene.corners.empty()) throw BakeError(file.path.string() + ": shows no triangles");
    return scene;
}

}  // namespace

SourceScene read_gltf(const std::filesystem::path& path, const Warn& warn,
                      const std::filesystem::path& root) {
    GltfFile file = load_gltf(path, warn, root);
    for (const std::string& what : file.unread) warn(path.string() + ": " + what);
    GltfNodes nodes = walk_nodes(file, warn);
    decode_draco(file, shown_meshes(file, nodes));
    SourceScene scene = triangles_of(file, nodes, warn);
    glm::dvec3 origin{0.0};
    for (int i = 0; i < kMostOrigins; ++i) {
        const auto distant = distant_origin(scene.positions, scene.corners);
        if (!distant) break;
        origin += *distant;
        for (glm::dmat4& world_from_node : nodes.world_from_node)
            world_from_node[3] -= glm::dvec4(*distant, 0.0);
        scene = triangles_of(file, nodes, [](const std::string&) {});
        scene.origin = origin;
    }
    scene.files = file.buffer_files;
    scene.files.insert(scene.files.begin(), path);
    take_camera_and_light(file, nodes, warn, scene);
    for (const common::MappedFile& mapped : file.mapped) mapped.require_unchanged();
    return scene;
}

}  // namespace bake
