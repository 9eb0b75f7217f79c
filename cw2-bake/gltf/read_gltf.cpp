#include "cw2-bake/gltf/read_gltf.h"

#include "cw2-bake/gltf/file.h"
#include "cw2-bake/gltf/nodes.h"
#include "cw2-bake/gltf/primitives.h"
#include "cw2-bake/gltf/start.h"

namespace bake {
SourceScene read_gltf(const std::filesystem::path& path, const Warn& warn) {
    const GltfFile file = load_gltf(path);
    for (const std::string& what : file.unread) warn(path.string() + ": " + what);
    SourceScene scene;
    scene.files = file.buffer_files;
    scene.files.insert(scene.files.begin(), path);

    const GltfNodes nodes = walk_nodes(file, warn);
    GltfPrimitives primitives(file, nodes, warn, scene);
    for (const int node : nodes.shown) primitives.expect_node(node);
    for (const int node : nodes.shown) primitives.add_node(node);
    primitives.warn_of_left_out();
    if (scene.corners.empty()) throw BakeError(path.string() + ": shows no triangles");
    take_camera_and_light(file, nodes, warn, scene);
    return scene;
}

}  // namespace bake
