// OBJ and MTL texts for tests: written to a folder of their own, read, and made comparable.
#pragma once

#include <cmath>
#include <random>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "cw2-bake/obj/read_obj.h"
#include "tests/support/temporary_folder.h"

struct Reading {
    bake::SourceScene scene;
    std::vector<std::string> warnings;  ///< without the folder
};

inline Reading read(const TemporaryFolder& folder, std::string_view obj,
                    std::size_t chunk_bytes = 256 * 1024) {
    Reading reading;
    const std::string prefix = folder.path().string() + "/";
    const bake::Warn warn = [&](std::string text) {
        for (std::size_t at; (at = text.find(prefix)) != text.npos;) text.erase(at, prefix.size());
        reading.warnings.push_back(text);
    };
    reading.scene = bake::read_obj(folder.write("scene.obj", obj), warn, chunk_bytes);
    return reading;
}

inline Reading read(std::string_view obj) {
    return read(TemporaryFolder{}, obj);
}

/// The message of the BakeError that reading ends in, without the folder; empty if in none.
inline std::string error_of(std::string_view obj, std::size_t chunk_bytes = 256 * 1024) {
    const TemporaryFolder folder;
    try {
        read(folder, obj, chunk_bytes);
    } catch (const bake::BakeError& error) {
        return std::string(error.what()).substr(folder.path().string().size() + 1);
    }
    return "";
}

/// A corner by its values: position, UV, normal (empty: none), material, smoothing group.
using CornerValues = std::tuple<std::vector<float>, std::vector<float>, std::vector<float>,
                                std::string, std::uint32_t>;

inline std::vector<CornerValues> corner_values(const bake::SourceScene& scene) {
    std::vector<CornerValues> values;
    for (std::size_t i = 0; i < scene.corners.size(); ++i) {
        const bake::Corner& corner = scene.corners[i];
        const glm::vec3 p = scene.positions.at(corner.position);
        std::vector<float> uv, normal;
        if (corner.uv != bake::kAbsent) {
            uv = {scene.uvs.at(corner.uv).x, scene.uvs.at(corner.uv).y};
        }
        if (corner.normal != bake::kAbsent) {
            const glm::vec3 n = scene.normals.at(corner.normal);
            normal = {n.x, n.y, n.z};
        }
        values.push_back({{p.x, p.y, p.z},
                          uv,
                          normal,
                          scene.materials.at(scene.triangle_material[i / 3]).name,
                          scene.smoothing_group.empty() ? 0 : scene.smoothing_group[i / 3]});
    }
    return values;
}

inline std::vector<std::uint32_t> numbers(const bake::RunVector& runs) {
    return {runs.begin(), runs.end()};
}

/// A well-formed OBJ of `face_count` faces in plain syntax. Positions lie on a paraboloid, so that
/// its polygons, whose corners go round, are simple.
inline std::string random_obj(std::mt19937& random, int face_count, int most_corners) {
    const auto pick = [&](int low, int high) {
        return std::uniform_int_distribution<int>(low, high)(random);
    };
    std::string text = "mtllib scene.mtl\n";
    int positions = 0, uvs = 0, normals = 0;
    const auto number = [&] { return std::to_string(pick(-9999, 9999) / 1000.0); };
    for (int face = 0; face < face_count; ++face) {
        const int corners = pick(3, most_corners);
        for (int i = 0; i < corners; ++i, ++positions) {
            const double angle = 6.2831853 * (i + pick(0, 900) / 1000.0) / corners;
            const double x = std::cos(angle) * pick(500, 1000), y = std::sin(angle) * 900;
            text += "v " + std::to_string(x) + " " + std::to_string(y) + " " +
                    std::to_string((x * x + y * y) / 1e4) + "\n";
        }
        for (int i = pick(1, 3); i > 0; --i, ++uvs)
            text += "vt " + number() + " " + number() + "\n";
        for (int i = pick(1, 3); i > 0; --i, ++normals) {
            text += "vn " + number() + " " + number() + " 1.5\n";
        }
        if (pick(0, 3) == 0) text += "g part " + std::to_string(face) + "\n";
        if (pick(0, 3) == 0) text += "s " + std::to_string(pick(0, 3)) + "\n";
        if (pick(0, 3) == 0) text += "usemtl m" + std::to_string(pick(0, 4)) + "\n";
        text += "f";
        const int form = pick(0, 3);
        for (int i = 0; i < corners; ++i) {
            const auto index = [&](int from_one, int count) {
                return std::to_string(pick(0, 1) ? from_one : from_one - count - 1);
            };
            text += ' ';
            text += index(positions - corners + i + 1, positions);
            const std::string uv = index(pick(1, uvs), uvs),
                              normal = index(pick(1, normals), normals);
            if (form == 1) text += "/" + uv;
            if (form == 2) text += "//" + normal;
            if (form == 3) text += "/" + uv + "/" + normal;
        }
        text += "\n";
    }
    return text;
}
