#include "cw2/render/shader_compiler.h"

#include <fmt/format.h>
#include <glslang/Public/ResourceLimits.h>
#include <glslang/Public/ShaderLang.h>
#include <glslang/SPIRV/GlslangToSpv.h>

#include <forward_list>
#include <string>
#include <string_view>

#include "common/io.h"

namespace cw2 {

namespace {

struct GlslangProcess {
    GlslangProcess() { glslang::InitializeProcess(); }
    ~GlslangProcess() { glslang::FinalizeProcess(); }
    GlslangProcess(const GlslangProcess&) = delete;
    GlslangProcess& operator=(const GlslangProcess&) = delete;
};

std::string read_text(const std::filesystem::path& path) {
    const std::vector<std::byte> bytes = common::read_file(path);
    return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// Finds what is included under the root.
class Includes : public glslang::TShader::Includer {
 public:
    explicit Includes(std::filesystem::path root) : root_(std::move(root)) {}

    IncludeResult* includeLocal(const char* name, const char*, std::size_t) override {
        const std::filesystem::path path = root_ / name;
        try {
            const std::string& text = texts_.emplace_front(read_text(path));
            return new IncludeResult(path.string(), text.data(), text.size(), nullptr);
        } catch (const common::FileError&) {
            return nullptr;  // glslang says which line asks for the file
        }
    }
    void releaseInclude(IncludeResult* result) override { delete result; }

 private:
    std::filesystem::path root_;
    std::forward_list<std::string> texts_;
};

/// The first error of glslang's log, whose lines are "ERROR: PATH:LINE: what is wrong".
std::string first_error(std::string_view log, const std::filesystem::path& path) {
    constexpr std::string_view kPrefix = "ERROR: ";
    const std::size_t start = log.find(kPrefix);
    if (start == std::string_view::npos) return path.string() + ": cannot be compiled";
    log.remove_prefix(start + kPrefix.size());
    log = log.substr(0, log.find('\n'));
    while (log.ends_with(' ')) log.remove_suffix(1);
    // What is wrong with a whole stage comes without a place.
    return log.starts_with('/') ? std::string(log) : fmt::format("{}: {}", path.string(), log);
}

std::vector<std::uint32_t> compile(const std::filesystem::path& root, const std::string& file,
                                   bool vertex_colors) {
    const EShLanguage stage = file.ends_with(".vert") ? EShLangVertex : EShLangFragment;
    const std::filesystem::path path = root / "shaders" / file;
    const std::string text = read_text(path);
    const std::string name = path.string();
    const char* const text_data = text.data();
    const char* const name_data = name.c_str();
    const int length = static_cast<int>(text.size());
    constexpr auto kRules = static_cast<EShMessages>(EShMsgSpvRules | EShMsgVulkanRules);

    glslang::TShader shader(stage);
    shader.setStringsWithLengthsAndNames(&text_data, &length, &name_data, 1);
    if (vertex_colors) shader.setPreamble("#define VERTEX_COLORS\n");
    shader.setEnvInput(glslang::EShSourceGlsl, stage, glslang::EShClientVulkan, 100);
    shader.setEnvClient(glslang::EShClientVulkan, glslang::EShTargetVulkan_1_3);
    shader.setEnvTarget(glslang::EShTargetSpv, glslang::EShTargetSpv_1_6);
    Includes includes(root);
    if (!shader.parse(GetDefaultResources(), 460, false, kRules, includes)) {
        throw ShaderError(first_error(shader.getInfoLog(), path));
    }
    glslang::TProgram program;
    program.addShader(&shader);
    if (!program.link(kRules)) throw ShaderError(first_error(program.getInfoLog(), path));
    std::vector<std::uint32_t> code;
    glslang::GlslangToSpv(*program.getIntermediate(stage), code);
    return code;
}

}  // namespace

CompiledShaders compile_shaders(const std::filesystem::path& root) {
    const GlslangProcess process;
    CompiledShaders shaders;
    for (std::size_t i = 0; i < kShaderFiles.size(); ++i) {
        for (const bool vertex_colors : {false, true}) {
            shaders.words[i][vertex_colors] = compile(root, kShaderFiles[i], vertex_colors);
        }
    }
    return shaders;
}

}  // namespace cw2
