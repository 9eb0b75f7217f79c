// Our OBJ reader against tinyobjloader, on what both define.
#define TINYOBJLOADER_IMPLEMENTATION
#include <gtest/gtest.h>
#include <tiny_obj_loader.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "obj_text.h"

namespace {

constexpr const char* kMaterials =
    "newmtl m0\nnewmtl m1\nnewmtl m2\nnewmtl m3\nnewmtl m4\n"
    "newmtl m5\nnewmtl m6\nnewmtl m7\nnewmtl m8\nnewmtl m9\n";

/// The corners of one face, as far as texts that both read alike can tell.
using Face = std::vector<CornerValues>;

std::optional<std::vector<Face>> read_with_peer(const std::string& text) {
    tinyobj::ObjReaderConfig config;
    config.triangulate = false;
    tinyobj::ObjReader reader;
    if (!reader.ParseFromString(text, kMaterials, config)) return std::nullopt;
    const auto& a = reader.GetAttrib();
    std::vector<Face> faces;
    for (const tinyobj::shape_t& shape : reader.GetShapes()) {
        std::size_t next = 0;
        for (std::size_t f = 0; f < shape.mesh.num_face_vertices.size(); ++f) {
            Face face;
            const int material = shape.mesh.material_ids[f];
            for (unsigned i = 0; i < shape.mesh.num_face_vertices[f]; ++i) {
                const tinyobj::index_t index = shape.mesh.indices[next++];
                const auto values = [](const auto& array, int at, int n) {
                    return at < 0 ? std::vector<float>{}
                                  : std::vector<float>(array.begin() + at * n,
                                                       array.begin() + at * n + n);
                };
                face.push_back({values(a.vertices, index.vertex_index, 3),
                                values(a.texcoords, index.texcoord_index, 2),
                                values(a.normals, index.normal_index, 3),
                                material < 0 ? "default" : reader.GetMaterials()[material].name,
                                shape.mesh.smoothing_group_ids[f]});
            }
            if (face.size() >= 3) faces.push_back(face);
        }
    }
    return faces;
}

bool close(const std::vector<float>& a, const std::vector<float>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](float x, float y) {
        return std::abs(x - y) <= 1e-5f * std::max(1.0f, std::abs(x));
    });
}

/// The peer's normals are as stated, ours of length 1.
std::vector<float> unit(std::vector<float> n) {
    if (n.empty()) return n;
    const double length = std::hypot(double{n[0]}, double{n[1]}, double{n[2]});
    if (length == 0) return {};
    for (float& x : n) x = static_cast<float>(x / length);
    return n;
}

bool close(const CornerValues& ours, const CornerValues& peers, bool compare_smoothing) {
    const auto& [p, uv, n, material, smoothing] = ours;
    const auto& [peer_p, peer_uv, peer_n, peer_material, peer_smoothing] = peers;
    return close(p, peer_p) && close(uv, peer_uv) && close(n, unit(peer_n)) &&
           material == peer_material && (!compare_smoothing || smoothing == peer_smoothing);
}

/// Each face of n corners must be n - 2 of our triangles, which use each of its corners and no
/// other corner.
void expect_same(const std::string& text, const bake::SourceScene& scene,
                 const std::vector<Face>& faces) {
    const std::vector<CornerValues> ours = corner_values(scene);
    std::size_t next = 0;
    for (const Face& face : faces) {
        const std::size_t end = next + 3 * (face.size() - 2);
        ASSERT_LE(end, ours.size()) << text;
        const auto is_close = [&](const CornerValues& a, const CornerValues& b) {
            return close(a, b, !scene.smoothing_group.empty());
        };
        for (const CornerValues& corner : face) {
            ASSERT_TRUE(std::any_of(ours.begin() + next, ours.begin() + end, [&](const auto& mine) {
                return is_close(mine, corner);
            })) << text;
        }
        for (; next < end; ++next) {
            ASSERT_TRUE(std::any_of(face.begin(), face.end(), [&](const auto& corner) {
                return is_close(ours[next], corner);
            })) << text;
        }
    }
    ASSERT_EQ(next, ours.size()) << text;
}

TEST(ObjPeer, ReadsGeneratedFilesAlike) {
    std::mt19937 random(3);
    const TemporaryFolder folder;
    folder.write("scene.mtl", kMaterials);
    for (int i = 0; i < 60; ++i) {
        const std::string text = random_obj(random, 40, 9);
        const auto faces = read_with_peer(text);
        ASSERT_TRUE(faces);
        expect_same(text, read(folder, text, 500).scene, *faces);
        if (HasFatalFailure()) return;
    }
}

/// Alters digits, and whole lines, so that the file mostly stays one.
std::string altered(std::string text, std::mt19937& random) {
    const auto pick = [&](std::size_t below) {
        return std::uniform_int_distribution<std::size_t>(0, below - 1)(random);
    };
    for (std::size_t n = 1 + pick(3); n > 0; --n) {
        std::size_t at = pick(text.size());
        const std::size_t start = text.rfind('\n', at) + 1;
        const std::size_t end = text.find('\n', start) + 1;
        if (start == 0) continue;  // mtllib, which the peer is not asked to follow
        switch (pick(4)) {
            case 0:
                while (at < text.size() && !std::isdigit(static_cast<unsigned char>(text[at])))
                    ++at;
                if (at < text.size()) text[at] = static_cast<char>('1' + pick(9));
                break;
            case 1:
                text.erase(start, end - start);
                break;
            case 2:
                text.insert(start, text.substr(start, end - start));
                break;
            default:
                text.insert(start, " \t");
                break;
        }
    }
    return text;
}

TEST(ObjPeer, ReadsAlteredFilesAlikeWhereItReadsThem) {
    std::mt19937 random(4);
    const TemporaryFolder folder;
    folder.write("scene.mtl", kMaterials);
    int compared = 0;
    for (int i = 0; i < 1000; ++i) {
        const std::string text = altered(random_obj(random, 8, 6), random);
        std::optional<Reading> reading;
        try {
            reading = read(folder, text, 200);
        } catch (const bake::BakeError&) {
            continue;  // the peer takes indices out of range
        }
        const bool mended = std::ranges::any_of(reading->warnings, [](const std::string& warning) {
            return warning.find("that is missing") != warning.npos;
        });
        if (mended) continue;  // of attributes, too
        const auto faces = read_with_peer(text);
        ASSERT_TRUE(faces) << text;
        expect_same(text, reading->scene, *faces);
        if (HasFatalFailure()) return;
        ++compared;
    }
    EXPECT_GT(compared, 200);
}

}  // namespace
