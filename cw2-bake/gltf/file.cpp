#include "cw2-bake/gltf/file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <iterator>
#include <map>
#include <optional>
#include <string_view>
#include <tuple>
#include <utility>

#include "common/file_kind.h"
#include "cw2-bake/base/file_finder.h"
#include "cw2-bake/base/text_lines.h"
#include "cw2-bake/gltf/json.h"
#include "cw2-bake/gltf/unread.h"

namespace bake {
namespace {

using Bytes = std::span<const std::byte>;
using nlohmann::json;

/// The chunks of a .glb, or a .gltf as it is. The spans point into the file.
struct GltfChunks {
    std::string_view json;
    Bytes binary;  ///< of a .glb; empty if it has none
};

std::uint32_t word(Bytes bytes, std::size_t offset) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + offset, sizeof value);
    return value;
}

/// Tells the two apart by their first bytes. Throws BakeError for a .glb that is cut short or
/// whose chunks do not fit into it.
GltfChunks split_gltf(Bytes file, const std::filesystem::path& path) {
    const auto fail = [&](const std::string& what) -> void {
        throw BakeError(path.string() + ": " + what);
    };
    const auto text = [](Bytes bytes) {
        return std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    };
    if (!text(file).starts_with("glTF")) return {without_bom(text(file)), {}};
    constexpr std::uint32_t kJson = 0x4E4F'534A;
    constexpr std::uint32_t kBinary = 0x004E'4942;
    constexpr std::size_t kHeaderBytes = 12, kChunkHeaderBytes = 8;
    if (file.size() < kHeaderBytes) fail("is truncated: the header is incomplete");
    if (word(file, 4) != 2) fail(fmt::format("is glTF binary {}, not 2", word(file, 4)));
    if (word(file, 8) > file.size())
        fail(fmt::format("is truncated: {} of {} bytes", file.size(), word(file, 8)));
    Bytes rest = file.first(word(file, 8));
    if (rest.size() < kHeaderBytes) fail("says that it is shorter than its header");
    rest = rest.subspan(kHeaderBytes);

    GltfChunks chunks;
    for (int number = 0; !rest.empty(); ++number) {
        if (rest.size() < kChunkHeaderBytes || word(rest, 0) > rest.size() - kChunkHeaderBytes) {
            fail(fmt::format("chunk {} reaches past the end", number));
        }
        const Bytes contents = rest.subspan(kChunkHeaderBytes, word(rest, 0));
        if ((number == 0) != (word(rest, 4) == kJson)) fail("its first chunk alone must be JSON");
        if (number == 0) chunks.json = text(contents);
        if (number == 1 && word(rest, 4) == kBinary) chunks.binary = contents;
        rest = rest.subspan(kChunkHeaderBytes + contents.size());
    }
    return chunks;
}

/// The value of a digit of base 64, or of base 16; -1 if it is none.
int base64_digit(char c) {
    if (c >= 'A' && c <= 'Z') return c - 'A';
    if (c >= 'a' && c <= 'z') return c - 'a' + 26;
    if (c >= '0' && c <= '9') return c - '0' + 52;
    return c == '+' ? 62 : c == '/' ? 63 : -1;
}
int hexadecimal_digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

std::optional<std::vector<std::byte>> decode_base64(std::string_view text) {
    while (text.ends_with('=')) text.remove_suffix(1);
    std::vector<std::byte> bytes;
    bytes.reserve(text.size() / 4 * 3 + 2);
    std::uint32_t bits = 0;
    int count = 0;
    for (const char c : text) {
        const int digit = base64_digit(c);
        if (digit < 0) return std::nullopt;
        bits = bits << 6 | static_cast<std::uint32_t>(digit);
        count += 6;
        if (count < 8) continue;
        count -= 8;
        bytes.push_back(static_cast<std::byte>(bits >> count & 0xFF));
    }
    return bytes;
}

/// RFC 3986: %XX is a byte, all else stands for itself.
std::optional<std::string> decode_percent(std::string_view text) {
    std::string decoded;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text[i] != '%') {
            decoded += text[i];
            continue;
        }
        const int high = i + 2 < text.size() ? hexadecimal_digit(text[i + 1]) : -1;
        const int low = i + 2 < text.size() ? hexadecimal_digit(text[i + 2]) : -1;
        if (high < 0 || low < 0 || high + low == 0) return std::nullopt;
        decoded += static_cast<char>(high * 16 + low);
        i += 2;
    }
    return decoded;
}

bool is_data(std::string_view uri) {
    return uri.starts_with("data:");
}

/// Throws what is wrong with it as BakeError.
std::vector<std::byte> decode_data(std::string_view uri) {
    const std::size_t comma = uri.find(',');
    if (comma == uri.npos || !uri.substr(0, comma).ends_with(";base64"))
        throw BakeError("is a data URI, but not in base 64");
    auto bytes = decode_base64(uri.substr(comma + 1));
    if (!bytes) throw BakeError("is a data URI with malformed base 64");
    return std::move(*bytes);
}

/// The note is for a warning as it is. Throws what is wrong with the URI as BakeError.
FoundFile resolve(FileFinder& finder, const std::filesystem::path& gltf, std::string_view uri) {
    const auto decoded = decode_percent(uri);
    std::vector<std::string> readings = readings_of(decoded ? *decoded : uri);
    if (decoded) std::ranges::copy(readings_of(uri), std::back_inserter(readings));
    const std::size_t colon = uri.find(':');
    const bool has_scheme = colon != uri.npos && uri.find('/') > colon;
    const bool elsewhere = has_scheme || readings.front().starts_with('/');
    // What has its place elsewhere may lie here all the same.
    if (elsewhere)
        for (std::string& name : readings) name.erase(0, name.rfind('/') + 1);
    const bool is_name = std::ranges::none_of(readings, [](const std::string& name) {
        return name.empty() || name.find('\0') != name.npos;
    });
    FoundFile found = is_name ? finder.find(gltf.parent_path(), readings) : FoundFile{};
    if (found.is_outside)
        throw BakeError(fmt::format("{} is outside the scene's folder", in_quotes(uri)));
    if (!is_name || ((elsewhere || !decoded) && !found.exists))
        throw BakeError(fmt::format("{} is no relative path", in_quotes(uri)));
    if (found.exists && (elsewhere || uri.find('\\') != uri.npos))
        found.note = found.file.string() + " is taken";
    if (!found.note.empty())
        found.note = fmt::format("{}: no such file; {}", in_quotes(uri), found.note);
    return found;
}

class Loader {
 public:
    Loader(GltfFile& file, json& root, Bytes binary, const Warn& warn,
           const std::filesystem::path& folder)
        : file_(file), root_(root), binary_(binary), warn_(warn), finder_(folder) {}

    void load_buffers() {
        for (std::size_t i = 0; i < array("buffers").size(); ++i) {
            const std::string pointer = fmt::format("/buffers/{}", i);
            const json& buffer = array("buffers")[i];
            const auto length = buffer["byteLength"].get<std::size_t>();
            try {
                if (is_fallback(buffer)) {
                    file_.buffers.emplace_back();
                    continue;
                }
                const Bytes bytes = buffer_bytes(buffer, i);
                if (bytes.size() < length) {
                    throw BakeError(fmt::format("holds {} bytes of {}", bytes.size(), length));
                }
                file_.buffers.push_back(bytes.first(length));
            } catch (const BakeError& error) {
                fail_at(file_.path, pointer, error.what());
            } catch (const common::FileError& error) {
                fail_at(file_.path, pointer, error.what());
            }
        }
    }

    void find_images() {
        for (std::size_t i = 0; i < array("images").size(); ++i) {
            GltfImage& image = file_.images.emplace_back();
            try {
                find_image(array("images")[i], i, image);
            } catch (const BakeError& error) {
                image.file = unique_name(array("images")[i], i);
                image.problem = error.what();
            }
        }
    }

    /// What tinygltf must not see. It also asks that indices have a buffer view, unlike glTF: those
    /// without one get one beyond all others; and that spot lights have a cone, which is not used.
    void prepare_for_tinygltf() {
        for (const char* name : {"animations", "buffers", "images"}) root_.erase(name);
        const json::json_pointer lights("/extensions/KHR_lights_punctual/lights");
        if (root_.contains(lights)) {
            for (json& light : root_[lights])
                if (light["type"] == "spot") light["spot"] = json::object();
        }
        const std::size_t beyond = array("bufferViews").size();
        bool any = false;
        for (const json& mesh : array("meshes")) {
            for (const json& primitive : mesh["primitives"]) {
                const auto indices = primitive.find("indices");
                if (indices == primitive.end()) continue;
                any |= array("accessors")[indices->get<std::size_t>()]
                           .emplace("bufferView", beyond)
                           .second;
            }
        }
        if (any) root_["bufferViews"].push_back({{"buffer", 0}, {"byteLength", 1}});
    }

 private:
    json& array(const char* name) {
        static json none = json::array();
        const auto found = root_.find(name);
        return found == root_.end() ? none : *found;
    }

    /// What readers without EXT_meshopt_compression would take.
    static bool is_fallback(const json& buffer) {
        const json::json_pointer extension("/extensions/EXT_meshopt_compression");
        return buffer.contains(extension) &&
               (buffer[extension].value("fallback", false) || !buffer.contains("uri"));
    }

    Bytes buffer_bytes(const json& buffer, std::size_t index) {
        const auto uri = buffer.find("uri");
        if (uri == buffer.end()) {
            if (index > 0 || binary_.empty()) throw BakeError("has no contents");
            return binary_;
        }
        const auto& text = uri->get_ref<const std::string&>();
        if (is_data(text)) return file_.decoded.emplace_back(decode_data(text));
        const FoundFile found = resolve(finder_, file_.path, text);
        if (!found.exists && !found.note.empty()) throw BakeError(found.note);
        if (!found.note.empty())
            warn_(fmt::format("{}: /buffers/{}: {}", file_.path.string(), index, found.note));
        const auto [known, fresh] = mapped_.try_emplace(found.file);
        if (fresh) {
            known->second = file_.mapped.emplace_back(found.file).bytes();
            file_.buffer_files.push_back(found.file);
        }
        return known->second;
    }

    std::filesystem::path unique_name(const json& image, std::size_t index) const {
        std::string name = image.value("name", "");
        if (name.empty()) name = fmt::format("image{}", index);
        std::ranges::replace(name, '/', '_');
        return file_.path / "images" / std::to_string(index) / name;
    }

    void find_image(const json& image, std::size_t index, GltfImage& found) {
        const auto uri = image.find("uri");
        const auto view = image.find("bufferView");
        if ((uri == image.end()) == (view == image.end()))
            throw BakeError("needs either a uri or a bufferView");
        if (view != image.end()) {
            const Bytes bytes = view_bytes(array("bufferViews")[view->get<std::size_t>()]);
            const auto [known, fresh] = shared_.try_emplace({bytes.data(), bytes.size()});
            if (fresh) {
                embedded_bytes_ += bytes.size();
                if (embedded_bytes_ > file_.size)
                    throw BakeError("its bytes belong to other images, too");
                known->second = {
                    unique_name(image, index),
                    std::make_shared<std::vector<std::byte>>(bytes.begin(), bytes.end())};
            }
            std::tie(found.file, found.embedded) = known->second;
        } else if (is_data(uri->get_ref<const std::string&>())) {
            found.embedded = std::make_shared<std::vector<std::byte>>(
                decode_data(uri->get_ref<const std::string&>()));
        } else {
            const FoundFile named =
                resolve(finder_, file_.path, uri->get_ref<const std::string&>());
            found.file = named.file;
            found.note = named.note;
        }
        if (found.embedded && found.file.empty()) found.file = unique_name(image, index);
        if (is_ktx2(image, found)) throw BakeError("is a KTX2 texture, which is not read");
    }

    static bool is_ktx2(const json& image, const GltfImage& found) {
        if (image.value("mimeType", "") == "image/ktx2") return true;
        if (!found.embedded) return common::lower_extension(found.file) == ".ktx2";
        constexpr std::string_view kMagic = "\xABKTX 20\xBB";
        return found.embedded->size() >= kMagic.size() &&
               std::memcmp(found.embedded->data(), kMagic.data(), kMagic.size()) == 0;
    }

    Bytes view_bytes(const json& view) const {
        const Bytes buffer = file_.buffers[view["buffer"].get<std::size_t>()];
        const auto offset = view.value("byteOffset", std::size_t{0});
        const auto length = view["byteLength"].get<std::size_t>();
        if (offset > buffer.size() || length > buffer.size() - offset)
            throw BakeError("its buffer view reaches past its buffer");
        return buffer.subspan(offset, length);
    }

    GltfFile& file_;
    json& root_;
    Bytes binary_;
    const Warn& warn_;
    FileFinder finder_;
    std::map<std::filesystem::path, Bytes> mapped_;
    /// By their bytes: images may share these, and are then one.
    std::map<std::pair<const std::byte*, std::size_t>,
             std::pair<std::filesystem::path, decltype(GltfImage::embedded)>>
        shared_;
    std::size_t embedded_bytes_ = 0;  // of those
};

}  // namespace

Bytes GltfFile::view_bytes(int index) const {
    const auto& view = model.bufferViews[static_cast<std::size_t>(index)];
    const Bytes buffer = buffers[static_cast<std::size_t>(view.buffer)];
    if (view.byteOffset > buffer.size() || view.byteLength > buffer.size() - view.byteOffset)
        fail_at(path, fmt::format("/bufferViews/{}", index), "reaches past its buffer");
    return buffer.subspan(view.byteOffset, view.byteLength);
}

GltfFile load_gltf(const std::filesystem::path& path, const Warn& warn,
                   const std::filesystem::path& root) {
    GltfFile file;
    file.path = path;
    Bytes bytes;
    try {
        bytes = file.mapped.emplace_back(path).bytes();
    } catch (const common::FileError& error) {
        throw BakeError(error.what());
    }
    const GltfChunks chunks = split_gltf(bytes, path);
    json json_root = parse_gltf_json(chunks.json, path);
    Loader loader(file, json_root, chunks.binary, warn, root);
    loader.load_buffers();
    for (const auto& part : file.mapped) file.size += part.bytes().size();
    for (const auto& part : file.decoded) file.size += part.size();
    loader.find_images();
    file.unread = find_unread(json_root);
    const auto views = json_root.find("bufferViews");
    const std::size_t view_count = views == json_root.end() ? 0 : views->size();
    loader.prepare_for_tinygltf();

    const std::string text = json_root.dump(-1, ' ', false, json::error_handler_t::replace);
    std::string error, warning;
    tinygltf::TinyGLTF parser;
    if (!parser.LoadASCIIFromString(&file.model, &error, &warning, text.data(),
                                    static_cast<unsigned>(text.size()), "", tinygltf::NO_REQUIRE)) {
        std::ranges::replace(error, '\n', ' ');
        throw BakeError(fmt::format("{}: {}", path.string(), trimmed(error)));
    }
    // The view that indices without one were given.
    file.model.bufferViews.resize(view_count);
    for (auto& accessor : file.model.accessors)
        if (accessor.bufferView >= static_cast<int>(view_count)) accessor.bufferView = -1;
    return file;
}

}  // namespace bake
