// bench_frames OBJ CW2MESH GLB
//
// How far the tangent frames of a bake of OBJ, and those of a glTF that another tool made of it,
// are from MikkTSpace's, in degrees. The bake states its own error. A corner of the glTF is held
// against whichever vertex near its place it is closest to: its true error is this or more.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <glm/common.hpp>
#include <map>
#include <stdexcept>
#include <tuple>

#include "common/io.h"
#include "cw2-bake/geometry/normals.h"
#include "cw2-bake/geometry/tangents.h"
#include "cw2-bake/geometry/weld.h"
#include "cw2-bake/gltf/read_gltf.h"
#include "cw2-bake/obj/read_obj.h"
#include "mesh-format/file.h"
#include "mesh-format/tangent_frame.h"

namespace {

using bake::SourceScene;
using mesh_format::TangentFrame;

/// A scene and its vertices.
struct Framed {
    SourceScene scene;
    bake::FramedTriangles triangles;

    explicit Framed(SourceScene from) : scene(std::move(from)) {
        const bake::FirstEqual positions(scene.positions);
        bake::generate_normals(scene, positions);
        triangles = bake::weld(scene, positions);
        bake::add_tangents(scene, triangles);
    }
};

/// With the tangent made orthogonal to the normal, as every form of a vertex has it, and its hand
/// forgotten, as it hangs on which way a format counts v.
TangentFrame frame_of(const SourceScene& scene, const bake::FramedVertex& vertex) {
    const glm::vec3& n = scene.normals[vertex.corner.normal];
    const glm::vec4& t = vertex.tangent;
    std::byte exact[mesh_format::frame_bytes(mesh_format::FrameForm::f32)];
    mesh_format::pack_frame(mesh_format::FrameForm::f32, {{t.x, t.y, t.z}, {n.x, n.y, n.z}, t.w},
                            exact);
    TangentFrame frame = mesh_format::unpack_frame(mesh_format::FrameForm::f32, exact);
    frame.handedness = 1;
    return frame;
}

/// The true frames, by place.
class Truth {
 public:
    explicit Truth(const Framed& framed) : scene_(framed.scene) {
        glm::vec3 low = scene_.positions.front(), high = low;
        for (const glm::vec3& p : scene_.positions) {
            low = glm::min(low, p);
            high = glm::max(high, p);
        }
        const glm::vec3 size = high - low;
        // 16 bits for the longest side round by half a step at most; the cells are some steps wide.
        cell_ = std::max({size.x, size.y, size.z}) / 16384.0f;
        for (const bake::FramedVertex& vertex : framed.triangles.vertices)
            places_[cell(scene_.positions[vertex.corner.position])].push_back(&vertex);
    }

    /// The angle to the closest frame near `position`, or -1 if there is no vertex.
    double angle(const glm::vec3& position, const TangentFrame& frame) const {
        double least = -1;
        const auto [x, y, z] = cell(position);
        for (int i = 0; i < 27; ++i) {
            const auto place = places_.find({x + i % 3 - 1, y + i / 3 % 3 - 1, z + i / 9 - 1});
            if (place == places_.end()) continue;
            for (const bake::FramedVertex* vertex : place->second) {
                const double angle = mesh_format::frame_angle(frame, frame_of(scene_, *vertex));
                least = least < 0 ? angle : std::min(least, angle);
            }
        }
        return least;
    }

 private:
    std::tuple<int, int, int> cell(const glm::vec3& p) const {
        return {static_cast<int>(std::floor(p.x / cell_)),
                static_cast<int>(std::floor(p.y / cell_)),
                static_cast<int>(std::floor(p.z / cell_))};
    }

    const SourceScene& scene_;
    float cell_ = 0;
    std::map<std::tuple<int, int, int>, std::vector<const bake::FramedVertex*>> places_;
};

void bench(const char* obj, const char* baked, const char* gltf) {
    const auto warn = [](const std::string&) {};
    const Framed source(bake::read_obj(obj, warn));
    const Truth truth(source);
    const Framed peer(bake::read_gltf(gltf, warn));
    std::vector<double> angles;
    for (const bake::FramedVertex& vertex : peer.triangles.vertices) {
        const double angle =
            truth.angle(peer.scene.positions[vertex.corner.position], frame_of(peer.scene, vertex));
        if (angle >= 0) angles.push_back(angle);
    }
    if (angles.empty()) throw std::runtime_error("the glTF has no vertex near one of the OBJ");
    std::ranges::sort(angles);
    double sum = 0;
    for (const double angle : angles) sum += angle;
    const double theirs = sum / static_cast<double>(angles.size());
    const common::MappedFile file(baked);
    const float ours = mesh_format::parse(file.bytes(), baked).scene.frame_error_mean;
    std::printf("mean %.4f beside %.4f degrees, %.0f times as close (their median %.4f)\n", ours,
                theirs, theirs / ours, angles[angles.size() / 2]);
}

}  // namespace

int main(int count, char** values) {
    try {
        if (count != 4) throw std::runtime_error("usage: bench_frames OBJ CW2MESH GLB");
        bench(values[1], values[2], values[3]);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_frames: %s\n", error.what());
        return 1;
    }
}
