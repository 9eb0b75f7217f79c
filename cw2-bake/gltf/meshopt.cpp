#include "cw2-bake/gltf/meshopt.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include <functional>
#include <span>
#include <string>

#include "cw2-bake/base/text_lines.h"
#include "cw2-bake/gltf/json.h"

namespace bake {
namespace {

/// A compressed view, as its extension describes it.
struct Stream {
    std::string mode, filter;
    std::size_t count, stride;  ///< stride in bytes
    std::span<const std::byte> bytes;

    const unsigned char* data() const {
        return reinterpret_cast<const unsigned char*>(bytes.data());
    }
};

using Fail = std::function<void(const std::string&)>;

/// `what` is said where a rule of the extension's section "Compressed bufferView" is broken.
void check(const Stream& s, const Fail& fail) {
    const bool is_attributes = s.mode == "ATTRIBUTES";
    if (is_attributes ? s.stride % 4 != 0 || s.stride < 4 || s.stride > 256
                      : s.stride != 2 && s.stride != 4)
        fail(fmt::format("its byteStride {} is none of mode {}", s.stride, s.mode));
    if (s.mode == "TRIANGLES" && s.count % 3 != 0)
        fail(fmt::format("its count {} is no multiple of 3", s.count));
    const bool fits =
        s.filter == "NONE" || (is_attributes && s.filter == "EXPONENTIAL") ||
        (is_attributes && s.filter == "QUATERNION" && s.stride == 8) ||
        (is_attributes && s.filter == "OCTAHEDRAL" && (s.stride == 4 || s.stride == 8));
    if (!fits) {
        fail(fmt::format("its filter {} is none of mode {} with byteStride {}", in_quotes(s.filter),
                         s.mode, s.stride));
    }
    // The encodings at their shortest: 2 bits for 16 bytes, a byte for a triangle or an index. A
    // small file must not claim all memory.
    const std::size_t least = is_attributes           ? s.count * s.stride / 64
                              : s.mode == "TRIANGLES" ? s.count / 3
                                                      : s.count;
    if (s.bytes.size() < least) {
        fail(fmt::format("its {} bytes are too few for {} elements", s.bytes.size(), s.count));
    }
}

/// Returns false for a damaged stream.
bool decode(const Stream& s, std::vector<std::byte>& result) {
    void* const to = result.data();
    const std::size_t size = s.bytes.size();
    if (s.mode == "ATTRIBUTES")
        return meshopt_decodeVertexBuffer(to, s.count, s.stride, s.data(), size) == 0;
    if (s.mode == "TRIANGLES")
        return meshopt_decodeIndexBuffer(to, s.count, s.stride, s.data(), size) == 0;
    return meshopt_decodeIndexSequence(to, s.count, s.stride, s.data(), size) == 0;
}

void undo_filter(const Stream& s, std::vector<std::byte>& result) {
    const auto undo = s.filter == "OCTAHEDRAL"    ? meshopt_decodeFilterOct
                      : s.filter == "QUATERNION"  ? meshopt_decodeFilterQuat
                      : s.filter == "EXPONENTIAL" ? meshopt_decodeFilterExp
                                                  : nullptr;
    if (undo) undo(result.data(), s.count, s.stride);
}

}  // namespace

std::vector<std::byte> decode_meshopt(const GltfFile& file, std::size_t view) {
    const auto& extension = file.model.bufferViews[view].extensions.at(kMeshoptExtension);
    const Fail fail = [&](const std::string& what) {
        fail_at(file.path, fmt::format("/bufferViews/{}/extensions/{}", view, kMeshoptExtension),
                what);
    };
    const auto number = [&](const char* name) {
        return extension.Has(name) ? static_cast<std::size_t>(extension.Get(name).GetNumberAsInt())
                                   : std::size_t{0};
    };
    Stream stream{
        .mode = extension.Get("mode").Get<std::string>(),
        .filter = extension.Has("filter") ? extension.Get("filter").Get<std::string>() : "NONE",
        .count = number("count"),
        .stride = number("byteStride"),
        .bytes = {}};
    if (stream.mode != "ATTRIBUTES" && stream.mode != "TRIANGLES" && stream.mode != "INDICES")
        fail(fmt::format("its mode {} is none", in_quotes(stream.mode)));
    const auto buffer = file.buffers[number("buffer")];
    if (number("byteOffset") > buffer.size() ||
        number("byteLength") > buffer.size() - number("byteOffset"))
        fail("reaches past its buffer");
    stream.bytes = buffer.subspan(number("byteOffset"), number("byteLength"));
    check(stream, fail);
    std::vector<std::byte> result(stream.count * stream.stride);
    if (!decode(stream, result)) fail("is damaged");
    undo_filter(stream, result);
    return result;
}

}  // namespace bake
