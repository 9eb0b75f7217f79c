#include "cw2-bake/geometry/compress.h"

#include <tbb/parallel_for.h>
#include <zstd.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <memory>
#include <new>
#include <span>
#include <utility>

#include "mesh-format/index_stream.h"
#include "mesh-format/vertex_stream.h"

namespace bake {

namespace {

using mesh_format::MeshRecord;
using Bytes = std::vector<std::byte>;

/// What Zstandard does with literals, the bytes that it does not find before: it is a parameter of
/// its own since version 1.3.8, but not yet called a stable one.
constexpr ZSTD_cParameter kLiterals = ZSTD_c_experimentalParam5;
enum Literals : int { as_level_says, in_huffman_codes, as_they_are };

class Compressor {
 public:
    Compressor(int level, Literals literals) : context_(ZSTD_createCCtx(), &ZSTD_freeCCtx) {
        if (!context_) throw std::bad_alloc();
        ZSTD_CCtx_setParameter(context_.get(), ZSTD_c_compressionLevel, level);
        ZSTD_CCtx_setParameter(context_.get(), kLiterals, literals);
        // Shorter ones are chance in planes of differences: they cost more than they save, here and
        // when they are decoded.
        if (literals == as_level_says) ZSTD_CCtx_setParameter(context_.get(), ZSTD_c_minMatch, 6);
    }

    /// A Zstandard frame.
    Bytes frame(std::span<const std::byte> bytes) {
        Bytes result(ZSTD_compressBound(bytes.size()));
        const std::size_t size = ZSTD_compress2(context_.get(), result.data(), result.size(),
                                                bytes.data(), bytes.size());
        if (ZSTD_isError(size)) throw std::bad_alloc();  // it has no other cause here
        result.resize(size);
        return result;
    }

 private:
    std::unique_ptr<ZSTD_CCtx, decltype(&ZSTD_freeCCtx)> context_;
};

/// Streams as Zstandard frames, plane by plane: planes differ in what serves them. What is decoded
/// fastest is taken unless another takes a part fewer bytes.
class Packer {
 public:
    /// The first `first` bytes of the stream and each `next` after them are planes.
    Bytes pack(std::span<const std::byte> stream, std::size_t first, std::size_t next) {
        constexpr std::size_t kSmall = 4096;  // then frames' heads would be much of it
        if (stream.size() <= kSmall) return plane(stream);
        Bytes frames;
        for (std::size_t size = first; !stream.empty(); size = next) {
            const Bytes frame = plane(stream.first(size));
            frames.insert(frames.end(), frame.begin(), frame.end());
            stream = stream.subspan(size);
        }
        return frames;
    }

 private:
    /// Codes take 0.4 to 0.7 ns a byte to decode, the same with matches up to twice as much, copies
    /// next to nothing.
    Bytes plane(std::span<const std::byte> bytes) {
        Bytes best = codes_.frame(bytes);
        Bytes matched = matches_.frame(bytes);
        if (matched.size() < best.size() - best.size() / 10) best = std::move(matched);
        if (best.size() > bytes.size() - bytes.size() / 20) best = copies_.frame(bytes);
        return best;
    }

    // Measured on a scene of 262 k triangles: level 15 is 2 % smaller and takes 5 times as long.
    Compressor matches_{9, as_level_says};
    // Levels below 0 hardly look for matches.
    Compressor codes_{-1000, in_huffman_codes};
    Compressor copies_{-1000, as_they_are};
};

/// A mesh's parts of the two sections.
struct Parts {
    Bytes vertices;
    Bytes indices;
};

Parts encode(const PackedGeometry& geometry, const MeshRecord& mesh) {
    const auto plain = geometry.indices.subspan(mesh.first_index, mesh.index_count);
    std::vector<std::uint16_t> indices(plain.begin(), plain.end());
    std::vector<mesh_format::Neighbours> neighbours(mesh.vertex_count);
    const Bytes index_stream = mesh_format::encode_indices(indices, neighbours);
    const Bytes vertex_stream = mesh_format::encode_vertices(
        mesh, indices, neighbours, geometry.vertices.data() + mesh.vertex_offset);
    const std::size_t codes = mesh.index_count / 3;
    const std::size_t numbers = (index_stream.size() - codes) / 2;
    // The first plane goes with what is before it.
    const std::size_t first = mesh_format::kVertexStreamHead + mesh.vertex_count;
    Packer packer;
    return {packer.pack(vertex_stream, first, mesh.vertex_count),
            packer.pack(index_stream, codes, numbers)};
}

/// The sizes of the parts, then the parts.
Bytes concatenate(std::span<Bytes> parts) {
    std::size_t all = parts.size() * sizeof(std::uint32_t);
    for (const Bytes& part : parts) all += part.size();
    Bytes section;
    section.reserve(all);
    section.resize(parts.size() * sizeof(std::uint32_t));
    for (std::size_t i = 0; i < parts.size(); ++i) {
        const auto size = static_cast<std::uint32_t>(parts[i].size());
        std::memcpy(section.data() + i * sizeof size, &size, sizeof size);
    }
    for (Bytes& part : parts) {
        section.insert(section.end(), part.begin(), part.end());
        part = {};
    }
    return section;
}

}  // namespace

EncodedGeometry compress(const PackedGeometry& geometry, const Advance& advance) {
    std::vector<Bytes> vertices(geometry.meshes.size());
    std::vector<Bytes> indices(geometry.meshes.size());
    tbb::parallel_for(std::size_t{0}, geometry.meshes.size(), [&](std::size_t i) {
        Parts parts = encode(geometry, geometry.meshes[i]);
        vertices[i] = std::move(parts.vertices);
        indices[i] = std::move(parts.indices);
        advance(1.0 / static_cast<double>(geometry.meshes.size()));
    });
    return {concatenate(vertices), concatenate(indices)};
}

}  // namespace bake
