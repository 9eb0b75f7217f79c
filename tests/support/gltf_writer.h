// Small glTF files for tests: the JSON as the test states it, one buffer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

enum : int { kByte = 5120, kUbyte, kShort, kUshort, kUint = 5125, kFloat };

class GltfWriter {
 public:
    nlohmann::json root = {{"asset", {{"version", "2.0"}}}};
    std::vector<std::byte> bytes;

    /// Appends a view of `values`, at a multiple of 4; returns its index.
    template <typename T>
    int view(const std::vector<T>& values, int stride = 0) {
        bytes.resize((bytes.size() + 3) / 4 * 4);
        nlohmann::json view{
            {"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", values.size() * sizeof(T)}};
        if (stride > 0) view["byteStride"] = stride;
        const auto* const first = reinterpret_cast<const std::byte*>(values.data());
        bytes.insert(bytes.end(), first, first + values.size() * sizeof(T));
        return add("bufferViews", std::move(view));
    }

    /// Appends a view and an accessor of all of it; returns the accessor's index.
    template <typename T>
    int accessor(const std::vector<T>& values, int component_type, const std::string& type,
                 bool normalized = false) {
        const int components = type == "SCALAR" ? 1 : type.back() - '0';
        nlohmann::json accessor{{"bufferView", view(values)},
                                {"componentType", component_type},
                                {"count", values.size() / static_cast<std::size_t>(components)},
                                {"type", type}};
        if (normalized) accessor["normalized"] = true;
        return add("accessors", std::move(accessor));
    }

    /// Appends to a top-level array; returns the index.
    int add(const char* array, nlohmann::json element) {
        root[array].push_back(std::move(element));
        return static_cast<int>(root[array].size()) - 1;
    }

    void write_glb(const std::filesystem::path& path) const {
        std::ofstream(path, std::ios::binary) << glb();
    }
    std::string glb() const {
        nlohmann::json complete = root;
        std::string binary(reinterpret_cast<const char*>(bytes.data()), bytes.size());
        binary.resize((binary.size() + 3) / 4 * 4);
        if (!complete.contains("buffers")) complete["buffers"] = {{{"byteLength", bytes.size()}}};
        std::string json = complete.dump();
        json.resize((json.size() + 3) / 4 * 4, ' ');
        std::string file = "glTF" + word(2) + word(12 + 8 + json.size() + 8 + binary.size());
        file += word(json.size()) + "JSON" + json;
        return file + word(binary.size()) + std::string("BIN\0", 4) + binary;
    }

    /// The buffer goes to the file `name`.bin beside it.
    void write_gltf(const std::filesystem::path& path) const {
        std::filesystem::path buffer = path;
        buffer.replace_extension("bin");
        nlohmann::json complete = root;
        if (!complete.contains("buffers")) {
            complete["buffers"] = {
                {{"byteLength", bytes.size()}, {"uri", buffer.filename().string()}}};
        }
        std::ofstream(path) << complete.dump(1);
        std::ofstream(buffer, std::ios::binary)
            .write(reinterpret_cast<const char*>(bytes.data()),
                   static_cast<std::streamsize>(bytes.size()));
    }

 private:
    static std::string word(std::size_t value) {
        const auto number = static_cast<std::uint32_t>(value);
        std::string text(4, '\0');
        std::memcpy(text.data(), &number, 4);
        return text;
    }
};

/// A square from (-1, -1, 0) to (1, 1, 0) that faces +z, its image upright: positions, normals, UVs
/// and indices as mesh 0, shown by node 0.
inline GltfWriter square_gltf() {
    GltfWriter gltf;
    const int positions =
        gltf.accessor<float>({-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0}, kFloat, "VEC3");
    const int normals = gltf.accessor<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, kFloat, "VEC3");
    const int uvs = gltf.accessor<float>({0, 1, 1, 1, 1, 0, 0, 0}, kFloat, "VEC2");
    const int indices = gltf.accessor<std::uint16_t>({0, 1, 2, 0, 2, 3}, kUshort, "SCALAR");
    gltf.root["meshes"][0]["primitives"][0] = {
        {"attributes", {{"POSITION", positions}, {"NORMAL", normals}, {"TEXCOORD_0", uvs}}},
        {"indices", indices}};
    gltf.root["nodes"][0] = {{"mesh", 0}};
    gltf.root["scenes"][0]["nodes"] = {0};
    gltf.root["scene"] = 0;
    return gltf;
}

/// The first primitive of the first mesh.
inline nlohmann::json& primitive(GltfWriter& gltf) {
    return gltf.root["meshes"][0]["primitives"][0];
}
