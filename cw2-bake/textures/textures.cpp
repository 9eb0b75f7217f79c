#include "cw2-bake/textures/textures.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <map>
#include <mutex>
#include <numeric>
#include <optional>
#include <set>
#include <system_error>
#include <tuple>
#include <unordered_map>

#include "cw2-bake/textures/material_images.h"
#include "cw2-bake/textures/plan.h"
#include "cw2-bake/textures/reuse.h"
#include "mesh-format/file.h"

namespace bake {
namespace {

using mesh_format::MapUse;

/// The requests that read one image first, so that it is decoded once for all of them.
struct Batch {
    std::filesystem::path file;
    double weight = 0.0;  ///< about the time it takes
    std::vector<std::size_t> requests;
};

/// 1 where there is no such file.
double encoded_bytes(const TextureMap& map) {
    if (map.embedded) return static_cast<double>(map.embedded->size());
    std::error_code error;
    const std::uintmax_t bytes = std::filesystem::file_size(map.file, error);
    return error ? 1.0 : static_cast<double>(bytes);
}

/// Of the requests that have no result yet. The largest first, so that no thread starts a large one
/// when the others are done.
std::vector<Batch> make_batches(const std::vector<ImageRequest>& requests,
                                const std::vector<std::optional<ImageResult>>& results) {
    std::map<std::filesystem::path, Batch> by_file;
    for (std::size_t i = 0; i < requests.size(); ++i) {
        if (results[i]) continue;
        by_file[first_map(requests[i]).file].requests.push_back(i);
    }
    std::vector<Batch> batches;
    for (auto& [file, batch] : by_file) {
        // Normals first: what their levels lose is what roughness takes over.
        std::ranges::stable_sort(batch.requests, std::greater<>(), [&](std::size_t i) {
            return requests[i].kind == ImageRequest::Kind::normal ||
                   requests[i].kind == ImageRequest::Kind::bump;
        });
        const double weight = encoded_bytes(first_map(requests[batch.requests.front()]));
        batches.push_back({file, weight, std::move(batch.requests)});
    }
    std::ranges::stable_sort(batches, std::greater<>(), &Batch::weight);
    return batches;
}

/// Here, in parallel and soon after the texels were written.
void seal(std::optional<Texture>& texture) {
    if (texture) texture->checksum = mesh_format::checksum(texture->payload);
}

/// Makes what has no result yet.
void make_rest(const std::vector<ImageRequest>& requests, TextureForm form,
               const TextureProgress& progress, std::vector<std::optional<ImageResult>>& results) {
    const std::vector<Batch> batches = make_batches(requests, results);
    const double total = std::transform_reduce(batches.begin(), batches.end(), 0.0, std::plus<>(),
                                               [](const Batch& batch) { return batch.weight; });
    std::mutex progress_mutex;
    double done = 0.0;
    const auto report = [&](const Batch& batch, double weight) {
        const std::scoped_lock lock(progress_mutex);
        done += weight;
        if (progress) {
            progress(std::min(done / total, 1.0), batch.file.filename().native());
        }
    };
    std::atomic<std::size_t> next = 0;
    // A thread holds the images of one batch at a time: that bounds the memory in use beside the
    // finished payloads. TBB hands out ranges in no order, hence the counter.
    tbb::parallel_for(
        std::size_t{0}, batches.size(),
        [&](std::size_t) {
            const Batch& batch = batches[next++];
            report(batch, 0.0);
            ImageCache images;
            for (const std::size_t request : batch.requests) {
                ImageResult& result =
                    results[request].emplace(make_textures(requests[request], form, images));
                seal(result.texture);
                seal(result.alpha_mask);
            }
            report(batch, batch.weight);
        },
        tbb::simple_partitioner());
}

/// Takes over what `earlier` has.
std::vector<std::optional<ImageResult>> find_earlier(
    const EarlierBake& earlier, const std::vector<ImageRequest>& requests,
    const std::vector<std::optional<SourceKey>>& keys) {
    std::vector<std::optional<ImageResult>> results(requests.size());
    tbb::parallel_for(std::size_t{0}, requests.size(), [&](std::size_t i) {
        if (keys[i]) results[i] = earlier.find(*keys[i], requests[i]);
    });
    return results;
}

/// Numbers the textures in order of first use; equal ones get one number.
class Shelf {
 public:
    explicit Shelf(std::vector<Texture>& textures) : textures_(textures) {}

    /// The index of the texture, which is moved from; kNoTexture if there is none.
    std::uint32_t put(std::optional<Texture>& texture) {
        if (!texture) {
            return mesh_format::kNoTexture;
        }
        const auto [begin, end] = known_.equal_range(texture->checksum);
        for (auto entry = begin; entry != end; ++entry) {
            if (equal(textures_[entry->second], *texture)) {
                return entry->second;
            }
        }
        const auto index = static_cast<std::uint32_t>(textures_.size());
        known_.emplace(texture->checksum, index);
        textures_.push_back(std::move(*texture));
        return index;
    }

 private:
    static bool equal(const Texture& a, const Texture& b) {
        return std::tie(a.format, a.flags, a.width, a.height, a.psnr) ==
                   std::tie(b.format, b.flags, b.width, b.height, b.psnr) &&
               (a.bytes().data() == b.bytes().data() || std::ranges::equal(a.bytes(), b.bytes()));
    }

    std::vector<Texture>& textures_;
    std::unordered_multimap<std::uint64_t, std::uint32_t> known_;  ///< by checksum
};

/// Where the textures of a request are.
struct Placed {
    std::uint32_t texture = mesh_format::kNoTexture;
    std::uint32_t alpha_mask = mesh_format::kNoTexture;
    bool holds_factor = false;
};

mesh_format::SourceRecord source_record(const SourceKey& key, const Placed& placed) {
    return {.key = {key[0], key[1]},
            .texture = placed.texture,
            .alpha_mask = placed.alpha_mask,
            .flags = placed.holds_factor ? mesh_format::kHoldsFactor : 0u,
            .reserved = 0};
}

/// Each warning of an image once, in order of first use; of one that is not there, how it was
/// looked for.
void pass_on_warnings(const std::vector<ImageRequest>& requests,
                      const std::vector<std::optional<ImageResult>>& results, const Warn& warn) {
    std::set<std::string> told;
    for (const ImageRequest& request : requests) {
        for (const auto* map : {&request.map, &request.alpha_map, &request.relief}) {
            if (!*map || (*map)->note.empty() || !told.insert((*map)->note).second) continue;
            warn((*map)->stated_in + ": " + (*map)->note);
            told.insert((*map)->file.string() + ": no such file");
        }
    }
    for (const auto& result : results)
        for (const ImageWarning& warning : result->warnings)
            if (told.insert(warning.text).second) warn(warning.stated_in + ": " + warning.text);
}

}  // namespace

TextureSet bake_textures(std::span<const SourceMaterial> materials, TextureForm form,
                         const std::filesystem::path& earlier, const Warn& warn,
                         const TextureProgress& progress) {
    const TexturePlan plan = make_plan(materials, form.mode);
    if (plan.requests.empty())
        return {.textures = {}, .materials = std::vector<MaterialTextures>(materials.size())};
    const std::vector<std::optional<SourceKey>> keys = source_keys(plan.requests, form);
    const EarlierBake earlier_bake(earlier);
    std::vector<std::optional<ImageResult>> results =
        find_earlier(earlier_bake, plan.requests, keys);
    make_rest(plan.requests, form, progress, results);
    pass_on_warnings(plan.requests, results, warn);

    TextureSet set;
    set.earlier_file = earlier_bake.file();
    Shelf shelf(set.textures);
    std::vector<Placed> placed;
    for (std::size_t i = 0; i < results.size(); ++i) {
        ImageResult& result = *results[i];
        const std::uint32_t texture = shelf.put(result.texture);
        placed.push_back({texture, shelf.put(result.alpha_mask), result.holds_factor});
        // What is warned of must be warned of again.
        if (keys[i] && result.warnings.empty()) {
            set.sources.push_back(source_record(*keys[i], placed.back()));
        }
    }
    const auto at = [&](std::size_t request) {
        return request == kNoRequest ? Placed{} : placed[request];
    };
    for (const MaterialRequests& uses : plan.materials) {
        MaterialTextures material;
        for (std::size_t use = 0; use < mesh_format::kMapUseCount; ++use)
            material.textures.values[use] = at(uses.values[use]).texture;
        material.textures[MapUse::alpha_mask] = at(uses[MapUse::base_color]).alpha_mask;
        material.roughness_holds_factor = at(uses[MapUse::roughness]).holds_factor;
        set.materials.push_back(material);
    }
    return set;
}

}  // namespace bake
