#include <string>

#include "tests/growth/inputs.h"
#include "tests/support/gltf_writer.h"

namespace {

using nlohmann::json;
using std::to_string;
using Path = std::filesystem::path;

Path write(const GltfWriter& gltf, const Path& folder) {
    gltf.write_gltf(folder / "scene.gltf");
    return folder / "scene.gltf";
}

/// Positions of n vertices, of which all triangles but the first are of no area.
int many_positions(GltfWriter& gltf, int n) {
    std::vector<float> positions(3 * static_cast<std::size_t>(n));
    positions[3] = positions[7] = 1;
    return gltf.accessor(positions, kFloat, "VEC3");
}
json triangle_of(GltfWriter& gltf, int positions) {
    static constexpr int kIndices = 3;  // of square_gltf()
    gltf.root["accessors"][kIndices]["count"] = 3;
    return {{"attributes", {{"POSITION", positions}}}, {"indices", kIndices}};
}

/// Each sees all bytes of one view.
Path accessors_of_one_view(const Path& folder, int n) {
    GltfWriter gltf = square_gltf();
    const int first = many_positions(gltf, n);
    json& primitives = gltf.root["meshes"][0]["primitives"];
    for (int i = 0; i < n; ++i)
        primitives.push_back(
            triangle_of(gltf, gltf.add("accessors", json(gltf.root["accessors"][first]))));
    return write(gltf, folder);
}
Path deep_nodes(const Path& folder, int n) {
    GltfWriter gltf = square_gltf();
    for (int i = 0; i < n; ++i) {
        gltf.root["nodes"][static_cast<std::size_t>(i)]["children"] = {i + 1};
        gltf.add("nodes", {{"mesh", 0}});
    }
    return write(gltf, folder);
}

Path images_of_one_view(const Path& folder, int n) {
    GltfWriter gltf = square_gltf();
    std::vector<std::uint8_t> image(static_cast<std::size_t>(100 * n), 0xFF);
    image[1] = 0xD8;  // of a JPEG, as far as this goes
    const int view = gltf.view(image);
    for (int i = 0; i < n; ++i) {
        gltf.add("images", {{"bufferView", view}});
        gltf.add("textures", {{"source", i}});
        gltf.add("materials", {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", i}}}}}});
        json again = primitive(gltf);
        again["material"] = i;
        gltf.root["meshes"][0]["primitives"].push_back(again);
    }
    return write(gltf, folder);
}
Path buffers_of_one_file(const Path& folder, int n) {
    GltfWriter gltf = square_gltf();
    gltf.bytes.resize(static_cast<std::size_t>(100 * n));
    for (int i = 0; i < n; ++i)
        gltf.add("buffers", {{"byteLength", gltf.bytes.size()}, {"uri", "scene.bin"}});
    return write(gltf, folder);
}
/// Damaged, but all that a check of sizes sees is right.
Path compressed_views_of_the_same_bytes(const Path& folder, int n) {
    GltfWriter gltf = square_gltf();
    std::vector<std::uint8_t> stream(static_cast<std::size_t>(100 * n));
    stream[0] = 0xA0;
    const json bytes = gltf.root["bufferViews"][gltf.view(stream)];
    json& primitives = gltf.root["meshes"][0]["primitives"];
    for (int i = 0; i < n; ++i) {
        const int count = 400 * n;
        const int view = gltf.add("bufferViews", {{"buffer", 0},
                                                  {"byteLength", 12 * count},
                                                  {"extensions",
                                                   {{"EXT_meshopt_compression",
                                                     {{"buffer", 0},
                                                      {"byteOffset", bytes["byteOffset"]},
                                                      {"byteLength", stream.size()},
                                                      {"byteStride", 12},
                                                      {"count", count},
                                                      {"mode", "ATTRIBUTES"}}}}}});
        primitives.push_back(triangle_of(gltf, gltf.add("accessors", {{"bufferView", view},
                                                                      {"componentType", kFloat},
                                                                      {"count", count},
                                                                      {"type", "VEC3"}})));
    }
    return write(gltf, folder);
}

Path unknown_extensions(const Path& folder, int n) {
    GltfWriter gltf = square_gltf();
    for (int i = 0; i < n; ++i) gltf.root["extensions"]["EXT_" + to_string(i)] = json::object();
    return write(gltf, folder);
}

}  // namespace

std::vector<Input> gltf_inputs() {
    return {{"accessors of one view", accessors_of_one_view, 30},
            {"deep nodes", deep_nodes, 60},
            {"images of one view", images_of_one_view, 20},
            {"buffers of one file", buffers_of_one_file, 100},
            {"compressed views of the same bytes", compressed_views_of_the_same_bytes, 20},
            {"unknown extensions", unknown_extensions, 100}};
}
