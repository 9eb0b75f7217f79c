// bench_blits FOLDER
//
// What a renderer does that is given source images: reads every image in FOLDER with OpenImageIO,
// one after the other, uploads it in RGBA8, and has the device make its mip levels with blits.
// Prints the milliseconds of that, and of reading alone. tests/bench/bench_textures.sh compares.
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <vector>

#include "cw2/vulkan/device.h"
#include "cw2/vulkan/resources.h"
#include "mesh-format/layout.h"

namespace {

using Clock = std::chrono::steady_clock;

double milliseconds_since(Clock::time_point start) {
    return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

struct Texels {
    VkExtent2D extent{};
    std::vector<unsigned char> rgba;
};

Texels read(const std::filesystem::path& path) {
    const auto input = OIIO::ImageInput::open(path.string());
    if (!input) throw std::runtime_error(OIIO::geterror());
    const OIIO::ImageSpec& spec = input->spec();
    const auto channels = static_cast<std::size_t>(spec.nchannels);
    std::vector<unsigned char> samples(spec.image_pixels() * channels);
    input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT8, samples.data());
    Texels texels{{static_cast<std::uint32_t>(spec.width), static_cast<std::uint32_t>(spec.height)},
                  std::vector<unsigned char>(4 * spec.image_pixels(), 255)};
    for (std::size_t i = 0; i < spec.image_pixels(); ++i) {
        for (std::size_t c = 0; c < std::min<std::size_t>(channels, 4); ++c) {
            texels.rgba[4 * i + c] = samples[channels * i + c];
        }
    }
    return texels;
}

VkImageMemoryBarrier2 barrier(VkImage image, std::uint32_t level, VkImageLayout from,
                              VkImageLayout to) {
    return {.sType = VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER_2,
            .srcStageMask = VK_PIPELINE_STAGE_2_ALL_TRANSFER_BIT,
            .srcAccessMask = VK_ACCESS_2_TRANSFER_WRITE_BIT,
            .dstStageMask = VK_PIPELINE_STAGE_2_ALL_COMMANDS_BIT,
            .dstAccessMask = VK_ACCESS_2_MEMORY_READ_BIT | VK_ACCESS_2_MEMORY_WRITE_BIT,
            .oldLayout = from,
            .newLayout = to,
            .image = image,
            .subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, level, 1, 0, 1}};
}

void apply(VkCommandBuffer commands, const VkImageMemoryBarrier2& change) {
    const VkDependencyInfo info{.sType = VK_STRUCTURE_TYPE_DEPENDENCY_INFO,
                                .imageMemoryBarrierCount = 1,
                                .pImageMemoryBarriers = &change};
    vkCmdPipelineBarrier2(commands, &info);
}

VkOffset3D corner(VkExtent2D extent, std::uint32_t level) {
    return {static_cast<std::int32_t>(mesh_format::mip_extent(extent.width, level)),
            static_cast<std::int32_t>(mesh_format::mip_extent(extent.height, level)), 1};
}

void record_blits(VkCommandBuffer commands, VkImage image, VkExtent2D extent,
                  std::uint32_t levels) {
    for (std::uint32_t level = 1; level < levels; ++level) {
        apply(commands, barrier(image, level - 1, VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL,
                                VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL));
        apply(commands, barrier(image, level, VK_IMAGE_LAYOUT_UNDEFINED,
                                VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL));
        const VkImageBlit blit{
            .srcSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, level - 1, 0, 1},
            .srcOffsets = {{}, corner(extent, level - 1)},
            .dstSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, level, 0, 1},
            .dstOffsets = {{}, corner(extent, level)},
        };
        vkCmdBlitImage(commands, image, VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL, image,
                       VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &blit, VK_FILTER_LINEAR);
    }
}

cw2::Image upload(const cw2::Device& device, VkCommandBuffer commands, const Texels& texels) {
    const std::uint32_t levels =
        mesh_format::full_mip_count(texels.extent.width, texels.extent.height);
    cw2::Image image =
        make_image(device, {.format = VK_FORMAT_R8G8B8A8_SRGB,
                            .extent = texels.extent,
                            .mip_count = levels,
                            .usage = VK_IMAGE_USAGE_SAMPLED_BIT | VK_IMAGE_USAGE_TRANSFER_SRC_BIT |
                                     VK_IMAGE_USAGE_TRANSFER_DST_BIT});
    const cw2::Buffer staging = make_buffer(
        device, texels.rgba.size(), VK_BUFFER_USAGE_TRANSFER_SRC_BIT, cw2::MemoryUse::upload);
    std::memcpy(staging.mapped.data(), texels.rgba.data(), texels.rgba.size());
    cw2::begin_commands(commands);
    apply(commands, barrier(image.handle.get(), 0, VK_IMAGE_LAYOUT_UNDEFINED,
                            VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL));
    const VkBufferImageCopy copy{.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1},
                                 .imageExtent = {texels.extent.width, texels.extent.height, 1}};
    vkCmdCopyBufferToImage(commands, staging.handle.get(), image.handle.get(),
                           VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &copy);
    record_blits(commands, image.handle.get(), texels.extent, levels);
    submit_and_wait(device, commands);
    return image;
}

void bench(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        files.push_back(entry.path());
    }
    std::ranges::sort(files);
    const cw2::Instance instance(false, {});
    const cw2::Device device(instance, std::nullopt);
    const cw2::CommandPool pool = make_command_pool(device);
    const VkCommandBuffer commands = allocate_commands(device, pool.get());
    double reading = 0.0;
    const auto start = Clock::now();
    std::vector<cw2::Image> images;
    for (const auto& file : files) {
        const auto begin = Clock::now();
        const Texels texels = read(file);
        reading += milliseconds_since(begin);
        images.push_back(upload(device, commands, texels));
    }
    std::printf("%.1f %.1f\n", milliseconds_since(start), reading);
}

}  // namespace

int main(int count, char** values) {
    try {
        if (count != 2) throw std::runtime_error("usage: bench_blits FOLDER");
        bench(values[1]);
        return 0;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "bench_blits: %s\n", error.what());
        return 1;
    }
}
