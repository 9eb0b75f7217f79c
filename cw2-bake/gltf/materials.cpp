#include "cw2-bake/gltf/materials.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "cw2-bake/base/text_lines.h"

namespace bake {
namespace {

using mesh_format::MapUse;

double number_or(const tinygltf::Value& value, double fallback) {
    return value.IsNumber() ? value.GetNumberAsDouble() : fallback;
}

glm::dvec2 vector_or(const tinygltf::Value& array, double fallback) {
    if (!array.IsArray()) return glm::dvec2(fallback);
    return {number_or(array.Get(0), fallback), number_or(array.Get(1), fallback)};
}

float clamped(double value) {
    return static_cast<float>(std::clamp(value, 0.0, 1.0));
}

std::string drawn_opaque(const SourceMaterial& material) {
    return fmt::format("{} has alpha {:.3g}; drawn opaque", in_quotes(material.name),
                       material.opacity);
}

/// Of the first of several; says how many there are.
void warn_of_first(const std::string& what, std::size_t count, const Warn& warn) {
    if (count > 0) warn(what + (count > 1 ? fmt::format(" ({} such materials)", count) : ""));
}

}  // namespace

glm::dvec2 UvTransform::apply(const glm::dvec2& uv) const {
    const glm::dvec2 scaled = scale * uv;
    const double c = std::cos(rotation);
    const double s = std::sin(rotation);
    return offset + glm::dvec2(c * scaled.x + s * scaled.y, c * scaled.y - s * scaled.x);
}

/// What a material says of one of its textures.
struct GltfMaterials::TextureUse {
    int texture;
    int uv_set;
    UvTransform transform;

    template <typename Info>
    explicit TextureUse(const Info& info) : texture(info.index), uv_set(info.texCoord) {
        const auto extension = info.extensions.find("KHR_texture_transform");
        if (extension == info.extensions.end()) return;
        const tinygltf::Value& value = extension->second;
        transform.offset = vector_or(value.Get("offset"), 0.0);
        transform.rotation = number_or(value.Get("rotation"), 0.0);
        transform.scale = vector_or(value.Get("scale"), 1.0);
        uv_set = static_cast<int>(number_or(value.Get("texCoord"), uv_set));
    }
};

std::optional<TextureMap> GltfMaterials::texture_map(const TextureUse& use,
                                                     const std::string& place) {
    if (use.texture < 0) return std::nullopt;
    const auto& texture = file_.model.textures[static_cast<std::size_t>(use.texture)];
    int source = texture.source;
    if (const auto webp = texture.extensions.find("EXT_texture_webp");
        webp != texture.extensions.end()) {
        source = static_cast<int>(number_or(webp->second.Get("source"), source));
    }
    if (source < 0) {
        warn_(fmt::format("{}: texture {} has no image", place, use.texture));
        return std::nullopt;
    }
    const GltfImage& image = file_.images[static_cast<std::size_t>(source)];
    if (!image.problem.empty()) {
        if (unusable_images_.insert(source).second) {
            warn_(fmt::format("{}: /images/{}: {}", file_.path.string(), source, image.problem));
        }
        return std::nullopt;
    }
    TextureMap map{
        .file = image.file, .embedded = image.embedded, .stated_in = place, .note = image.note};
    if (texture.sampler >= 0) {
        const auto& sampler = file_.model.samplers[static_cast<std::size_t>(texture.sampler)];
        const auto clamps = [](int wrap) { return wrap == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE; };
        map.clamp = clamps(sampler.wrapS) && clamps(sampler.wrapT);
        const bool repeats = sampler.wrapS == TINYGLTF_TEXTURE_WRAP_REPEAT &&
                             sampler.wrapT == TINYGLTF_TEXTURE_WRAP_REPEAT;
        if (!map.clamp && !repeats) {
            warn_(fmt::format("{}: texture {} mirrors, or clamps along one axis alone: it repeats",
                              place, use.texture));
        }
    }
    return map;
}

void GltfMaterials::take_mask(const tinygltf::Material& material, const std::string& place,
                              GltfMaterial& result) {
    SourceMaterial& source = result.source;
    source.base_color_alpha_is_mask = material.alphaMode != "OPAQUE";
    if (material.alphaMode == "MASK") {
        const auto& factor = material.pbrMetallicRoughness.baseColorFactor;
        const double alpha = factor.size() == 4 ? std::clamp(factor[3], 0.0, 1.0) : 1.0;
        const double cutoff = std::max(material.alphaCutoff, 0.0);
        // factor * texture < cutoff, with the factor brought to the other side.
        const bool hides_all = cutoff > alpha;
        result.visible = !hides_all;
        source.alpha_cutoff = alpha > 0.0 && !hides_all ? clamped(cutoff / alpha) : 0.0f;
        // Stated as such, the mask counts even if it hides everything.
        if ((source.maps[MapUse::alpha_mask] = source.maps[MapUse::base_color]))
            source.maps[MapUse::alpha_mask]->channel = Channel::alpha;
        if (hides_all) {
            warn_(fmt::format("{}: {} is invisible: its alpha is below its cutoff", place,
                              in_quotes(source.name)));
        }
    } else if (material.alphaMode == "BLEND") {
        const auto& factor = material.pbrMetallicRoughness.baseColorFactor;
        source.blend = true;
        source.opacity = factor.size() == 4 ? clamped(factor[3]) : 1.0f;
        if (!source.maps[MapUse::base_color] && source.opacity < 1.0f && opaque_++ == 0)
            first_opaque_ = place + ": " + drawn_opaque(source);
    }
}

void GltfMaterials::take_emission(const tinygltf::Material& material, const std::string& place,
                                  SourceMaterial& source) {
    source.unlit = material.extensions.contains("KHR_materials_unlit");
    if (source.unlit || material.emissiveFactor.size() != 3) return;
    double strength = 1.0;
    if (const auto extension = material.extensions.find("KHR_materials_emissive_strength");
        extension != material.extensions.end()) {
        strength = std::max(number_or(extension->second.Get("emissiveStrength"), 1.0), 0.0);
    }
    for (int channel = 0; channel < 3; ++channel) {
        const double factor = material.emissiveFactor[static_cast<std::size_t>(channel)];
        source.emission[channel] = static_cast<float>(std::max(factor, 0.0) * strength);
        if (!std::isfinite(source.emission[channel]))
            throw BakeError(place + "/emissiveFactor: is too large");
    }
}

GltfMaterial GltfMaterials::convert(int index) {
    static const tinygltf::Material default_material;
    const tinygltf::Material& material =
        index < 0 ? default_material : file_.model.materials[static_cast<std::size_t>(index)];
    const std::string place = fmt::format("{}: /materials/{}", file_.path.string(), index);
    const auto& surface = material.pbrMetallicRoughness;

    GltfMaterial result;
    SourceMaterial& source = result.source;
    source.name = !material.name.empty() ? material.name
                  : index < 0            ? "default"
                                         : fmt::format("material{}", index);
    for (int channel = 0; channel < 3; ++channel) {
        const auto i = static_cast<std::size_t>(channel);
        const bool stated = surface.baseColorFactor.size() == 4;
        source.base_color[channel] = stated ? clamped(surface.baseColorFactor[i]) : 1.0f;
    }
    source.roughness = clamped(surface.roughnessFactor);
    source.metalness = clamped(surface.metallicFactor);
    source.normal_scale = static_cast<float>(material.normalTexture.scale);
    if (!std::isfinite(source.normal_scale)) {
        throw BakeError(place + "/normalTexture/scale: is too large");
    }
    source.cull_back = !material.doubleSided;
    source.flip_back_normals = material.doubleSided && !material.extras.Has("cw2_back_normals");

    const TextureUse color(surface.baseColorTexture);
    const TextureUse normal(material.normalTexture);
    const TextureUse rough(surface.metallicRoughnessTexture);
    source.maps[MapUse::base_color] = texture_map(color, place);
    source.maps[MapUse::normal] = texture_map(normal, place);
    if (std::optional<TextureMap> map = texture_map(rough, place)) {
        map->channel = Channel::g;
        source.maps[MapUse::roughness] = map;
        map->channel = Channel::b;
        source.maps[MapUse::metalness] = map;
    }
    take_mask(material, place, result);
    const TextureUse glow(material.emissiveTexture);
    take_emission(material, place, source);
    if (source.emission != glm::vec3(0.0f))
        source.maps[MapUse::emission] = texture_map(glow, place);

    const TextureUse* chosen = nullptr;
    for (const TextureUse* use : {&color, &normal, &rough, &glow}) {
        if (use->texture < 0 || (use == &glow && !source.maps[MapUse::emission])) continue;
        if (!chosen) {
            chosen = use;
        } else if (use->uv_set != chosen->uv_set || use->transform != chosen->transform) {
            warn_(
                fmt::format("{}: the textures of {} differ in UV set or transform; all take "
                            "those of the {}",
                            place, in_quotes(source.name),
                            chosen == &color    ? "base colour"
                            : chosen == &normal ? "normal map"
                                                : "roughness"));
            break;
        }
    }
    if (chosen) {
        result.uv_set = chosen->uv_set;
        result.uv_transform = chosen->transform;
    }
    return result;
}

void GltfMaterials::warn_of_left_out() const {
    warn_of_first(first_opaque_, opaque_, warn_);
}

void warn_of_blending(std::span<const SourceMaterial> materials,
                      std::span<const MaterialTextures> textures, const Warn& warn) {
    std::string first_masked, first_opaque;
    std::size_t masked = 0, opaque = 0;
    for (std::size_t i = 0; i < materials.size(); ++i) {
        const auto& map = materials[i].maps[MapUse::base_color];
        if (!materials[i].blend || !map) continue;
        if (textures[i].textures[MapUse::alpha_mask] != mesh_format::kNoTexture) {
            if (masked++ == 0) {
                first_masked = fmt::format(
                    "{}: {} is blended; it is drawn with a mask that cuts below alpha 0.5",
                    map->stated_in, in_quotes(materials[i].name));
            }
        } else if (materials[i].opacity < 1.0f && opaque++ == 0) {
            first_opaque = map->stated_in + ": " + drawn_opaque(materials[i]);
        }
    }
    warn_of_first(first_masked, masked, warn);
    warn_of_first(first_opaque, opaque, warn);
}

}  // namespace bake
