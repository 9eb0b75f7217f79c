#include "cw2-bake/textures.h"

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

#include "cw2-bake/material_images.h"
#include "mesh-format/file.h"

namespace bake {
namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

/// The requests of one material; kNone where it has no such map.
struct MaterialRequests {
    std::size_t surface = kNone;
    std::size_t roughness = kNone;
    std::size_t metalness = kNone;
    std::size_t normal = kNone;
};

/// Every different request of the materials, in order of first use.
struct Plan {
    std::vector<ImageRequest> requests;
    std::vector<MaterialRequests> materials;
};

/// What makes two requests the same work: all but the place that states them.
auto identity(const std::optional<TextureMap>& map) {
    return map ? std::tuple(map->file.native(), map->channel, map->clamp)
               : std::tuple(std::string(), Channel::standard, false);
}
auto identity(const ImageRequest& request) {
    return std::tuple(request.kind, identity(request.map), identity(request.alpha_map),
                      request.alpha_cutoff, request.color_alpha_is_mask, request.bump_scale,
                      identity(request.relief), request.relief_is_bump, request.normal_scale,
                      request.factor);
}

/// In blocks, the bumps of a normal map make the smaller levels of the roughness rougher.
ImageRequest roughness_request(const SourceMaterial& material, TextureMode mode) {
    ImageRequest request{.kind = ImageRequest::Kind::scalar, .map = material.roughness_map};
    const bool has_relief = material.normal_map || material.bump_map;
    if (mode != TextureMode::bc || !has_relief || (!request.map && material.roughness >= 1.0f)) {
        return request;
    }
    request.kind = ImageRequest::Kind::roughness;
    request.relief = material.normal_map ? material.normal_map : material.bump_map->map;
    request.relief_is_bump = !material.normal_map;
    if (request.relief_is_bump) request.bump_scale = material.bump_map->scale;
    if (material.normal_map) request.normal_scale = material.normal_scale;
    request.factor = material.roughness;
    return request;
}

Plan make_plan(std::span<const SourceMaterial> materials, TextureMode mode) {
    Plan plan;
    std::map<decltype(identity(ImageRequest{})), std::size_t> known;
    const auto add = [&](ImageRequest request) {
        if (!request.map && !request.alpha_map && !request.relief) {
            return kNone;
        }
        const auto [entry, fresh] = known.try_emplace(identity(request), plan.requests.size());
        if (fresh) {
            plan.requests.push_back(std::move(request));
        }
        return entry->second;
    };
    for (const SourceMaterial& material : materials) {
        MaterialRequests uses;
        uses.surface = add({.kind = ImageRequest::Kind::surface,
                            .map = material.base_color_map,
                            .alpha_map = material.alpha_map,
                            .alpha_cutoff = material.alpha_cutoff,
                            .color_alpha_is_mask = material.base_color_alpha_is_mask});
        uses.roughness = add(roughness_request(material, mode));
        uses.metalness = add({.kind = ImageRequest::Kind::scalar, .map = material.metalness_map});
        if (material.normal_map) {
            uses.normal = add({.kind = ImageRequest::Kind::normal, .map = material.normal_map});
        } else if (material.bump_map) {
            uses.normal = add({.kind = ImageRequest::Kind::bump,
                               .map = material.bump_map->map,
                               .bump_scale = material.bump_map->scale});
        }
        plan.materials.push_back(uses);
    }
    return plan;
}

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

/// The largest first, so that no thread starts a large one when the others are done.
std::vector<Batch> make_batches(const std::vector<ImageRequest>& requests) {
    std::map<std::filesystem::path, Batch> by_file;
    for (std::size_t i = 0; i < requests.size(); ++i) {
        by_file[first_map(requests[i]).file].requests.push_back(i);
    }
    std::vector<Batch> batches;
    for (auto& [file, batch] : by_file) {
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

std::vector<ImageResult> run(const std::vector<ImageRequest>& requests, TextureMode mode,
                             const TextureProgress& progress) {
    const std::vector<Batch> batches = make_batches(requests);
    const double total = std::transform_reduce(batches.begin(), batches.end(), 0.0, std::plus<>(),
                                               [](const Batch& batch) { return batch.weight; });
    std::vector<ImageResult> results(requests.size());
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
                results[request] = make_textures(requests[request], mode, images);
                seal(results[request].texture);
                seal(results[request].alpha_mask);
            }
            report(batch, batch.weight);
        },
        tbb::simple_partitioner());
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
        return std::tie(a.format, a.clamp, a.width, a.height, a.psnr, a.payload) ==
               std::tie(b.format, b.clamp, b.width, b.height, b.psnr, b.payload);
    }

    std::vector<Texture>& textures_;
    std::unordered_multimap<std::uint64_t, std::uint32_t> known_;  ///< by checksum
};

/// One warning an image, in order of first use.
void pass_on_warnings(const std::vector<ImageResult>& results, const Warn& warn) {
    std::set<std::filesystem::path> named;
    for (const ImageResult& result : results) {
        for (const ImageWarning& warning : result.warnings) {
            if (named.insert(warning.file).second) {
                warn(warning.text);
            }
        }
    }
}

}  // namespace

TextureSet bake_textures(std::span<const SourceMaterial> materials, TextureMode mode,
                         const Warn& warn, const TextureProgress& progress) {
    const Plan plan = make_plan(materials, mode);
    std::vector<ImageResult> results = run(plan.requests, mode, progress);
    pass_on_warnings(results, warn);

    TextureSet set;
    Shelf shelf(set.textures);
    struct Placed {
        std::uint32_t texture = mesh_format::kNoTexture;
        std::uint32_t alpha_mask = mesh_format::kNoTexture;
        bool holds_factor = false;
    };
    std::vector<Placed> placed;
    for (ImageResult& result : results) {
        const std::uint32_t texture = shelf.put(result.texture);
        placed.push_back({texture, shelf.put(result.alpha_mask), result.holds_factor});
    }
    const auto at = [&](std::size_t request) {
        return request == kNone ? Placed{} : placed[request];
    };
    for (const MaterialRequests& uses : plan.materials) {
        set.materials.push_back({.base_color = at(uses.surface).texture,
                                 .roughness = at(uses.roughness).texture,
                                 .metalness = at(uses.metalness).texture,
                                 .normal = at(uses.normal).texture,
                                 .alpha_mask = at(uses.surface).alpha_mask,
                                 .roughness_holds_factor = at(uses.roughness).holds_factor});
    }
    return set;
}

}  // namespace bake
