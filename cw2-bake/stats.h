// What a bake did, for --stats.
#pragma once

#include <chrono>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cw2-bake/geometry/chunks.h"
#include "mesh-format/layout.h"

namespace bake {

/// Takes the time of each stage.
class StageClock {
 public:
    /// Ends the stage at work, if there is one, and begins another.
    void begin(std::string_view stage);
    std::string_view at_work() const { return at_work_; }

    struct Stage {
        std::string_view name;
        double milliseconds;
    };
    /// Those that have ended.
    std::span<const Stage> stages() const { return stages_; }

 private:
    using Clock = std::chrono::steady_clock;

    Clock::time_point start_;
    std::string_view at_work_;
    std::vector<Stage> stages_;
};

/// What there is to know of the vertices' frames and of the order of triangles.
struct MeshStats {
    std::uint64_t vertices = 0;
    std::uint64_t triangles = 0;
    std::uint64_t mirrored = 0;    ///< frames of handedness -1
    std::uint64_t degenerate = 0;  ///< frames of vertices none of whose triangles spans UV area
    double acmr = 0.0;      ///< vertices transformed a triangle, with a cache of 16 (best: 0.5)
    double atvr = 0.0;      ///< vertices transformed a vertex (best: 1)
    double overdraw = 0.0;  ///< pixels shaded a pixel covered, over views along the axes
};
MeshStats measure(const FramedScene& scene, std::span<const ChunkedMesh> meshes);

/// What one bake did. Times in milliseconds, memory in bytes.
struct BakeStats {
    std::uint64_t output_bytes = 0;
    MeshStats meshes;
    mesh_format::SceneRecord scene{};  ///< holds the errors
    StageClock clock;
};

/// As JSON, with the peak memory of this process; `input_bytes` is the size of the scene file.
std::string to_json(const BakeStats& stats, std::uint64_t input_bytes);

}  // namespace bake
