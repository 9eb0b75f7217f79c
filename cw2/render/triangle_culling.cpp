#include "cw2/render/triangle_culling.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <utility>

namespace cw2 {

namespace {

bool is_same(const PictureView& a, const PictureView& b) {
    return a.clip_from_world == b.clip_from_world && a.near == b.near &&
           a.extent.width == b.extent.width && a.extent.height == b.extent.height &&
           a.area.offset.x == b.area.offset.x && a.area.offset.y == b.area.offset.y &&
           a.area.extent.width == b.area.extent.width &&
           a.area.extent.height == b.area.extent.height;
}

}  // namespace

TriangleCulling::Entry* TriangleCulling::entry_of(const Scene& scene, const PictureView& view) {
    const auto found = std::ranges::find_if(entries_, [&](const Entry& entry) {
        return entry.scene == scene.id() && is_same(entry.view, view);
    });
    return found == entries_.end() ? nullptr : &*found;
}

void TriangleCulling::keep(const Scene& scene, const PictureView& view, ShownTriangles found) {
    if (entries_.size() < kViews) entries_.emplace_back();
    Entry& entry = *std::ranges::min_element(entries_, {}, &Entry::used);
    const auto bytes = std::as_bytes(std::span(found.indices));
    if (!entry.buffer.handle.get() || entry.buffer.mapped.size() < bytes.size()) {
        entry.buffer = make_buffer(device_, std::max<std::size_t>(bytes.size() * 9 / 8, 4),
                                   VK_BUFFER_USAGE_INDEX_BUFFER_BIT, MemoryUse::upload);
        device_.name(entry.buffer.handle.get(), "shown triangles");
    }
    std::ranges::copy(bytes, entry.buffer.mapped.begin());
    entry.scene = scene.id();
    entry.view = view;
    entry.ranges = std::move(found.ranges);
    entry.index_count = found.indices.size();
    entry.used = ++now_;
}

std::vector<TriangleCulling::Shown> TriangleCulling::find(const Scene& scene,
                                                          std::span<const Wanted> views) {
    std::vector<const Wanted*> missing;
    for (const Wanted& wanted : views) {
        Entry* const entry = entry_of(scene, wanted.view);
        // Not to be replaced by those that are found now.
        entry ? void(entry->used = ++now_) : missing.push_back(&wanted);
    }
    std::vector<ShownTriangles> found(missing.size());
    std::vector<BandDepths> depths(missing.size());
    if (!missing.empty()) std::swap(depths[0], depths_);
    tbb::parallel_for(std::size_t{0}, missing.size(), [&](std::size_t i) {
        found[i] = shown_triangles(
            {scene.positions(), scene.host_indices(), scene.chunks(), scene.draws()},
            missing[i]->chunks, missing[i]->view, depths[i]);
    });
    if (!missing.empty()) std::swap(depths[0], depths_);
    for (std::size_t i = 0; i < missing.size(); ++i)
        keep(scene, missing[i]->view, std::move(found[i]));
    std::vector<Shown> shown;
    for (const Wanted& wanted : views) {
        const Entry& entry = *entry_of(scene, wanted.view);
        shown.push_back({entry.buffer.handle.get(),
                         {reinterpret_cast<const std::uint16_t*>(entry.buffer.mapped.data()),
                          entry.index_count},
                         entry.ranges});
    }
    return shown;
}

}  // namespace cw2
