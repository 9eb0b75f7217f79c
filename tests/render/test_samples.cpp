// Pictures as the mean of frames: which frames, what mean, and what transparency and encoding make
// of it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <random>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "cw2/render/averager.h"
#include "cw2/render/scene_file.h"
#include "cw2/render/touched_levels.h"
#include "tests/render/drawing.h"
#include "tests/render/loaded_scene.h"
#include "tests/support/process.h"
#include "tests/support/srgb_truth.h"
#include "tests/support/temporary_folder.h"

namespace {

using Words = std::vector<std::string>;

constexpr std::uint32_t kWidth = 160, kHeight = 90;
class Samples : public testing::Test {
 protected:
    static void SetUpTestSuite() {
        folder_ = std::make_unique<TemporaryFolder>();
        make_test_scenes(folder_->path());
        scene_ = bake_scene(*folder_ / "stage.obj");
    }
    static void TearDownTestSuite() { folder_.reset(); }

    static Words with_size(const Words& words) {
        Words options = words;
        options.insert(options.end(), {"--size", fmt::format("{}x{}", kWidth, kHeight)});
        return options;
    }
    static Picture draw(const std::string& extension, const Words& words) {
        return draw_scene(scene_, extension, with_size(words));
    }
    static std::string bytes(const std::string& extension) {
        std::filesystem::path path = scene_;
        std::ifstream file(path.replace_extension(extension), std::ios::binary);
        return {std::istreambuf_iterator<char>(file), {}};
    }
    static const std::filesystem::path& scene() { return scene_; }

 private:
    static std::unique_ptr<TemporaryFolder> folder_;
    static std::filesystem::path scene_;
};

std::unique_ptr<TemporaryFolder> Samples::folder_;
std::filesystem::path Samples::scene_;

TEST(PixelSamples, LieInTheirPixelNoTwoInOneRowOrColumn) {
    EXPECT_EQ(cw2::pixel_sample(0, 1).offset, glm::vec2(0.0f));
    EXPECT_EQ(cw2::pixel_sample(0, 1).lod_bias, 0.0f);
    for (const std::uint32_t count : {1u, 4u, 16u, 64u, 256u}) {
        std::set<float> columns, rows;
        glm::vec2 sum(0.0f);
        for (std::uint32_t i = 0; i < count; ++i) {
            const glm::vec2 offset = cw2::pixel_sample(i, count).offset;
            EXPECT_LT(std::max(std::abs(offset.x), std::abs(offset.y)), 0.5f);
            columns.insert(std::floor((offset.x + 0.5f) * static_cast<float>(count)));
            rows.insert(std::floor((offset.y + 0.5f) * static_cast<float>(count)));
            sum += offset;
        }
        EXPECT_EQ(columns.size(), count);
        EXPECT_EQ(rows.size(), count);
        EXPECT_NEAR(sum.x, 0.0f, 1e-4f);
        EXPECT_NEAR(sum.y, 0.0f, 1e-4f);
    }
}

/// Draws single frames and means of the scene on a device of its own.
class Frames : public LoadedScene {
 public:
    Frames(const std::filesystem::path& path, const Words& words,
           const std::vector<std::uint32_t>& first_levels = {})
        : LoadedScene(path, words, kExtent, first_levels) {}

    /// One sample a pixel, without any averaging.
    std::vector<float> frame(const cw2::PixelSample& sample) {
        cw2::begin_commands(commands_);
        constexpr cw2::ImageUse kCopied{VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL,
                                        VK_PIPELINE_STAGE_2_COPY_BIT,
                                        VK_ACCESS_2_TRANSFER_READ_BIT};
        renderer_.record(commands_, 0, scene(),
                         {.image = image_.handle.get(),
                          .view = image_.view.get(),
                          .extent = kExtent,
                          .available_at = kCopied.stages,
                          .after = kCopied,
                          .sample = sample},
                         settings());
        return read(image_.handle.get());
    }
    std::vector<float> mean(std::uint32_t count, bool clamps) {
        for (std::uint32_t i = 0; i + 1 < count; ++i) {
            cw2::begin_commands(commands_);
            averager_.add(commands_, 0, scene(), settings(), kExtent, i, count, clamps);
            cw2::submit_and_wait(device(), commands_);
        }
        cw2::begin_commands(commands_);
        averager_.add(commands_, 0, scene(), settings(), kExtent, count - 1, count, clamps);
        return read(averager_.mean(commands_));
    }

 private:
    static constexpr VkExtent2D kExtent{kWidth, kHeight};
    static constexpr VkFormat kFormat = VK_FORMAT_R32G32B32A32_SFLOAT;

    std::vector<float> read(VkImage image) {
        cw2::read_back(commands_, image, kExtent, pixels_);
        cw2::submit_and_wait(device(), commands_);
        std::vector<float> values(pixels_.mapped.size() / sizeof(float));
        std::memcpy(values.data(), pixels_.mapped.data(), pixels_.mapped.size());
        return values;
    }

    cw2::Renderer renderer_{
        device(), layouts(), cw2::built_in_shaders(), kFormat, VK_SAMPLE_COUNT_1_BIT, 1};
    cw2::Averager averager_{device(), layouts(), cw2::built_in_shaders(), 1};
    cw2::Image image_{cw2::make_image(device(), {.format = kFormat,
                                                 .extent = kExtent,
                                                 .usage = VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT |
                                                          VK_IMAGE_USAGE_TRANSFER_SRC_BIT})};
    cw2::Buffer pixels_{cw2::make_buffer(device(), VkDeviceSize{kWidth} * kHeight * 16,
                                         VK_BUFFER_USAGE_TRANSFER_DST_BIT,
                                         cw2::MemoryUse::readback)};
    cw2::CommandPool pool_{cw2::make_command_pool(device())};
    VkCommandBuffer commands_{cw2::allocate_commands(device(), pool_.get())};
};

TEST_F(Samples, APictureIsTheMeanOfItsFrames) {
    Frames frames(scene(), {"--exposure", "2"});
    for (const std::uint32_t count : {4u, 16u}) {
        for (const bool clamps : {false, true}) {
            std::vector<double> truth(std::size_t{kWidth} * kHeight * 4, 0.0);
            double largest = 0.0;
            for (std::uint32_t i = 0; i < count; ++i) {
                const std::vector<float> frame = frames.frame(cw2::pixel_sample(i, count));
                for (std::size_t k = 0; k < truth.size(); ++k) {
                    largest = std::max(largest, double{frame[k]});
                    truth[k] += clamps ? std::clamp(frame[k], 0.0f, 1.0f) : frame[k];
                }
            }
            const std::vector<float> mean = frames.mean(count, clamps);
            ASSERT_EQ(mean.size(), truth.size());
            EXPECT_GT(largest, 2.0) << "nothing to clamp";
            for (std::size_t k = 0; k < truth.size(); ++k) {
                ASSERT_NEAR(mean[k], truth[k] / count, 1e-6 * std::max(1.0, truth[k])) << k;
            }
        }
    }
    EXPECT_TRUE(frames.mean(1, false) == frames.frame({}));
}

TEST_F(Samples, AnOffsetMovesThePicture) {
    // A frame at twice the width has a pixel's centre where this one has it a quarter aside.
    const Words camera{"--camera-position", "0.3,1.6,4.3", "--camera-target",
                       "0,0.75,0",          "--view",      "view-direction"};
    Frames frames(scene(), camera);
    Words options = camera;
    options.insert(options.end(),
                   {"--size", fmt::format("{}x{}", 2 * kWidth, 2 * kHeight), "--samples", "1"});
    const Picture larger = draw_scene(scene(), ".exr", options);
    for (const int right : {0, 1}) {
        for (const int down : {0, 1}) {
            const auto frame = frames.frame({{0.5f * right - 0.25f, 0.5f * down - 0.25f}, 0.0f});
            int compared = 0, wrong = 0;
            for (int y = 0; y < static_cast<int>(kHeight); ++y) {
                for (int x = 0; x < static_cast<int>(kWidth); ++x) {
                    const float* const b = larger.at(2 * x + right, 2 * y + down);
                    const float* const a =
                        &frame[4 * static_cast<std::size_t>(y * int{kWidth} + x)];
                    if (a[3] == 0.0f && b[3] == 0.0f) continue;
                    ++compared;
                    for (int c = 0; c < 4; ++c) {
                        if (std::abs(a[c] - b[c]) > 1e-4f) {
                            ++wrong;
                            break;
                        }
                    }
                }
            }
            EXPECT_GT(compared, 3000);
            EXPECT_LT(wrong, compared / 100);
        }
    }
}

TEST_F(Samples, TheSameBytesEveryTime) {
    for (const std::string extension : {".png", ".exr"}) {
        draw(extension, {"--samples", "16"});
        const std::string first = bytes(extension);
        draw(extension, {"--samples", "16"});
        EXPECT_TRUE(first == bytes(extension)) << extension;
    }
}

TEST_F(Samples, NoBackgroundLeavesWhatIsInFrontOfIt) {
    const Words view{"--view", "base-color"};
    const auto with = [&](const std::string& background) {
        Words words = view;
        words.insert(words.end(), {"--background", background});
        return words;
    };
    const Picture before = draw(".exr", with("0.25,0.5,2"));
    const Picture none = draw(".exr", with("none"));
    const Picture png = draw(".png", with("none"));
    ASSERT_EQ(png.channels, 4);
    constexpr double kBackground[] = {0.25, 0.5, 2.0};
    int edges = 0;
    for (int y = 0; y < none.height; ++y) {
        for (int x = 0; x < none.width; ++x) {
            const float* const value = none.at(x, y);
            const double alpha = value[3];
            edges += alpha > 0.0 && alpha < 1.0;
            ASSERT_EQ(before.at(x, y)[3], value[3]);
            ASSERT_NEAR(png.at(x, y)[3], alpha, 0.5 * kByteStep);
            for (int c = 0; c < 3; ++c) {
                ASSERT_NEAR(value[c] + (1.0 - alpha) * kBackground[c], before.at(x, y)[c], 1e-5);
                const double straight = alpha > 0.0 ? value[c] / alpha : 0.0;
                ASSERT_NEAR(png.at(x, y)[c], srgb_of_linear(std::min(straight, 1.0)), kByteStep);
            }
        }
    }
    EXPECT_GT(edges, 100);
    EXPECT_EQ(draw(".png", view).channels, 3);
}

TEST_F(Samples, WhatLiesOverThePictureIsOpaque) {
    const Picture picture = draw(".png", {"--split", "distribution,diffuse", "--false-color",
                                          "auto", "--background", "none"});
    EXPECT_EQ(picture.at(kWidth / 2, 2)[3], 1.0f);
    EXPECT_EQ(picture.at(3, kHeight - 3)[3], 1.0f);
    EXPECT_EQ(picture.at(3, 2)[3], 0.0f);
}

TEST_F(Samples, LinearPngsHoldTheValues) {
    const Words half{"--view", "roughness", "--roughness", "0.5019608", "--encoding", "linear"};
    const Picture values = draw(".png", half);
    int halves = 0;
    for (std::size_t i = 0; i < values.samples.size(); i += 3) {
        halves += std::lround(255.0f * values.samples[i]) == 128;
    }
    EXPECT_GT(halves, 1000);
    const Picture exr = draw(".exr", {"--view", "normal"});
    const Picture png = draw(".png", {"--view", "normal", "--encoding", "linear"});
    for (int y = 0; y < exr.height; ++y) {
        for (int x = 0; x < exr.width; ++x) {
            for (int c = 0; c < 3; ++c) {
                ASSERT_NEAR(png.at(x, y)[c], std::clamp(exr.at(x, y)[c], 0.0f, 1.0f), 0.51 / 255.0);
            }
        }
    }
}

/// A floor to the horizon, and triangles that stand, lie and lean, near and far, with UVs turned,
/// sheared and stretched; noise of 512 and of 1024 x 256 texels.
std::filesystem::path noisy_scene(const std::filesystem::path& folder) {
    std::mt19937 random(7);
    const auto between = [&](double low, double high) {
        return std::uniform_real_distribution(low, high)(random);
    };
    const auto noise = [&](int width, int height, const char* name) {
        write_picture(folder / name, painted(width, height, 3, [&](int, int) {
                          return std::vector{between(0, 1), between(0, 1), between(0, 1)};
                      }));
    };
    noise(512, 512, "square.png");
    noise(1024, 256, "wide.png");
    std::ofstream(folder / "noise.mtl") << "newmtl square\nmap_Kd square.png\n"
                                           "newmtl wide\nmap_Kd wide.png\nmap_Pr square.png\n";
    std::string obj =
        "mtllib noise.mtl\nusemtl square\nv -90 0 -90\nv 90 0 -90\nv 90 0 90\nv -90 0 90\n"
        "vt 0 0\nvt 40 0\nvt 40 40\nvt 0 40\nf 1/1 2/2 3/3 4/4\n";
    for (int i = 0; i < 60; ++i) {
        const double x = between(-9, 9), z = between(-9, 9), scale = std::exp(between(-2, 2));
        obj += i % 2 ? "usemtl square\n" : "usemtl wide\n";
        for (int k = 0; k < 3; ++k) {
            obj += fmt::format("v {:.4f} {:.4f} {:.4f}\nvt {:.4f} {:.4f}\n", x + between(-1, 1),
                               between(0, 3), z + between(-1, 1), scale * between(-1, 1),
                               scale * between(-1, 1));
        }
        obj += "f -3/-3 -2/-2 -1/-1\n";
    }
    std::ofstream(folder / "noise.obj") << obj;
    return bake_scene(folder / "noise.obj", {"--textures", "lossless"});
}

float farthest(const std::vector<float>& a, const std::vector<float>& b) {
    return std::transform_reduce(
        a.begin(), a.end(), b.begin(), 0.0f, [](float x, float y) { return std::max(x, y); },
        [](float x, float y) { return std::abs(x - y); });
}

TEST(TouchedLevels, GiveTheSamePictureAsAll) {
    const TemporaryFolder folder;
    const std::filesystem::path scene = noisy_scene(folder.path());
    std::size_t left_out = 0, changed_without_more = 0;
    for (const char* camera : {"0,0.3,0", "6,1.6,0.2", "-9,4,-7", "0,30,1", "40,0.02,3", "2,1,2"}) {
        for (const std::uint32_t count : {1u, 16u}) {
            const Words words{"--camera-position", camera,      "--camera-target",
                              "1,0.4,-0.5",        "--samples", std::to_string(count),
                              "--ambient",         "1,1,1"};
            const cw2::SceneFile file = cw2::load_scene_file(scene);
            Frames all(scene, words);
            const std::vector<float> truth = all.mean(count, false);
            std::vector<std::uint32_t> first = cw2::first_touched_levels(
                file.document, file.bounds, all.settings().camera,
                {{kWidth, kHeight}, cw2::pixel_sample(0, count).lod_bias, 1.0f});
            // The level between two levels is rounded when it is computed.
            EXPECT_LE(farthest(Frames(scene, words, first).mean(count, false), truth), 1e-6f)
                << camera << ", " << count << " samples";
            for (std::uint32_t& level : first) {
                left_out += level;
                level = std::min(level + 3, 7u);
            }
            changed_without_more +=
                farthest(Frames(scene, words, first).mean(count, false), truth) > 0.01f;
        }
    }
    // The bound is of use: it leaves levels out, and three more are missed from nearly everywhere.
    EXPECT_GE(left_out, 12u);
    EXPECT_GE(changed_without_more, 9u);
}

TEST(SceneFile, IsWholeWhateverIsForgotten) {
    const TemporaryFolder folder;
    // Of some pages.
    constexpr int kSide = 64;
    std::ofstream obj(folder / "sheet.obj");
    for (int i = 0; i < kSide * kSide; ++i) obj << fmt::format("v {} 0 {}\n", i % kSide, i / kSide);
    for (int i = 1; i < kSide * (kSide - 1); ++i) {
        if (i % kSide != 0)
            obj << fmt::format("f {} {} {} {}\n", i, i + 1, i + kSide + 1, i + kSide);
    }
    obj.close();
    // Compressed vertices are decoded: no file has them.
    for (const std::vector<std::string>& words : {Words{}, Words{"--compress"}}) {
        const cw2::SceneFile file = cw2::load_scene_file(bake_scene(folder / "sheet.obj", words));
        for (const auto part : {file.document.vertices, std::as_bytes(file.document.indices)}) {
            ASSERT_GT(part.size(), 20'000u);
            const std::vector<std::byte> before(part.begin(), part.end());
            file.forget(part);
            EXPECT_TRUE(std::ranges::equal(part, before)) << words.size();
        }
    }
}

TEST(Bench, SaysWhatAPictureTakes) {
    const TemporaryFolder folder;
    // Two walls that fill the view, one behind the other.
    std::ofstream(folder / "walls.mtl") << "newmtl near\nnewmtl far\n";
    std::ofstream(folder / "walls.obj")
        << "mtllib walls.mtl\nusemtl near\nv -9 -9 0\nv 9 -9 0\nv 9 9 0\nv -9 9 0\nf 1 2 3 4\n"
           "v -9 -9 -1\nv 9 -9 -1\nv 9 9 -1\nv -9 9 -1\nusemtl far\nf 5 6 7 8\n";
    const std::filesystem::path scene = bake_scene(folder / "walls.obj");
    for (const std::string orbit : {"", "camera"}) {
        std::vector<std::string> command{CW2_PROGRAM,
                                         scene,
                                         "--camera-position",
                                         "0,0,5",
                                         "--camera-target",
                                         "0,0,0",
                                         "--size",
                                         "64x48",
                                         "--bench",
                                         "5",
                                         "--stats",
                                         folder / "stats.json",
                                         "--validation"};
        if (!orbit.empty()) command.insert(command.end(), {"--orbit", orbit});
        const Outcome outcome = run(command);
        ASSERT_EQ(outcome.status, 0) << outcome.err;
        EXPECT_EQ(outcome.err, "");
        EXPECT_NE(outcome.out.find("5 pictures of 64x48, 4 frames each"), std::string::npos);
        const auto stats = nlohmann::json::parse(std::ifstream(folder / "stats.json"));
        const auto number = [&](const std::string& name) { return stats.at(name).get<double>(); };
        EXPECT_EQ(number("bench_pictures"), 5.0);
        EXPECT_GT(number("load_ms"), 0.0);
        // Of an --output, which there is none of.
        EXPECT_FALSE(stats.contains("first_frame_ms") || stats.contains("save_ms"));
        // On lavapipe what the near wall hides is not drawn; at the last picture of a turn both
        // walls are seen, from aside.
        EXPECT_EQ(number("frame_triangles"), orbit.empty() ? 2.0 : 4.0);
        EXPECT_EQ(number("pipelines"), 1.0);
        for (const char* what : {"wall", "cpu"}) {
            const double median = number(what + std::string("_median_ms"));
            EXPECT_GT(median, 0.0);
            EXPECT_GE(number(what + std::string("_95_ms")), median);
        }
        EXPECT_GT(number("peak_memory_mib"), 1.0);
        // A wall is drawn all over the picture, and quads at its diagonal twice.
        EXPECT_GE(number("fragments_per_pixel"), orbit.empty() ? 1.0 : 0.1);
        EXPECT_LE(number("fragments_per_pixel"), orbit.empty() ? 1.5 : 1.9);
    }
}

}  // namespace
