// Every byte of a baked file is defined: memory that was handed out with other contents, and work
// that was divided otherwise, give the same file.
#include <gtest/gtest.h>

#include <set>
#include <span>
#include <string>
#include <vector>

#include "mesh-format/file.h"
#include "tests/cli/scene_folder.h"

namespace {

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

    /// Bakes where glibc fills what malloc hands out with the complement of `perturb`.
    std::string baked(const std::string& perturb, std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), {BAKE_PROGRAM, "forms.obj"});
        arguments.insert(arguments.end(), {"--quiet", "-o", "out.cw2mesh"});
        std::filesystem::remove(here("out.cw2mesh"));
        const Outcome outcome = run(arguments, {{"MALLOC_PERTURB_=" + perturb}, folder_.path()});
        EXPECT_EQ(outcome.status, 0) << outcome.err;
        return read("out.cw2mesh");
    }
};

TEST_F(DefinedBytes, InEveryForm) {
    for (const char* frame : {"quat48", "quat32", "half3", "f32"}) {
        for (const char* positions : {"quantised", "f32"}) {
            for (const bool compress : {false, true}) {
                SCOPED_TRACE(std::string(frame) + ' ' + positions +
                             (compress ? " compressed" : ""));
                std::vector<std::string> form = {"--tangent-frame", frame, "--positions",
                                                 positions};
                if (compress) form.push_back("--compress");
                std::vector<std::string> on_one = form, on_three = form;
                on_one.insert(on_one.end(), {"--threads", "1"});
                on_three.insert(on_three.end(), {"--threads", "3"});
                const std::string file = baked("85", on_one);
                ASSERT_FALSE(file.empty());
                EXPECT_TRUE(file == baked("170", on_one));
                EXPECT_TRUE(file == baked("170", on_three));
            }
        }
    }
}

TEST_F(DefinedBytes, TheSceneHasAllForms) {
    const std::string file = baked("85", {});
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
