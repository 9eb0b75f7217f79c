// What the device's objects take, and what validation says of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "cw2/vulkan/device.h"
#include "cw2/vulkan/resources.h"

namespace {

struct ValidatedDevice : testing::Test {
    std::vector<cw2::ImageHandle> images(const std::vector<VkExtent2D>& extents) {
        std::vector<cw2::ImageHandle> images;
        for (const VkExtent2D& extent : extents) {
            images.push_back(cw2::make_image_handle(
                device, {.format = VK_FORMAT_R8G8B8A8_UNORM,
                         .extent = extent,
                         .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_DST_BIT}));
        }
        return images;
    }

    cw2::Instance instance{true, {}};
    cw2::Device device{instance, std::nullopt};
};

std::vector<VkDeviceSize> sizes_of(const cw2::ImageMemory& memory) {
    std::vector<VkDeviceSize> sizes;
    for (const cw2::Memory& block : memory.blocks) sizes.push_back(block.bytes());
    return sizes;
}

std::vector<VkImage> handles_of(const std::vector<cw2::ImageHandle>& images) {
    std::vector<VkImage> handles;
    for (const cw2::ImageHandle& image : images) handles.push_back(image.get());
    return handles;
}

TEST_F(ValidatedDevice, OneTexelTakesLittleMemory) {
    const auto texel = images({{1, 1}});
    const auto sizes = sizes_of(cw2::bind_images(device, handles_of(texel), false));
    ASSERT_EQ(sizes.size(), 1u);
    EXPECT_LE(sizes[0], 64u << 10);
    EXPECT_EQ(instance.validation_messages(), 0);
}

TEST_F(ValidatedDevice, ImagesShareAllocationsOfTheSizeThatTheyNeed) {
    // 16, 4, 40, 36 and 100 MiB.
    const auto some =
        images({{2048, 2048}, {1024, 1024}, {4096, 2560}, {3072, 3072}, {5120, 5120}});
    const auto sizes = sizes_of(cw2::bind_images(device, handles_of(some), false));
    ASSERT_EQ(sizes.size(), 3u);
    EXPECT_NEAR(static_cast<double>(sizes[0]), 60.0 * (1 << 20), 1 << 20);
    EXPECT_NEAR(static_cast<double>(sizes[1]), 36.0 * (1 << 20), 1 << 20);
    EXPECT_NEAR(static_cast<double>(sizes[2]), 100.0 * (1 << 20), 1 << 20);
    // The layers would tell of images that overlap or reach over the end.
    EXPECT_EQ(instance.validation_messages(), 0);
}

TEST_F(ValidatedDevice, UploadsLevelsThatDoNotFitTheStagingBuffer) {
    // 36 MB and 9 MB, then one whose rows are no multiple of four.
    for (const VkExtent2D extent : {VkExtent2D{3001, 3002}, VkExtent2D{5, 3}}) {
        const cw2::ImageSettings settings{.format = VK_FORMAT_R8G8B8A8_UNORM,
                                          .extent = extent,
                                          .mip_count = 2,
                                          .usage = VK_IMAGE_USAGE_TRANSFER_DST_BIT |
                                                   VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                                                   VK_IMAGE_USAGE_SAMPLED_BIT};
        const cw2::Image image = cw2::make_image(device, settings);
        const auto texel = [](std::uint32_t level, std::uint32_t y, std::uint32_t x) {
            return (level << 28) ^ (y * 40'503u + x * 2'654'435'761u);
        };
        cw2::Uploader uploader(device);
        uploader.write_image(
            image.handle.get(), settings, {1, 4},
            [&](std::uint32_t level, std::uint32_t first, std::uint32_t count, std::byte* out) {
                EXPECT_EQ(first % 4, 0u);
                for (std::uint32_t y = first; y < first + count; ++y) {
                    for (std::uint32_t x = 0; x < std::max(extent.width >> level, 1u); ++x) {
                        const std::uint32_t value = texel(level, y, x);
                        std::memcpy(out, &value, sizeof value);
                        out += sizeof value;
                    }
                }
            });
        uploader.finish();

        const cw2::Buffer back =
            cw2::make_buffer(device, VkDeviceSize{4} * extent.width * extent.height,
                             VK_BUFFER_USAGE_TRANSFER_DST_BIT, cw2::MemoryUse::readback);
        const cw2::CommandPool pool = cw2::make_command_pool(device);
        const VkCommandBuffer commands = cw2::allocate_commands(device, pool.get());
        cw2::begin_commands(commands);
        cw2::image_barrier(commands, image.handle.get(), VK_IMAGE_ASPECT_COLOR_BIT,
                           {VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL,
                            VK_PIPELINE_STAGE_2_FRAGMENT_SHADER_BIT, VK_ACCESS_2_NONE},
                           {VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, VK_PIPELINE_STAGE_2_COPY_BIT,
                            VK_ACCESS_2_TRANSFER_READ_BIT});
        cw2::read_back(commands, image.handle.get(), extent, back);
        cw2::submit_and_wait(device, commands);
        std::size_t wrong = 0;
        for (std::uint32_t y = 0; y < extent.height; ++y) {
            for (std::uint32_t x = 0; x < extent.width; ++x) {
                std::uint32_t value;
                std::memcpy(&value, back.mapped.data() + 4 * (std::size_t{y} * extent.width + x),
                            sizeof value);
                wrong += value != texel(0, y, x);
            }
        }
        EXPECT_EQ(wrong, 0u);
    }
    EXPECT_EQ(instance.validation_messages(), 0);
}

TEST_F(ValidatedDevice, MessagesNameTheObject) {
    const cw2::Buffer buffer =
        cw2::make_buffer(device, 16, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, cw2::MemoryUse::device);
    device.name(buffer.handle.get(), "the named one");
    testing::internal::CaptureStderr();
    // A buffer is bound once.
    vkBindBufferMemory(device.get(), buffer.handle.get(), buffer.memory.get(), 0);
    const std::string said = testing::internal::GetCapturedStderr();
    EXPECT_EQ(instance.validation_messages(), 1);
    EXPECT_NE(said.find("the named one"), std::string::npos) << said;
}

TEST(Device, NamesNothingWithoutValidation) {
    const cw2::Instance instance(false, {});
    const cw2::Device device(instance, std::nullopt);
    const cw2::Buffer buffer =
        cw2::make_buffer(device, 16, VK_BUFFER_USAGE_TRANSFER_SRC_BIT, cw2::MemoryUse::device);
    device.name(buffer.handle.get(), "nobody hears it");
}

TEST(Timestamps, StartAgainAtTheirHighestBit) {
    EXPECT_EQ(cw2::elapsed_ticks(5, 12, 64), 7u);
    EXPECT_EQ(cw2::elapsed_ticks(~std::uint64_t{0}, 2, 64), 3u);
    EXPECT_EQ(cw2::elapsed_ticks(0xF'FFFF'FFFE, 1, 36), 3u);
    // What is beyond the valid bits is undefined.
    EXPECT_EQ(cw2::elapsed_ticks(0xAB00'0000'0005, 0xCD00'0000'0009, 36), 4u);
}

}  // namespace
