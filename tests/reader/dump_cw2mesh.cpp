// Prints what the library reads of a file as plain bytes, for check_reader.py: of each mesh its
// counts of vertices and indices (uint32), its vertices (12 floats: position, normal, tangent,
// handedness, UV; and the 4 bytes of the colour) and its indices (uint16); of each texture its
// levels, the largest first, in tightly packed texels.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <fstream>
#include <iterator>
#include <span>
#include <vector>

#include "mesh-format/blocks.h"
#include "mesh-format/decode.h"
#include "mesh-format/vertices.h"

namespace {

using namespace mesh_format;

template <typename T>
void print(const T& value) {
    std::fwrite(&value, sizeof value, 1, stdout);
}

void print_mesh(const Document& document, const MeshRecord& mesh) {
    print(mesh.vertex_count);
    print(mesh.index_count);
    for (std::uint32_t i = 0; i < mesh.vertex_count; ++i) {
        const Vertex vertex = unpack_vertex(document, mesh, i);
        print(vertex.position);
        print(vertex.frame.normal);
        print(vertex.frame.tangent);
        print(vertex.frame.handedness);
        print(vertex.uv);
        print(vertex.color);
    }
    for (std::uint32_t i = 0; i < mesh.index_count; ++i)
        print(document.indices[mesh.first_index + i]);
}

void print_texture(const Document& document, std::size_t i) {
    const TextureRecord& texture = document.textures[i];
    const Payload payload = decode_payload(document, i, "the file");
    const std::byte* level = payload.bytes.data();
    for (std::uint32_t k = 0; k < texture.mip_count; ++k) {
        const std::uint32_t width = mip_extent(texture.width, k);
        const std::uint32_t height = mip_extent(texture.height, k);
        if (block_extent(texture.format) == 1) {
            std::fwrite(level, block_bytes(texture.format), std::size_t{width} * height, stdout);
        } else {
            const std::size_t row =
                block_count(texture.format, width) * block_bytes(texture.format);
            std::vector<std::byte> texels(4 * width * decoded_texel_bytes(texture.format));
            for (std::uint32_t y = 0; y < height; y += 4) {
                const std::uint32_t rows = std::min(4u, height - y);
                decode_block_row(texture.format, level + y / 4 * row, width, rows, texels.data());
                std::fwrite(texels.data(), rows * texels.size() / 4, 1, stdout);
            }
        }
        level += mip_bytes(texture.format, texture.width, texture.height, k);
    }
}

}  // namespace

int main(int, char** argv) {
    std::ifstream file(argv[1], std::ios::binary);
    const std::vector<char> bytes(std::istreambuf_iterator<char>(file), {});
    try {
        Document document = parse(std::as_bytes(std::span(bytes)), argv[1]);
        const DecodedGeometry decoded = decode(document, argv[1]);
        for (const MeshRecord& mesh : document.meshes) print_mesh(document, mesh);
        for (std::size_t i = 0; i < document.textures.size(); ++i) print_texture(document, i);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
