// bench_tangents OBJ
//
// The time of bake::add_tangents beside that of the npm package `mikktspace`, in turns, on the
// corners of an OBJ (for the package one mesh a material, see read_obj_by_material). Ours takes
// welded corners; welding is part of the package's work and not of ours. Wants `node` and the
// package, which the tests install.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <numeric>
#include <stdexcept>

#include "cw2-bake/geometry/normals.h"
#include "cw2-bake/geometry/tangents.h"
#include "cw2-bake/geometry/weld.h"
#include "cw2-bake/obj/read_obj.h"
#include "tests/oracle/corner_mesh.h"
#include "tests/oracle/package.h"

namespace {

double milliseconds_of_ours(const bake::SourceScene& scene, bake::FramedTriangles triangles) {
    const auto begin = std::chrono::steady_clock::now();
    bake::add_tangents(scene, triangles);
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin)
        .count();
}

void bench(const char* obj) {
    const std::vector<oracle::CornerMesh> meshes = oracle::read_obj_by_material(obj);
    bake::SourceScene scene = bake::read_obj(obj, [](const std::string&) {});
    const std::size_t corners = scene.corners.size();
    const bake::FirstEqual positions(scene.positions);
    bake::generate_normals(scene, positions);
    const bake::FramedTriangles triangles = bake::weld(scene, positions);
    std::printf("%zu corners\n   ours ms   mikktspace ms   ratio\n", corners);
    for (int turn = 0; turn < 5; ++turn) {
        const auto theirs =
            oracle::run_package({"node", ORACLE_SCRIPT, ORACLE_DIR}, meshes, ORACLE_DIR)
                .milliseconds;
        const double their_sum = std::accumulate(theirs.begin(), theirs.end(), 0.0);
        std::vector<double> ours(9);
        for (double& run : ours) run = milliseconds_of_ours(scene, triangles);
        std::ranges::sort(ours);
        std::printf("%10.1f %15.1f %7.4f\n", ours[4], their_sum, ours[4] / their_sum);
    }
}

}  // namespace

int main(int count, char** values) {
    try {
        if (count != 2) throw std::runtime_error("usage: bench_tangents OBJ");
        bench(values[1]);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_tangents: %s\n", error.what());
        return 1;
    }
}
