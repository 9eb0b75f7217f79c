// What the tests of the glTF reader have in common.
#pragma once

#include <gtest/gtest.h>

#include <glm/geometric.hpp>
#include <string>
#include <vector>

#include "cw2-bake/gltf/read_gltf.h"
#include "tests/support/gltf_writer.h"
#include "tests/support/temporary_folder.h"

class GltfReading : public testing::Test {
 protected:
    bake::SourceScene read(const GltfWriter& gltf) {
        gltf.write_glb(folder_ / "scene.glb");
        return read_file("scene.glb");
    }
    /// Warnings are kept without the folder's name.
    bake::SourceScene read_file(const std::string& name) {
        warnings_.clear();
        return bake::read_gltf(folder_ / name, [&](const std::string& warning) {
            warnings_.push_back(without_folder(warning));
        });
    }
    /// What the reader says instead of reading; empty if it reads.
    std::string error_of_file(const std::string& name) {
        try {
            read_file(name);
            return "";
        } catch (const bake::BakeError& error) {
            return without_folder(error.what());
        }
    }
    std::string error(const GltfWriter& gltf) {
        gltf.write_glb(folder_ / "scene.glb");
        return error_of_file("scene.glb");
    }

    const TemporaryFolder folder_;
    std::vector<std::string> warnings_;

 private:
    std::string without_folder(const std::string& text) const {
        const std::string prefix = folder_.path().string() + "/";
        return text.starts_with(prefix) ? text.substr(prefix.size()) : text;
    }
};

inline glm::vec3 position(const bake::SourceScene& scene, std::size_t corner) {
    return scene.positions[scene.corners[corner].position];
}
inline glm::vec3 normal(const bake::SourceScene& scene, std::size_t corner) {
    return scene.normals[scene.corners[corner].normal];
}
inline glm::vec2 uv(const bake::SourceScene& scene, std::size_t corner) {
    return scene.uvs[scene.corners[corner].uv];
}
inline std::size_t triangle_count(const bake::SourceScene& scene) {
    return scene.corners.size() / 3;
}
/// Of length 1, counter-clockwise seen from its tip.
inline glm::vec3 face_normal(const bake::SourceScene& scene, std::size_t triangle) {
    const glm::vec3 a = position(scene, 3 * triangle);
    const glm::vec3 b = position(scene, 3 * triangle + 1);
    const glm::vec3 c = position(scene, 3 * triangle + 2);
    return glm::normalize(glm::cross(b - a, c - a));
}
