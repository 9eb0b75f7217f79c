// Index buffers of the triangles that pictures show.
#pragma once

#include <vulkan/vulkan.h>

#include <cstdint>
#include <span>
#include <vector>

#include "cw2/render/scene.h"
#include "cw2/render/shown_triangles.h"
#include "cw2/vulkan/device.h"
#include "cw2/vulkan/resources.h"

namespace cw2 {

/// For devices that are the CPU. Keeps what it finds for the views of late, so that a picture of
/// which only the light moves costs nothing.
class TriangleCulling {
 public:
    /// Views that are kept, one more than frames may be in flight or more: the samples that
    /// pictures have by default.
    static constexpr std::size_t kViews = 4;

    struct Shown {
        VkBuffer buffer;
        std::span<const std::uint16_t> indices;  ///< in it
        std::span<const DrawRange> ranges;       ///< see ShownTriangles
    };

    struct Wanted {
        PictureView view;
        std::vector<std::uint32_t> chunks;  ///< see shown_triangles()
    };

    explicit TriangleCulling(const Device& device) : device_(device) {}

    /// For each of up to kViews, on all threads. What it returns lasts until kViews others are
    /// found. Throws VulkanError.
    std::vector<Shown> find(const Scene& scene, std::span<const Wanted> views);

 private:
    struct Entry {
        std::uint64_t scene = 0;
        PictureView view{};
        std::vector<DrawRange> ranges;
        std::size_t index_count = 0;
        Buffer buffer;
        std::uint64_t used = 0;  ///< when
    };
    Entry* entry_of(const Scene& scene, const PictureView& view);
    void keep(const Scene& scene, const PictureView& view, ShownTriangles found);

    const Device& device_;
    BandDepths depths_;
    std::vector<Entry> entries_;
    std::uint64_t now_ = 0;
};

}  // namespace cw2
