// Bytes to a checked document, and a document to bytes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <stdexcept>
#include <string_view>

#include "mesh-format/layout.h"

namespace mesh_format {

/// Bytes that are no file of this format; what() is one line "NAME: what is wrong".
class FormatError : public std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// The contents of a file. The spans point into memory that someone else keeps.
struct Document {
    SceneRecord scene{};
    std::span<const MeshRecord> meshes;
    std::span<const ChunkRecord> chunks;
    std::span<const MaterialRecord> materials;
    std::span<const TextureRecord> textures;
    std::span<const SourceRecord> sources;
    std::string_view strings;
    std::span<const std::byte> vertices;
    std::span<const std::uint16_t> indices;
    std::span<const std::byte> texels;  ///< of a file that was read
    /// Of a compressed file; then vertices and indices are empty until somebody decodes these.
    std::span<const std::byte> encoded_vertices;
    std::span<const std::byte> encoded_indices;

    bool is_encoded() const { return !encoded_vertices.empty(); }

    /// The text that `ref` names.
    std::string_view text(StringRef ref) const { return strings.substr(ref.offset, ref.length); }
    /// The payload of a texture of a file that was read.
    std::span<const std::byte> payload(const TextureRecord& texture) const {
        return texels.subspan(texture.offset, texture.size);
    }
};

/// Throws FormatError, which calls the document `name`, unless everything in it is in order: every
/// offset, every index, every 32-bit float finite. The vertices and indices of an encoded document
/// can only be checked once they are decoded.
void check(const Document& document, std::string_view name);

/// Whether parse() compares the payloads of textures with their checksums.
enum class Payloads {
    checked,
    unchecked,  ///< by who uses one
};

/// Throws FormatError unless the payload of the texture has its checksum.
void check_payload(const Document& document, std::size_t texture, std::string_view name);

/// Checks `bytes` completely and returns the document in it: magic, version, sizes, checksums, and
/// what check() asks. `bytes` starts at a multiple of 16 and must outlive the document; `name` is
/// used in messages. Throws FormatError; never reads outside `bytes`, allocates nothing that grows
/// with the input.
Document parse(std::span<const std::byte> bytes, std::string_view name,
               Payloads payloads = Payloads::checked);

/// Takes the next bytes of a file.
using Sink = std::function<void(std::span<const std::byte>)>;

/// Throws FormatError, which calls the document `name`, unless `document` passes check(), then
/// gives the file's bytes to `sink`, from the first to the last. `payloads` are those of its
/// textures, one each, and take the place of Document::texels; their checksums are in the records.
/// The same document gives the same bytes. Returns the file's size in bytes.
std::uint64_t write(const Document& document, std::span<const std::span<const std::byte>> payloads,
                    std::string_view name, const Sink& sink);

/// Detects altered bytes, no defence against intent: 64-bit words, little-endian and the last one
/// zero-padded, are folded into four lanes (word i into lane i mod 4) by
/// lane = (lane xor word) * 0x9E3779B97F4A7C15, rotated left by 29; the lanes, each started with
/// its number, and the length are folded the same way into one. Every step is a bijection of the
/// lane, so a change of any one word always changes the result.
std::uint64_t checksum(std::span<const std::byte> bytes);

}  // namespace mesh_format
