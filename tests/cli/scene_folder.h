// A folder with a small scene of all kinds of maps, where cw2-bake runs.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "tests/support/image.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

class SceneFolder : public testing::Test {
 protected:
    void SetUp() override {
        write("scene.mtl",
              "newmtl stone\nKd 0.5 0.6 0.7\nmap_Kd colors.png\nPr 0.5\nmap_Pr rough 1.png\n"
              "norm normals.png\n"
              "newmtl leaf\nmap_Kd colors.png\nmap_d mask.png\n"
              "newmtl plain\nKd 0.2 0.3 0.4\nPr 0.25\nPm 1\n");
        write("scene.obj",
              "mtllib scene.mtl\n"
              "v -1 -1 0.1\nv 1 -1 0\nv 1 1 0.3\nv -1 1 0\nv 0.3 0.1 1.7\n"
              "vt 0 0\nvt 1.3 0\nvt 1 1\nvt 0.1 0.7\nvt -0.4 0.45\n"
              "usemtl stone\nf 1/1 2/2 3/3 4/4\nf 1/1 3/3 5/5\n"
              "usemtl leaf\nf 2/2 3/3 5/5\nusemtl plain\nf 3 4 5\nf 4 1 5\n");
        const auto texel = [](int x, int y) { return 0.1 + 0.05 * (x % 7) + 0.06 * (y % 9); };
        paint("colors.png", 16, 3, [&](int x, int y) {
            return std::vector{texel(x, y), texel(y, x), texel(x + 3, y)};
        });
        paint("rough 1.png", 8, 1, [&](int x, int y) { return std::vector{texel(x, y)}; });
        paint("normals.png", 8, 3, [&](int x, int y) {
            return std::vector{0.4 + 0.1 * (x % 3), 0.6 - 0.1 * (y % 3), 0.95};
        });
        paint("mask.png", 16, 1, [](int x, int y) { return std::vector{x > y ? 1.0 : 0.0}; });
    }

    Outcome bake(std::vector<std::string> arguments) {
        arguments.insert(arguments.begin(), BAKE_PROGRAM);
        return run(arguments, {{}, folder_.path()});
    }
    /// Bakes, and fails the test unless that works without a warning.
    void bake_well(const std::vector<std::string>& arguments) {
        const Outcome outcome = bake(arguments);
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        ASSERT_EQ(outcome.err, "");
    }
    void write(const std::string& name, const std::string& text) const {
        folder_.write(name, text);
    }
    std::string read(const std::string& name) const {
        std::ifstream file(folder_ / name, std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    std::filesystem::path here(const std::string& name) const { return folder_ / name; }

    const TemporaryFolder folder_;

 private:
    void paint(const std::string& name, int size, int channels, const Paint& paint) const {
        write_picture(folder_ / name, painted(size, size, channels, paint));
    }
};
