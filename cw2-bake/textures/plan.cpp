#include "cw2-bake/textures/plan.h"

#include <map>
#include <string>
#include <utility>

namespace bake {
namespace {

using mesh_format::MapUse;

/// What makes two requests the same work: all but the place that states them.
std::pair<std::vector<std::string>, RequestSettings> identity(const ImageRequest& request) {
    std::vector<std::string> files;
    for (const auto* map : {&request.map, &request.alpha_map, &request.relief}) {
        files.push_back(*map ? (*map)->file.native() : "");
    }
    return {std::move(files), settings_of(request)};
}

/// In blocks, the bumps of a normal map make the smaller levels of the roughness rougher.
ImageRequest roughness_request(const SourceMaterial& material, TextureMode mode) {
    ImageRequest request{.kind = ImageRequest::Kind::scalar,
                         .map = material.maps[MapUse::roughness]};
    const bool has_relief = material.maps[MapUse::normal] || material.bump_map;
    if (mode != TextureMode::bc || !has_relief || (!request.map && material.roughness >= 1.0f)) {
        return request;
    }
    request.kind = ImageRequest::Kind::roughness;
    request.relief =
        material.maps[MapUse::normal] ? material.maps[MapUse::normal] : material.bump_map->map;
    request.relief_is_bump = !material.maps[MapUse::normal];
    if (request.relief_is_bump) request.bump_scale = material.bump_map->scale;
    if (material.maps[MapUse::normal]) request.normal_scale = material.normal_scale;
    request.factor = material.roughness;
    return request;
}

}  // namespace

TexturePlan make_plan(std::span<const SourceMaterial> materials, TextureMode mode) {
    TexturePlan plan;
    std::map<decltype(identity(ImageRequest{})), std::size_t> known;
    const auto add = [&](ImageRequest request) {
        if (!request.map && !request.alpha_map && !request.relief) {
            return kNoRequest;
        }
        const auto [entry, fresh] = known.try_emplace(identity(request), plan.requests.size());
        if (fresh) {
            plan.requests.push_back(std::move(request));
        }
        return entry->second;
    };
    for (const SourceMaterial& material : materials) {
        MaterialRequests uses = mesh_format::per_map(kNoRequest);
        uses[MapUse::base_color] =
            add({.kind = ImageRequest::Kind::surface,
                 .map = material.maps[MapUse::base_color],
                 .alpha_map = material.maps[MapUse::alpha_mask],
                 .alpha_cutoff = material.alpha_cutoff,
                 .color_alpha_is_mask = material.base_color_alpha_is_mask,
                 .color_is_blended = material.blend && material.opacity >= 1.0f});
        uses[MapUse::roughness] = add(roughness_request(material, mode));
        uses[MapUse::metalness] =
            add({.kind = ImageRequest::Kind::scalar, .map = material.maps[MapUse::metalness]});
        if (material.maps[MapUse::normal]) {
            uses[MapUse::normal] =
                add({.kind = ImageRequest::Kind::normal, .map = material.maps[MapUse::normal]});
        } else if (material.bump_map) {
            uses[MapUse::normal] = add({.kind = ImageRequest::Kind::bump,
                                        .map = material.bump_map->map,
                                        .bump_scale = material.bump_map->scale});
        }
        uses[MapUse::emission] = add({.kind = ImageRequest::Kind::surface,
                                      .map = material.maps[MapUse::emission],
                                      .color_alpha_is_mask = false});
        plan.materials.push_back(uses);
    }
    return plan;
}

}  // namespace bake
