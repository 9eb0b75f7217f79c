// tangents_oracle compare|record RECORDED WORK_DIR DEMO_OBJ OBJ [NODE SCRIPT PACKAGE_DIR]
//
// Compares bake::add_tangents, corner by corner, with the npm package `mikktspace`: with the
// package itself (both OBJs, too; OBJ may be missing) where PACKAGE_DIR holds it, else with the
// results for the small meshes that `record` once wrote to the file RECORDED. Exits 1 if they
// differ.
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <glm/geometric.hpp>
#include <stdexcept>
#include <utility>

#include "mesh-format/tangent_frame.h"
#include "tests/oracle/corner_mesh.h"
#include "tests/oracle/package.h"

namespace {

using oracle::CornerMesh;
using oracle::Tangents;

struct Arguments {
    std::string mode;
    std::filesystem::path recorded;
    std::filesystem::path work_dir;
    std::filesystem::path demo_obj;
    std::filesystem::path obj;
    oracle::Package package;
};

template <typename T>
void write(std::ofstream& file, const std::vector<T>& values) {
    file.write(reinterpret_cast<const char*>(values.data()),
               static_cast<std::streamsize>(values.size() * sizeof(T)));
}

template <typename T>
void read(std::ifstream& file, T* values, std::size_t count) {
    if (!file.read(reinterpret_cast<char*>(values),
                   static_cast<std::streamsize>(count * sizeof(T))))
        throw std::runtime_error("the oracle's results end too early");
}

/// FNV-1a over the bits of the mesh, so that a recorded result is never held against another mesh.
std::uint64_t fingerprint(const CornerMesh& mesh) {
    std::uint64_t hash = 0xCBF2'9CE4'8422'2325;
    const auto mix = [&](const auto& values) {
        const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
        for (std::size_t i = 0; i < values.size() * sizeof(values[0]); ++i)
            hash = (hash ^ bytes[i]) * 0x100'0000'01B3;
    };
    mix(mesh.positions);
    mix(mesh.normals);
    mix(mesh.uvs);
    return hash;
}

void record(const Arguments& arguments) {
    const std::vector<CornerMesh> meshes = oracle::small_meshes();
    const std::vector<Tangents> tangents =
        oracle::run_package(arguments.package, meshes, arguments.work_dir).tangents;
    std::ofstream file(arguments.recorded, std::ios::binary);
    for (std::size_t i = 0; i < meshes.size(); ++i) {
        write(file, std::vector{fingerprint(meshes[i])});
        write(file, tangents[i]);
    }
    if (!file.flush()) throw std::runtime_error("cannot write " + arguments.recorded.string());
}

std::vector<Tangents> read_recorded(const Arguments& arguments,
                                    const std::vector<CornerMesh>& meshes) {
    std::ifstream file(arguments.recorded, std::ios::binary);
    std::vector<Tangents> tangents;
    for (const CornerMesh& mesh : meshes) {
        std::uint64_t recorded_fingerprint = 0;
        read(file, &recorded_fingerprint, 1);
        if (recorded_fingerprint != fingerprint(mesh))
            throw std::runtime_error("the mesh '" + mesh.name +
                                     "' is not the recorded one: run tests/oracle/record.sh");
        tangents.emplace_back(mesh.positions.size());
        read(file, tangents.back().data(), tangents.back().size());
    }
    return tangents;
}

double degrees_between(const glm::vec3& a, const glm::vec3& b) {
    return std::atan2(glm::length(glm::cross(glm::dvec3(a), glm::dvec3(b))),
                      glm::dot(glm::dvec3(a), glm::dvec3(b))) *
           57.295779513082321;
}

bool same_bits(const Tangents& a, const Tangents& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
}

/// What holds with no oracle. Returns the number of properties that fail.
int check_properties(const bake::SourceScene& scene, const Tangents& ours) {
    int failures = 0;
    const auto expect = [&](bool holds, const char* property) {
        if (!holds) std::printf("    FAILED: %s\n", property);
        failures += holds ? 0 : 1;
    };
    expect(std::ranges::all_of(ours,
                               [](const glm::vec4& t) {
                                   return std::abs(glm::length(glm::vec3(t)) - 1.0f) < 1e-5f &&
                                          std::abs(t.w) == 1.0f;
                               }),
           "unit length, sign +1 or -1");
    expect(same_bits(ours, oracle::our_tangents(oracle::renumber(scene, 99))),
           "the same bits over attributes in another order");
    expect(same_bits(ours, oracle::our_tangents(scene, true)),
           "the same bits for triangles in an order of space");
    const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
    expect(same_bits(ours, oracle::our_tangents(scene)), "the same bits on one thread");
    return failures;
}

/// How many corners a form's packed frames put beyond 0.1 degree and the form's own bound of the
/// oracle's tangents, or on the other side. Left out are corners whose oracle tangent is not
/// orthogonal to a normal of unit length (UVs without area; the bake normalises): packing makes
/// it so.
std::size_t far_when_packed(const CornerMesh& mesh, const Tangents& ours, const Tangents& theirs,
                            mesh_format::FrameForm form, double bound) {
    std::size_t far = 0;
    for (std::size_t c = 0; c < ours.size(); ++c) {
        const glm::vec3 normal = mesh.normals[c];
        const glm::vec3 truth(theirs[c]);
        if (!(glm::length(truth) > 0.5f) || std::abs(glm::dot(truth, normal)) > 1e-4f ||
            std::abs(glm::length(normal) - 1.0f) > 1e-4f) {
            continue;
        }
        std::byte packed[mesh_format::frame_bytes(mesh_format::FrameForm::f32)];
        mesh_format::pack_frame(
            form, {{ours[c].x, ours[c].y, ours[c].z}, {normal.x, normal.y, normal.z}, ours[c].w},
            packed);
        const mesh_format::TangentFrame frame = mesh_format::unpack_frame(form, packed);
        const glm::vec3 tangent(frame.tangent[0], frame.tangent[1], frame.tangent[2]);
        far += frame.handedness != theirs[c].w || !(degrees_between(tangent, truth) <= 0.1 + bound);
    }
    return far;
}

/// Returns the number of failures, having printed a line about the mesh.
int compare(const CornerMesh& mesh, const Tangents& theirs) {
    const bake::SourceScene scene = oracle::scene_of(mesh);
    const Tangents ours = oracle::our_tangents(scene);
    std::size_t equal = 0;
    std::size_t far = 0;
    std::size_t wrong_sign = 0;
    std::size_t without_direction = 0;
    double worst = 0.0;
    for (std::size_t c = 0; c < ours.size(); ++c) {
        equal += std::memcmp(&ours[c], &theirs[c], sizeof ours[c]) == 0;
        wrong_sign += ours[c].w != theirs[c].w;
        if (!(glm::length(glm::vec3(theirs[c])) > 0.5f)) {
            ++without_direction;
            continue;
        }
        const double angle = degrees_between(glm::vec3(ours[c]), glm::vec3(theirs[c]));
        far += !(angle <= 0.1);
        worst = std::max(worst, angle);
    }
    std::printf(
        "%-34s %7zu  equal bits %7.3f %%  worst %.5f deg  beyond 0.1 deg %zu  wrong sign "
        "%zu  (oracle without direction %zu)\n",
        mesh.name.c_str(), ours.size(), 100.0 * double(equal) / double(ours.size()), worst, far,
        wrong_sign, without_direction);
    int failures = check_properties(scene, ours);
    if (static_cast<double>(far) > 1e-4 * static_cast<double>(ours.size()) || wrong_sign != 0) {
        std::printf("    FAILED: the oracle's tangents\n");
        ++failures;
    }
    using mesh_format::FrameForm;
    for (const auto& [form, bound] :
         {std::pair(FrameForm::quat48, 0.005), std::pair(FrameForm::quat32, 0.193),
          std::pair(FrameForm::half3, 3.3)}) {
        const std::size_t packed = far_when_packed(mesh, ours, theirs, form, bound);
        if (static_cast<double>(packed) > 1e-4 * static_cast<double>(ours.size())) {
            std::printf("    FAILED: %zu corners of packed form %d\n", packed,
                        static_cast<int>(form));
            ++failures;
        }
    }
    return failures;
}

int compare_all(const Arguments& arguments) {
    std::vector<CornerMesh> meshes = oracle::small_meshes();
    std::vector<Tangents> tangents;
    if (std::filesystem::exists(arguments.package.dir / "node_modules" / "mikktspace")) {
        std::printf("oracle: the npm package mikktspace, live\n");
        std::ranges::move(oracle::large_meshes(), std::back_inserter(meshes));
        std::ranges::move(oracle::read_obj_by_material(arguments.demo_obj),
                          std::back_inserter(meshes));
        if (std::filesystem::exists(arguments.obj))
            std::ranges::move(oracle::read_obj_by_material(arguments.obj),
                              std::back_inserter(meshes));
        else
            std::printf("skipped: no %s\n", arguments.obj.c_str());
        tangents = oracle::run_package(arguments.package, meshes, arguments.work_dir).tangents;
    } else {
        std::printf("oracle: the results recorded in %s\n", arguments.recorded.c_str());
        tangents = read_recorded(arguments, meshes);
    }
    int failures = 0;
    for (std::size_t i = 0; i < meshes.size(); ++i) failures += compare(meshes[i], tangents[i]);
    std::printf("%zu meshes, %d failures\n", meshes.size(), failures);
    return failures == 0 ? 0 : 1;
}

}  // namespace

int main(int count, char** values) {
    try {
        if (count != 6 && count != 9) throw std::runtime_error("wrong arguments");
        Arguments arguments{values[1], values[2], values[3], values[4], values[5], {}};
        if (count == 9) arguments.package = {values[6], values[7], values[8]};
        if (arguments.mode == "compare") return compare_all(arguments);
        if (arguments.mode != "record") throw std::runtime_error("wrong arguments");
        record(arguments);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "tangents_oracle: %s\n", error.what());
        return 1;
    }
}
