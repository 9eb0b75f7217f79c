// Shaders compiled while the program runs are those of the build, and errors have a place.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <string>

#include "common/io.h"
#include "cw2/render/pipelines.h"
#include "cw2/render/shader_compiler.h"
#include "tests/support/temporary_folder.h"

namespace {

namespace fs = std::filesystem;

class ShaderCompiler : public testing::Test {
 protected:
    ShaderCompiler() {
        for (const char* folder : {"shaders", "mesh-format", "common"}) {
            fs::copy(fs::path(CW2_SOURCE_DIR) / folder, root_ / folder);
        }
    }

    fs::path file(const std::string& name) const { return root_ / ("shaders/" + name); }

    void write(const std::string& name, const std::string& text) const {
        std::ofstream(file(name)) << text;
    }

    /// What the compiler says about the shaders as they are now.
    std::string error() const {
        try {
            cw2::compile_shaders(root_.path());
        } catch (const cw2::ShaderError& error) {
            return error.what();
        }
        return "no error";
    }

    TemporaryFolder root_;
};

TEST_F(ShaderCompiler, GivesTheSameWordsAsTheBuild) {
    const cw2::CompiledShaders shaders = cw2::compile_shaders(root_.path());
    const cw2::ShaderCode built = cw2::built_in_shaders();
    for (std::size_t i = 0; i < built.size(); ++i) {
        for (const bool colors : {false, true}) {
            EXPECT_TRUE(std::ranges::equal(shaders.words[i][colors], built[i][colors]))
                << cw2::kShaderFiles[i] << ' ' << colors;
        }
    }
}

TEST_F(ShaderCompiler, AnErrorNamesItsFileAndLine) {
    write("opaque.frag", "#version 460\nvoid main() {\n    nonsense = 1;\n}\n");
    EXPECT_EQ(error(), file("opaque.frag").string() + ":3: 'nonsense' : undeclared identifier");
}

TEST_F(ShaderCompiler, AnErrorInAnIncludedFileNamesThatFile) {
    write("brdf.glsl", "\n\nfloat wrong() { return nonsense; }\n");
    EXPECT_EQ(error(), file("brdf.glsl").string() + ":3: 'nonsense' : undeclared identifier");
}

TEST_F(ShaderCompiler, AMissingIncludeIsReportedWhereItIsIncluded) {
    fs::remove(file("interop.h"));
    const std::string text = error();
    EXPECT_TRUE(text.starts_with(file("mesh.vert").string() + ":7: ")) << text;
    EXPECT_NE(text.find("shaders/interop.h"), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
}

TEST_F(ShaderCompiler, AMissingEntryPointNamesTheFile) {
    write("alpha_mask.frag", "#version 460\n");
    const std::string text = error();
    EXPECT_TRUE(text.starts_with(file("alpha_mask.frag").string() + ": ")) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
}

TEST_F(ShaderCompiler, AMissingShaderIsAFileError) {
    fs::remove(file("opaque.frag"));
    try {
        cw2::compile_shaders(root_.path());
        FAIL() << "compiled";
    } catch (const common::FileError& error) {
        EXPECT_TRUE(std::string(error.what()).starts_with(file("opaque.frag").string()))
            << error.what();
    }
}

TEST_F(ShaderCompiler, CompilesAgainAfterAnError) {
    write("opaque.frag", "nonsense");
    EXPECT_NE(error(), "no error");
    fs::copy_file(fs::path(CW2_SOURCE_DIR) / "shaders/opaque.frag", file("opaque.frag"),
                  fs::copy_options::overwrite_existing);
    EXPECT_EQ(error(), "no error");
}

}  // namespace
