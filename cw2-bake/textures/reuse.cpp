#include "cw2-bake/textures/reuse.h"

#include <tbb/parallel_for.h>

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <string>
#include <string_view>

#include "cw2-bake/textures/payload_compression.h"
#include "cw2-bake/textures/read_common_image.h"

namespace bake {
namespace {

/// The bytes of which a key is the hash.
class KeyText {
 public:
    template <typename T>
    void add(const T& value) {
        static_assert(std::has_unique_object_representations_v<T> || std::is_same_v<T, float>);
        text_.append(reinterpret_cast<const char*>(&value), sizeof value);
    }
    template <typename... T>
    void add(const std::tuple<T...>& values) {
        std::apply([&](const T&... value) { (add(value), ...); }, values);
    }
    void add(std::string_view text) {
        add(text.size());
        text_ += text;
    }
    SourceKey hash() const { return hash_of(std::as_bytes(std::span(text_))); }

    static SourceKey hash_of(std::span<const std::byte> bytes) {
        const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
        return {hash.low64, hash.high64};
    }

 private:
    std::string text_;
};

using Contents = std::map<std::filesystem::path, std::optional<SourceKey>>;

std::optional<SourceKey> content_hash(const TextureMap& map) {
    if (map.embedded) return KeyText::hash_of(*map.embedded);
    try {
        return KeyText::hash_of(common::MappedFile(map.file).bytes());
    } catch (const common::FileError&) {
        return std::nullopt;  // whoever reads the image says what is wrong with it
    }
}

/// The hash of every image that a request names; none of one that cannot be read.
Contents hash_images(std::span<const ImageRequest> requests) {
    Contents contents;
    std::vector<std::pair<const TextureMap*, std::optional<SourceKey>*>> work;
    for (const ImageRequest& request : requests) {
        for (const auto* map : {&request.map, &request.alpha_map, &request.relief}) {
            if (!*map) continue;
            const auto [entry, fresh] = contents.try_emplace((*map)->file);
            if (fresh) work.emplace_back(&**map, &entry->second);
        }
    }
    tbb::parallel_for(std::size_t{0}, work.size(),
                      [&](std::size_t i) { *work[i].second = content_hash(*work[i].first); });
    return contents;
}

std::optional<SourceKey> source_key(const ImageRequest& request, TextureForm form,
                                    const Contents& contents, std::string_view libraries) {
    KeyText text;
    text.add(std::string_view(CW2_TEXTURE_CODE));
    text.add(libraries);
    text.add(form.mode);
    text.add(form.compressed);
    if (form.compressed) text.add(std::string_view(payload_compression_library()));
    text.add(settings_of(request));
    for (const auto* map : {&request.map, &request.alpha_map, &request.relief}) {
        if (!*map) continue;
        const std::optional<SourceKey>& content = contents.at((*map)->file);
        if (!content) return std::nullopt;
        text.add(*content);
        // The extension may decide what the bytes mean.
        if (!(*map)->embedded) text.add(std::string_view((*map)->file.extension().native()));
    }
    return text.hash();
}

}  // namespace

std::vector<std::optional<SourceKey>> source_keys(std::span<const ImageRequest> requests,
                                                  TextureForm form) {
    const Contents contents = hash_images(requests);
    const std::string libraries = common_image_libraries();
    std::vector<std::optional<SourceKey>> keys;
    for (const ImageRequest& request : requests) {
        keys.push_back(source_key(request, form, contents, libraries));
    }
    return keys;
}

EarlierBake::EarlierBake(const std::filesystem::path& path) {
    try {
        file_ = std::make_shared<const common::MappedFile>(path);
        document_ =
            mesh_format::parse(file_->bytes(), path.string(), mesh_format::Payloads::unchecked);
    } catch (const std::runtime_error&) {
        return;  // nothing there, or another version, or damaged
    }
    // Only textures are asked for.
    for (const auto part : {document_.vertices, std::as_bytes(document_.indices),
                            document_.encoded_vertices, document_.encoded_indices})
        common::forget_mapped(part);
    checked_ = std::vector<Checked>(document_.textures.size());
    for (const mesh_format::SourceRecord& source : document_.sources) {
        sources_.emplace(SourceKey{source.key[0], source.key[1]}, &source);
    }
}

std::optional<Texture> EarlierBake::texture(std::uint32_t index, const std::string& name) const {
    const mesh_format::TextureRecord& record = document_.textures[index];
    const std::span<const std::byte> payload = document_.payload(record);
    std::call_once(checked_[index].once, [&] {
        checked_[index].is_whole = mesh_format::checksum(payload) == record.checksum;
    });
    if (!checked_[index].is_whole) return std::nullopt;
    return Texture{.name = name,
                   .format = record.format,
                   .flags = record.flags,
                   .width = record.width,
                   .height = record.height,
                   .psnr = record.psnr,
                   .earlier_payload = payload,
                   .checksum = record.checksum};
}

std::optional<ImageResult> EarlierBake::find(const SourceKey& key,
                                             const ImageRequest& request) const {
    const auto known = sources_.find(key);
    if (known == sources_.end()) return std::nullopt;
    const mesh_format::SourceRecord& source = *known->second;
    ImageResult result;
    result.holds_factor = (source.flags & mesh_format::kHoldsFactor) != 0;
    if (source.texture != mesh_format::kNoTexture) {
        result.texture = texture(source.texture, texture_name(request));
        if (!result.texture) return std::nullopt;
    }
    if (source.alpha_mask != mesh_format::kNoTexture) {
        result.alpha_mask = texture(source.alpha_mask, mask_name(request));
        if (!result.alpha_mask) return std::nullopt;
    }
    return result;
}

}  // namespace bake
