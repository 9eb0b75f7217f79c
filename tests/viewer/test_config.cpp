// Config files: what is written is read again, and what makes no sense is told with its place.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "common/io.h"
#include "cw2/options/config.h"
#include "cw2/options/option_table.h"
#include "cw2/options/options.h"
#include "tests/support/temporary_folder.h"

namespace {

using namespace cw2;
using Words = std::vector<std::string>;

std::optional<Options> parse(const Words& arguments) {
    std::vector<const char*> words{"cw2"};
    for (const std::string& argument : arguments) words.push_back(argument.c_str());
    return parse_options(static_cast<int>(words.size()), words.data());
}

std::string text_of(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(file), {}};
}

class RandomOptions {
 public:
    explicit RandomOptions(unsigned seed) : random_(seed) {}

    Options make() {
        Options options;
        options.scene = text();
        options.output = text() + "x.png";
        maybe([&] {
            options.scene = text() + "x.obj";
            options.z_up = below(2) == 0;
            options.strict = below(2) == 0;
            options.restricted = below(2) == 0;
        });
        options.size = {1 + below(20000), 1 + below(20000)};
        options.view = below(interop::kViewCount);
        maybe([&] { options.split = {side(), side()}; });
        options.divider = std::uniform_real_distribution(0.0f, 1.0f)(random_);
        maybe([&] { options.exposure = std::uniform_real_distribution(-64.0f, 64.0f)(random_); });
        maybe([&] {
            options.false_color.emplace();
            maybe([&] { options.false_color->range = range(); });
        });
        maybe([&] { options.samples = 1u << 2 * below(5); });
        maybe([&] { options.camera_position = place(); });
        maybe([&] { options.camera_target = place(); });
        options.vertical_fov = std::uniform_real_distribution(1.0f, 179.0f)(random_);
        maybe([&] { options.light_position = place(); });
        options.light_color = vector();
        options.ambient = vector();
        options.background = vector();
        maybe([&] { options.background.reset(); });
        options.time = number<double, std::uint64_t>();
        maybe([&] { options.roughness = std::uniform_real_distribution(0.0f, 1.0f)(random_); });
        maybe([&] { options.metalness = std::uniform_real_distribution(0.0f, 1.0f)(random_); });
        options.normal_strength = std::uniform_real_distribution(0.0f, 10.0f)(random_);
        options.normal_map = below(2) == 0;
        options.alpha_mask = below(2) == 0;
        options.two_sided = below(2) == 0;
        options.orbit_axis = static_cast<Axis>(below(3));
        maybe([&] { options.anisotropy = 1 + below(16); });
        maybe([&] { options.device = text(); });
        maybe([&] {
            const std::uint32_t count = 1 + below(1000);
            const std::uint32_t last = below(count);
            options.frames = {below(last + 1), last, count};
            // What makes no sense cannot be read, and so need not be written.
            options.output = "a #%04d \"b\".png";
            options.bench_pictures.reset();
            maybe([&] { options.orbit = below(2) == 0 ? Orbit::camera : Orbit::light; });
        });
        if (!options.false_color && below(2) == 0) options.encoding = Encoding::linear;
        if (!options.frames && below(2) == 0) {
            options.pixel = {below(options.size.width), below(options.size.height)};
        }
        options.list_devices = below(2) == 0;
        options.list_views = below(2) == 0;
        options.validation = below(2) == 0;
        maybe([&] { options.stats = text() + ".json"; });
        if (!options.frames && below(2) == 0) options.bench_pictures = 1 + below(1000);
        return options;
    }

 private:
    std::uint32_t below(std::uint32_t end) {
        return std::uniform_int_distribution<std::uint32_t>(0, end - 1)(random_);
    }
    template <typename Change>
    void maybe(Change change) {
        if (below(2) == 0) change();
    }
    /// Any normal number, and 0, with either sign.
    template <typename Float, typename Bits>
    Float number() {
        if (below(10) == 0) return std::copysign(Float{0}, below(2) == 0 ? Float{1} : Float{-1});
        for (;;) {
            const auto value = std::bit_cast<Float>(std::uniform_int_distribution<Bits>()(random_));
            if (std::isnormal(value)) return value;
        }
    }
    glm::vec3 vector() {
        return {number<float, std::uint32_t>(), number<float, std::uint32_t>(),
                number<float, std::uint32_t>()};
    }
    glm::dvec3 place() {
        return {number<double, std::uint64_t>(), number<double, std::uint64_t>(),
                number<double, std::uint64_t>()};
    }
    Side side() { return {below(interop::kViewCount), below(2) == 0, below(2) == 0}; }
    ValueRange range() {
        for (;;) {
            const ValueRange range{number<float, std::uint32_t>(), number<float, std::uint32_t>()};
            const float spread = range.low > 0.0f ? range.high / range.low : range.high - range.low;
            if (range.low < range.high && std::isfinite(spread)) return range;
        }
    }
    std::string text() {
        static const Words kParts{"a", "Z",    "0",    " ",   "#",      "\"",     "'",         "\\",
                                  "=", ",",    "[",    "]",   "\n",     "\r",     "\t",        "%",
                                  "/", "\x7f", "\x01", "\\u", "\u00fc", "\u2603", "\U0001F600"};
        std::string text(1, 'x');
        for (std::uint32_t i = below(12); i > 0; --i) {
            text += kParts[below(static_cast<std::uint32_t>(kParts.size()))];
        }
        return text;
    }

    std::mt19937 random_;
};

TEST(Config, WhatIsWrittenIsReadAgainExactly) {
    const TemporaryFolder folder;
    RandomOptions random(1);
    for (int i = 0; i < 500; ++i) {
        const Options options = random.make();
        write_config(folder / "a.toml", options);
        const auto read = parse({"--config", folder / "a.toml"});
        ASSERT_TRUE(read.has_value());
        ASSERT_TRUE(*read == options) << text_of(folder / "a.toml");
        // The sign of a zero is not in ==, but in the text.
        write_config(folder / "b.toml", *read);
        ASSERT_EQ(text_of(folder / "b.toml"), text_of(folder / "a.toml"));
    }
}

TEST(Config, OptionsThatNobodyGaveRemainSo) {
    const TemporaryFolder folder;
    Options options;
    options.scene = "scene.cw2mesh";
    write_config(folder / "a.toml", options);
    EXPECT_TRUE(*parse({"--config", folder / "a.toml"}) == options);
    EXPECT_TRUE(*parse({"scene.cw2mesh"}) == options);
}

TEST(Config, APathThatIsNoUtf8LeavesTheRestReadable) {
    const TemporaryFolder folder;
    Options options;
    options.scene = "gr\xFCn.cw2mesh";
    options.exposure = 1.5f;
    write_config(folder / "a.toml", options);
    const auto read = parse({"--config", folder / "a.toml"});
    EXPECT_EQ(read->scene, "gr\uFFFDn.cw2mesh");
    EXPECT_EQ(read->exposure, 1.5f);
}

TEST(Config, TheCommandLineWins) {
    const TemporaryFolder folder;
    std::ofstream(folder / "a.toml")
        << "scene = 'a.cw2mesh'\nfov = 50\nview = 'normal'\nno-alpha-mask = true\n";
    const auto options =
        parse({"b.cw2mesh", "--config", folder / "a.toml", "--fov", "70", "--no-normal-map"});
    EXPECT_EQ(options->scene, "b.cw2mesh");
    EXPECT_EQ(options->vertical_fov, 70.0f);
    EXPECT_EQ(options->view, interop::kViewNormal);
    EXPECT_FALSE(options->normal_map);
    EXPECT_FALSE(options->alpha_mask);
}

TEST(Config, TheCommandLineUndoesWhateverAFileSays) {
    const TemporaryFolder folder;
    Options none;
    none.scene = "scene.cw2mesh";
    RandomOptions random(2);
    for (int i = 0; i < 20; ++i) {
        write_config(folder / "a.toml", random.make());
        Words words{"scene.cw2mesh", "--config", folder / "a.toml"};
        for (const Setting& setting : all_settings()) {
            if (setting.name == "scene") continue;
            words.push_back("--" + setting.name + (setting.form.empty() ? "=false" : ""));
            if (!setting.form.empty()) words.push_back("default");
        }
        const auto options = parse(words);
        ASSERT_TRUE(options.has_value());
        EXPECT_TRUE(*options == none);
    }
}

TEST(Config, AViewOfTheCommandLineWinsOverASplit) {
    const TemporaryFolder folder;
    std::ofstream(folder / "a.toml") << "scene = 'a.cw2mesh'\nview = 'uv'\n"
                                        "split = ['normal', 'shaded']\n";
    const auto options = parse({"--config", folder / "a.toml", "--view", "specular"});
    EXPECT_EQ(options->view, interop::kViewSpecular);
    EXPECT_EQ(options->split, std::nullopt);
    EXPECT_TRUE(parse({"--config", folder / "a.toml"})->split.has_value());
}

TEST(Config, ReadsWhatPeopleWriteInToml) {
    const TemporaryFolder folder;
    std::ofstream(folder / "a.toml", std::ios::binary)
        << "# a comment\r\n\r\n  scene='C:\\new #1.cw2mesh' # with a hash\r\n"
           "camera-position = [ 1.5, # x\n  -2e-1,\n\t3, ]\n"
           "light-position = \"4,5,6\"\n"
           "device=\"\\u00fc \\\"q\\\" \\U0001F600\"\n"
           "fov = 7_0\nno-normal-map = false\nno-alpha-mask   =   true";
    const auto options = parse({"--config", folder / "a.toml"});
    EXPECT_EQ(options->scene, "C:\\new #1.cw2mesh");
    EXPECT_EQ(options->camera_position, glm::dvec3(1.5, -0.2, 3.0));
    EXPECT_EQ(options->light_position, glm::dvec3(4.0, 5.0, 6.0));
    EXPECT_EQ(options->device, "\u00fc \"q\" \U0001F600");
    EXPECT_EQ(options->vertical_fov, 70.0f);
    EXPECT_TRUE(options->normal_map);
    EXPECT_FALSE(options->alpha_mask);
}

TEST(Config, WhatMakesNoSenseIsToldWithItsPlace) {
    const struct {
        std::string text;
        Words parts;
    } table[] = {
        {"fovv = 60\n", {":1: ", "'fovv'"}},
        {"\n\nconfig = 'b.toml'\n", {":3: ", "'config'"}},
        {"fov = 60\nfov = 60\n", {":2: ", "'fov'"}},
        {"fov = 0\n", {":1: fov: ", "'0'"}},
        {"fov = wide\n", {":1: ", "value"}},
        {"fov = nan\n", {":1: fov: "}},
        {"fov = 'nan'\n", {":1: fov: ", "'nan'"}},
        {"fov =\n", {":1: ", "value"}},
        {"fov\n", {":1: ", "'='"}},
        {"fov = 60 70\n", {":1: "}},
        {"= 60\n", {":1: ", "key"}},
        {"view = 'sideways'\n", {":1: view: ", "'sideways'", "--list-views"}},
        {"no-normal-map = 1\n", {":1: no-normal-map: ", "'1'"}},
        {"ambient = [1, 2]\n", {":1: ambient: ", "'1,2'"}},
        {"ambient = [1, 2, 3\nfov = 60\n", {":2: ", "array"}},
        {"ambient = [1e39, 0, 0]\n", {":1: ambient: "}},
        {"size = '640'\n", {":1: size: ", "'640'"}},
        {"device = \"abc\nfov = 60\n", {":1: ", "string"}},
        {"device = 'abc\n", {":1: ", "string"}},
        {"device = \"\\q\"\n", {":1: ", "\\q"}},
        {"device = \"\\uD800\"\n", {":1: ", "U+D800"}},
        {"[camera]\nfov = 60\n", {":1: camera: "}},
        // Wider than a float can say.
        {"false-color = [-3e38, 3e38]\n", {":1: false-color: "}},
        {"false-color = [1e-30, 1e30]\n", {":1: false-color: "}},
    };
    const TemporaryFolder folder;
    const std::string path = folder / "a.toml";
    for (const auto& [text, parts] : table) {
        SCOPED_TRACE(text);
        std::ofstream(path) << text;
        try {
            // A value that the command line overrides must make sense, too.
            parse({"a.cw2mesh", "--config", path, "--fov", "50"});
            ADD_FAILURE() << "accepted";
        } catch (const UsageError& error) {
            const std::string line = error.what();
            EXPECT_TRUE(line.starts_with(path + ":")) << line;
            EXPECT_EQ(line.find('\n'), std::string::npos) << line;
            for (const std::string& part : parts) {
                EXPECT_NE(line.find(part), std::string::npos) << line << " does not hold " << part;
            }
        }
    }
}

TEST(Config, FilesThatCannotBeReadOrWrittenAreNoUsageErrors) {
    const TemporaryFolder folder;
    EXPECT_THROW(parse({"a.cw2mesh", "--config", folder / "gone.toml"}), common::FileError);
    EXPECT_THROW(parse({"a.cw2mesh", "--config", folder.path()}), common::FileError);
    EXPECT_THROW(write_config(folder / "no/a.toml", {}), common::FileError);
}

TEST(Config, SeveralScenesAreForTheWindow) {
    const auto options = parse({"a.cw2mesh", "b.cw2mesh", "--size", "3x2", "c.cw2mesh"});
    EXPECT_EQ(options->scene, "a.cw2mesh");
    EXPECT_EQ(options->files,
              (std::vector<std::filesystem::path>{"a.cw2mesh", "b.cw2mesh", "c.cw2mesh"}));
    EXPECT_THROW(parse({"a.cw2mesh", "b.cw2mesh", "--output", "c.png"}), UsageError);
    EXPECT_THROW(parse({"a.cw2mesh", "b.cw2mesh", "--pixel", "0,0"}), UsageError);
}

TEST(Config, BothEndsOfARangeAreTakenAndNothingBeyond) {
    const auto takes = [](const std::string& option, const std::string& value) {
        try {
            return parse({"a.cw2mesh", "--" + option, value}).has_value();
        } catch (const UsageError&) {
            return false;
        }
    };
    const auto check = [&](const std::string& option, auto range, double step) {
        EXPECT_TRUE(takes(option, std::to_string(range.low))) << option;
        EXPECT_TRUE(takes(option, std::to_string(range.high))) << option;
        EXPECT_FALSE(takes(option, std::to_string(range.low - step))) << option;
        EXPECT_FALSE(takes(option, std::to_string(range.high + step))) << option;
    };
    check("divider", kDividerRange, 0.01);
    check("exposure", kExposureRange, 0.01);
    check("fov", kFovRange, 0.01);
    check("roughness", kOverrideRange, 0.01);
    check("metalness", kOverrideRange, 0.01);
    check("normal-strength", kNormalStrengthRange, 0.01);
    EXPECT_TRUE(takes("orbit-axis", "y"));
    EXPECT_FALSE(takes("orbit-axis", "w"));
    EXPECT_FALSE(takes("orbit-axis", ""));
}

}  // namespace
