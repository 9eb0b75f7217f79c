// The module around Draco, loaded by draco.cpp when a glTF is compressed with it: other bakes need
// not start with one library more. And its library holds a tinygltf of its own, which would take
// the place of ours if the program were linked with both.
#include "cw2-bake/gltf/draco_reader.h"

#include <draco/compression/decode.h>
#include <draco/mesh/mesh.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <stdexcept>
#include <type_traits>

namespace {

using bake::DracoAttribute;
using bake::DracoMesh;

/// Each vertex's values in the type T, as the accessor wants them.
template <typename T>
void copy_values(const draco::PointAttribute& from, std::size_t vertices, DracoAttribute& to) {
    const auto components = static_cast<std::size_t>(to.components);
    to.values.resize(vertices * components * sizeof(T));
    T value[16];
    for (std::size_t i = 0; i < vertices; ++i) {
        const draco::PointIndex point(static_cast<std::uint32_t>(i));
        if (!from.ConvertValue<T>(from.mapped_index(point), static_cast<std::int8_t>(components),
                                  value))
            throw std::runtime_error("an attribute does not fit its accessor");
        std::memcpy(to.values.data() + i * components * sizeof(T), value, components * sizeof(T));
    }
}

void copy_attribute(const draco::PointAttribute& from, std::size_t vertices, DracoAttribute& to) {
    if (from.num_components() != to.components)
        throw std::runtime_error("an attribute and its accessor differ in components");
    switch (to.component_type) {
        case 5120:
            return copy_values<std::int8_t>(from, vertices, to);
        case 5121:
            return copy_values<std::uint8_t>(from, vertices, to);
        case 5122:
            return copy_values<std::int16_t>(from, vertices, to);
        case 5123:
            return copy_values<std::uint16_t>(from, vertices, to);
        case 5125:
            return copy_values<std::uint32_t>(from, vertices, to);
        default:
            return copy_values<float>(from, vertices, to);
    }
}

/// A number of the stream: of 7 bits a byte, or before version 2 of 4 bytes.
std::uint64_t take_count(std::span<const std::byte>& data, bool packed) {
    std::uint64_t value = 0;
    for (int i = 0; i < (packed ? 9 : 4) && !data.empty(); ++i) {
        const auto byte = std::to_integer<std::uint64_t>(data.front());
        data = data.subspan(1);
        value |= packed ? (byte & 127) << 7 * i : byte << 8 * i;
        if (packed && byte < 128) break;
    }
    return value;
}

void skip(std::span<const std::byte>& data, std::uint64_t count) {
    data = data.subspan(std::min<std::uint64_t>(count, data.size()));
}

/// Names and values, and more of such with names of their own.
void skip_metadata(std::span<const std::byte>& data, int depth) {
    constexpr int kDeepest = 16;
    if (depth > kDeepest) throw std::runtime_error("its metadata is nested too deep");
    for (std::uint64_t i = take_count(data, true); i > 0 && !data.empty(); --i) {
        skip(data, 1 + std::to_integer<std::uint64_t>(data.front()));
        skip(data, take_count(data, true));
    }
    for (std::uint64_t i = take_count(data, true); i > 0 && !data.empty(); --i) {
        skip(data, 1 + std::to_integer<std::uint64_t>(data.front()));
        skip_metadata(data, depth + 1);
    }
}

/// The library takes memory for as many triangles and vertices as a stream claims to hold, before
/// it looks at what follows; and entropy codes may take no byte for a value. Real ones hold a few a
/// byte, and at most some tens. See https://google.github.io/draco/spec/, sections 3 to 5 and 7.
void check_claims(std::span<const std::byte> data) {
    constexpr std::size_t kHeaderBytes = 11;
    if (data.size() <= kHeaderBytes) return;
    const auto at = [&](std::size_t i) { return std::to_integer<int>(data[i]); };
    const int version = 256 * at(5) + at(6);
    const bool is_edgebreaker = at(8) == 1, has_metadata = version >= 0x103 && (at(10) & 0x80) != 0;
    std::span<const std::byte> rest = data.subspan(kHeaderBytes);
    if (has_metadata) {
        for (std::uint64_t i = take_count(rest, true); i > 0 && !rest.empty(); --i) {
            take_count(rest, true);  // which attribute
            skip_metadata(rest, 0);
        }
        skip_metadata(rest, 0);
    }
    if (is_edgebreaker) {
        skip(rest, 1);                                            // how it is traversed
        if (version < 0x202) take_count(rest, version >= 0x200);  // new vertices
    }
    const bool packed = version >= (is_edgebreaker ? 0x200 : 0x202);
    const std::uint64_t first = take_count(rest, packed), second = take_count(rest, packed);
    if (std::max(first, second) > (1u << 21) + std::uint64_t{64} * data.size())
        throw std::runtime_error("it claims to hold more than its bytes can");
}

void read(std::span<const std::byte> data, DracoMesh& mesh) {
    check_claims(data);
    draco::DecoderBuffer buffer;
    buffer.Init(reinterpret_cast<const char*>(data.data()), data.size());
    draco::Decoder decoder;
    auto result = decoder.DecodeMeshFromBuffer(&buffer);
    if (!result.ok()) throw std::runtime_error(result.status().error_msg_string());
    const std::unique_ptr<draco::Mesh> decoded = std::move(result).value();
    if (!decoded || decoded->num_faces() == 0) throw std::runtime_error("it holds no triangles");
    mesh.vertex_count = decoded->num_points();
    mesh.indices.reserve(std::size_t{3} * decoded->num_faces());
    for (std::uint32_t i = 0; i < decoded->num_faces(); ++i)
        for (const draco::PointIndex& point : decoded->face(draco::FaceIndex(i)))
            mesh.indices.push_back(point.value());
    for (DracoAttribute& attribute : mesh.attributes) {
        const draco::PointAttribute* const found = decoded->GetAttributeByUniqueId(attribute.id);
        if (!found) {
            throw std::runtime_error("it holds no attribute " + std::to_string(attribute.id));
        }
        copy_attribute(*found, mesh.vertex_count, attribute);
    }
}

}  // namespace

extern "C" __attribute__((visibility("default"))) bool cw2_bake_draco_reader(
    std::span<const std::byte> data, DracoMesh& mesh, std::string& error) {
    try {
        read(data, mesh);
        return true;
    } catch (const std::bad_alloc&) {
        error = "it needs more memory than there is";
    } catch (const std::exception& exception) {
        error = exception.what();
    }
    return false;
}

static_assert(std::is_same_v<decltype(cw2_bake_draco_reader), bake::DracoReader>);
