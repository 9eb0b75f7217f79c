// Every byte of a baked file is defined: memory that was handed out with other contents, and work
// that was divided otherwise, give the same file.
#include <gtest/gtest.h>

#include <cstdlib>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "mesh-format/file.h"
#include "tests/cli/scene_folder.h"

namespace {

/// Members of the statistics.
constexpr const char* kMeasured[] = {"milliseconds", "total_milliseconds", "peak_memory_bytes",
                                     "read_megabytes_per_second"};

/// A scene whose vertices have parts of all forms, and counts of vertices that are no multiple
/// of 4.
class DefinedBytes : public SceneFolder {
 protected:
    void SetUp() override {
        SceneFolder::SetUp();
        write("forms.obj",
              "mtllib scene.mtl\n"
              "v -1 -1 0.1\nv 1 -1 0\nv 1 1 0.3\nv -1 1 0\nv 0.3 0.1 1.7\n"
              "v 0 0 2 1 0.5 0.25\nv 1 0 2 0.2 0.4 0.6\nv 0 1 2 0 1 0\n"
              "vt 0 0\nvt 1.3 0\nvt 1 1\nvt 0.1 0.7\nvt 30000.3 20000.7\n"
              "usemtl stone\nf 1/1 2/2 3/3 4/4\n"
              "usemtl leaf\nf 2/2 3/3 5/5\n"  // 16 bits do not hold this range of UVs
              "usemtl plain\nf 6 7 8\n");
    }

    /// What a bake writes, and says that it did but for the time that it took.
    struct Written {
        std::string file, stats;
        bool operator==(const Written&) const = default;
    };

    /// Bakes where glibc fills what malloc hands out with the complement of `perturb`.
    Written baked(const std::string& perturb, std::vector<std::string> arguments,
                  const std::string& output = "out.cw2mesh") {
        arguments.insert(arguments.begin(), {BAKE_PROGRAM, "forms.obj"});
        arguments.insert(arguments.end(), {"--quiet", "-o", output, "--stats", "stats.json"});
        for (const std::string& name : {output, std::string("stats.json")})
            std::filesystem::remove(here(name));
        const Outcome outcome = run(arguments, {{"MALLOC_PERTURB_=" + perturb}, folder_.path()});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        auto stats = nlohmann::json::parse(read("stats.json"));
        for (const char* measured : kMeasured) EXPECT_EQ(stats.erase(measured), 1u) << measured;
        return {read(output), stats.dump()};
    }

    static std::vector<std::vector<std::string>> all_forms() {
        std::vector<std::vector<std::string>> forms;
        for (const char* frame : {"quat48", "quat32", "half3", "f32"}) {
            for (const char* positions : {"quantised", "f32"}) {
                forms.push_back({"--tangent-frame", frame, "--positions", positions});
                forms.push_back(forms.back());
                forms.back().emplace_back("--compress");
            }
        }
        return forms;
    }
    static std::vector<std::string> with(std::vector<std::string> arguments,
                                         const std::vector<std::string>& more) {
        arguments.insert(arguments.end(), more.begin(), more.end());
        return arguments;
    }
};

TEST_F(DefinedBytes, InEveryFormOnAnyNumberOfThreads) {
    for (const std::vector<std::string>& form : all_forms()) {
        for (const char* output : {"out.cw2mesh", "out.glb"}) {
            if (form.back() == "--compress" && output == std::string("out.glb")) continue;
            const Written first = baked("85", with(form, {"--threads", "1"}), output);
            ASSERT_FALSE(first.file.empty());
            for (const char* threads : {"1", "2", "3", "5"}) {
                SCOPED_TRACE(testing::PrintToString(form) + output + threads);
                EXPECT_TRUE(first == baked("170", with(form, {"--threads", threads}), output));
            }
        }
    }
}

/// What has other contents from run to run, valgrind knows to be undefined. CW2_EVERY_FAULT=1 tries
/// all forms.
TEST_F(DefinedBytes, NoUndefinedOneIsUsedOrWritten) {
    auto forms = all_forms();
    if (!std::getenv("CW2_EVERY_FAULT")) forms = {forms.front(), forms.back()};
    for (const auto& form : forms) {
        for (const char* output : {"out.cw2mesh", "out.glb"}) {
            if (form.back() == "--compress" && output == std::string("out.glb")) continue;
            const Outcome outcome =
                run(with({VALGRIND, "-q", "--error-exitcode=9", BAKE_PROGRAM, "forms.obj", "-o",
                          output, "--stats", "stats.json", "--threads", "2", "--quiet"},
                         form),
                    {{}, folder_.path()});
            EXPECT_EQ(outcome.status, 0) << testing::PrintToString(form) << outcome.err;
        }
    }
}

TEST_F(DefinedBytes, TheSceneHasAllForms) {
    const std::string file = baked("85", {}).file;
    const auto scene = mesh_format::parse(std::as_bytes(std::span(file)), "out.cw2mesh");
    std::set<mesh_format::UvForm> uvs;
    std::set<mesh_format::ColorForm> colors;
    for (const mesh_format::MeshRecord& mesh : scene.meshes) {
        uvs.insert(mesh.forms.uv);
        colors.insert(mesh.forms.color);
    }
    EXPECT_EQ(scene.meshes.size(), 3u);
    EXPECT_EQ(uvs.size(), 2u);
    EXPECT_EQ(colors.size(), 2u);
}

}  // namespace
