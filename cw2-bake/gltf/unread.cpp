#include "cw2-bake/gltf/unread.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string_view>

#include "cw2-bake/base/text_lines.h"
#include "cw2-bake/gltf/json.h"

namespace bake {
namespace {

using nlohmann::json;

/// Extensions that say nothing of how a model looks at load.
bool is_beside_looks(std::string_view name) {
    constexpr std::string_view kNames[] = {"EXT_mesh_features",
                                           "EXT_structural_metadata",
                                           "FB_ngon_encoding",
                                           "KHR_animation_pointer",
                                           "KHR_materials_variants",
                                           "KHR_xmp",
                                           "KHR_xmp_json_ld",
                                           "MSFT_lod",
                                           "MSFT_packing_normalRoughnessMetallic",
                                           "MSFT_packing_occlusionRoughnessMetallic"};
    return std::ranges::find(kNames, name) != std::end(kNames);
}

class Finder {
 public:
    std::vector<std::string> find(const json& root) {
        find_core(root);
        descend(root, "");
        std::vector<std::string> lines;
        for (const auto& what : order_) {
            const auto& [pointer, count] = found_.at(what);
            lines.push_back(fmt::format("{}: {}{}", pointer, what,
                                        count > 1 ? fmt::format(" ({} such places)", count) : ""));
        }
        return lines;
    }

 private:
    struct Place {
        std::string first;
        std::size_t count = 0;
    };

    void note(const std::string& what, const std::string& pointer) {
        const auto [entry, fresh] = found_.try_emplace(what, Place{pointer});
        if (fresh) order_.push_back(what);
        ++entry->second.count;
    }

    template <typename Use>
    static void each(const json& root, const char* array, Use&& use) {
        const auto found = root.find(array);
        for (std::size_t i = 0; found != root.end() && i < found->size(); ++i)
            use((*found)[i], fmt::format("/{}/{}", array, i));
    }

    void find_core(const json& root) {
        if (const auto found = root.find("animations");
            found != root.end() && found->is_array() && !found->empty())
            note("animations are left out: the scene is in its pose at load", "/animations");
        each(root, "materials", [&](const json& material, const std::string& pointer) {
            if (material.contains("occlusionTexture"))
                note("ambient occlusion is left out", pointer + "/occlusionTexture");
        });
        each(root, "samplers", [&](const json& sampler, const std::string& pointer) {
            constexpr int kNearest = 9728;
            if (const auto filter = sampler.find("magFilter");
                filter != sampler.end() && *filter == kNearest)
                note("is nearest: textures are smooth all the same", pointer + "/magFilter");
        });
    }

    /// Nothing inside an extension that is left out, or in what applications add, is looked at.
    void descend(const json& value, const std::string& pointer) {
        if (value.is_array()) {
            for (std::size_t i = 0; i < value.size(); ++i)
                if (value[i].is_structured()) descend(value[i], pointer + '/' + std::to_string(i));
        }
        if (!value.is_object()) return;
        for (const auto& [key, member] : value.items()) {
            if (key == "extras" || !member.is_structured()) continue;
            const std::string below = pointer + '/' + key;
            if (key != "extensions" || !member.is_object()) {
                descend(member, below);
                continue;
            }
            for (const auto& [name, extension] : member.items()) {
                if (is_known_extension(name)) {
                    descend(extension, below + '/' + name);
                } else if (name == kBasisuExtension) {
                    note(
                        "KTX2 textures (KHR_texture_basisu) are not read; the image beside it is "
                        "taken, if there is one",
                        below + '/' + name);
                } else if (!is_beside_looks(name)) {
                    note(fmt::format("the extension {} is not supported, and left out",
                                     in_quotes(name)),
                         below + '/' + name);
                }
            }
        }
    }

    std::map<std::string, Place> found_;
    std::vector<std::string> order_;  ///< keys of found_, as they were met
};

}  // namespace

std::vector<std::string> find_unread(const json& root) {
    return Finder().find(root);
}

}  // namespace bake
