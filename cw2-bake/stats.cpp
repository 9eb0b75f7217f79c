#include "cw2-bake/stats.h"

#include <fmt/format.h>
#include <meshoptimizer.h>
#include <sys/resource.h>

#include <algorithm>
#include <iterator>

namespace bake {

namespace {

// What gltfpack and others measure with.
constexpr unsigned kCacheSize = 16;

/// A mesh of its own, as meshoptimizer takes it.
struct PlainMesh {
    std::vector<std::uint32_t> indices;
    std::vector<glm::vec3> positions;
    std::vector<glm::vec2> uvs;
};

PlainMesh plain(const FramedScene& scene, const ChunkedMesh& mesh) {
    PlainMesh result;
    result.indices.assign(mesh.indices.begin(), mesh.indices.end());
    for (const std::uint32_t vertex : mesh.vertices) {
        result.positions.push_back(scene.position(vertex));
        result.uvs.push_back(scene.uv(vertex));
    }
    return result;
}

/// Vertices none of whose triangles spans area in UV.
std::uint64_t count_degenerate(const PlainMesh& mesh) {
    std::vector<bool> spans(mesh.positions.size());
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        const glm::vec2& a = mesh.uvs[mesh.indices[i]];
        const glm::vec2& b = mesh.uvs[mesh.indices[i + 1]];
        const glm::vec2& c = mesh.uvs[mesh.indices[i + 2]];
        if ((b.x - a.x) * (c.y - a.y) == (c.x - a.x) * (b.y - a.y)) continue;
        for (std::size_t corner = i; corner < i + 3; ++corner) spans[mesh.indices[corner]] = true;
    }
    return static_cast<std::uint64_t>(std::count(spans.begin(), spans.end(), false));
}

}  // namespace

void StageClock::begin(std::string_view stage) {
    const Clock::time_point now = Clock::now();
    if (!at_work_.empty())
        stages_.push_back(
            {at_work_, std::chrono::duration<double, std::milli>(now - start_).count()});
    at_work_ = stage;
    start_ = now;
}

MeshStats measure(const FramedScene& scene, std::span<const ChunkedMesh> meshes) {
    MeshStats stats;
    double transformed = 0.0;
    double covered = 0.0;
    double shaded = 0.0;
    for (const ChunkedMesh& chunked : meshes) {
        const PlainMesh mesh = plain(scene, chunked);
        stats.vertices += mesh.positions.size();
        stats.triangles += mesh.indices.size() / 3;
        stats.mirrored += static_cast<std::uint64_t>(std::ranges::count_if(
            chunked.vertices,
            [&](std::uint32_t vertex) { return scene.framed.vertices[vertex].tangent.w < 0.0f; }));
        stats.degenerate += count_degenerate(mesh);
        transformed += meshopt_analyzeVertexCache(mesh.indices.data(), mesh.indices.size(),
                                                  mesh.positions.size(), kCacheSize, 0, 0)
                           .vertices_transformed;
        const meshopt_OverdrawStatistics overdraw = meshopt_analyzeOverdraw(
            mesh.indices.data(), mesh.indices.size(), &mesh.positions.front().x,
            mesh.positions.size(), sizeof(glm::vec3));
        covered += overdraw.pixels_covered;
        shaded += overdraw.pixels_shaded;
    }
    stats.acmr = transformed / static_cast<double>(stats.triangles);
    stats.atvr = transformed / static_cast<double>(stats.vertices);
    stats.overdraw = covered > 0.0 ? shaded / covered : 0.0;
    return stats;
}

std::string to_json(const BakeStats& stats, std::uint64_t input_bytes) {
    std::string stages;
    double total = 0.0;
    double parse = 0.0;
    for (const StageClock::Stage& stage : stats.clock.stages()) {
        fmt::format_to(std::back_inserter(stages), "{}\n    \"{}\": {:.3f}",
                       stages.empty() ? "" : ",", stage.name, stage.milliseconds);
        total += stage.milliseconds;
        if (stage.name == "read") parse = stage.milliseconds;
    }
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return fmt::format(
        "{{\n  \"input_bytes\": {},\n  \"output_bytes\": {},\n  \"peak_memory_bytes\": {},\n"
        "  \"vertices\": {},\n  \"triangles\": {},\n"
        "  \"frames\": {{\n    \"generated\": {},\n    \"mirrored\": {},\n    \"degenerate\": {},\n"
        "    \"error_mean_degrees\": {},\n    \"error_max_degrees\": {}\n  }},\n"
        "  \"position_error\": {},\n  \"uv_error_texels\": {},\n"
        "  \"acmr\": {:.4f},\n  \"atvr\": {:.4f},\n  \"overdraw\": {:.4f},\n"
        "  \"read_megabytes_per_second\": {:.1f},\n"
        "  \"milliseconds\": {{{}\n  }},\n  \"total_milliseconds\": {:.3f}\n}}\n",
        input_bytes, stats.output_bytes, std::uint64_t(usage.ru_maxrss) * 1024,
        stats.meshes.vertices, stats.meshes.triangles, stats.meshes.vertices, stats.meshes.mirrored,
        stats.meshes.degenerate, stats.scene.frame_error_mean, stats.scene.frame_error_max,
        stats.scene.position_error, stats.scene.uv_error, stats.meshes.acmr, stats.meshes.atvr,
        stats.meshes.overdraw, static_cast<double>(input_bytes) / (1000.0 * parse), stages, total);
}

}  // namespace bake
