#include "cw2-bake/framed_mesh.h"

#include "cw2-bake/tangents.h"
#include "mesh-format/layout.h"

namespace bake {

namespace {

constexpr std::uint32_t kNone = 0xFFFF'FFFF;

}  // namespace

FramedMesh add_tangents(const WeldedMesh& mesh) {
    const std::vector<glm::vec4> corner_tangents =
        generate_tangents(mesh.positions, mesh.normals, mesh.uvs, mesh.indices);

    FramedMesh framed;
    framed.material = mesh.material;
    framed.indices.reserve(mesh.indices.size());
    // The framed vertices made of one welded vertex form a list: few have more than one.
    std::vector<std::uint32_t> first(mesh.positions.size(), kNone);
    std::vector<std::uint32_t> next;
    for (std::size_t corner = 0; corner < mesh.indices.size(); ++corner) {
        const std::uint32_t source = mesh.indices[corner];
        const glm::vec4& tangent = corner_tangents[corner];
        std::uint32_t* link = &first[source];
        while (*link != kNone && framed.tangents[*link] != tangent) link = &next[*link];
        if (*link == kNone) {
            *link = static_cast<std::uint32_t>(framed.positions.size());
            framed.positions.push_back(mesh.positions[source]);
            framed.normals.push_back(mesh.normals[source]);
            framed.uvs.push_back(mesh.uvs[source]);
            framed.tangents.push_back(tangent);
            framed.indices.push_back(*link);
            next.push_back(kNone);  // may move what `link` points to: the last use of it is above
        } else {
            framed.indices.push_back(*link);
        }
    }
    return framed;
}

std::vector<FramedMesh> partition(FramedMesh mesh) {
    std::vector<FramedMesh> pieces;
    if (mesh.positions.size() <= mesh_format::kMaxMeshVertices) {
        pieces.push_back(std::move(mesh));
        return pieces;
    }
    std::vector<std::uint32_t> piece_index(mesh.positions.size(), kNone);
    std::vector<std::uint32_t> piece_vertices;  // the mesh's vertices in the last piece
    for (std::size_t at = 0; at < mesh.indices.size(); at += 3) {
        if (pieces.empty() || piece_vertices.size() + 3 > mesh_format::kMaxMeshVertices) {
            for (const std::uint32_t vertex : piece_vertices) piece_index[vertex] = kNone;
            piece_vertices.clear();
            pieces.emplace_back().material = mesh.material;
        }
        FramedMesh& piece = pieces.back();
        for (std::size_t corner = at; corner < at + 3; ++corner) {
            const std::uint32_t vertex = mesh.indices[corner];
            if (piece_index[vertex] == kNone) {
                piece_index[vertex] = static_cast<std::uint32_t>(piece_vertices.size());
                piece_vertices.push_back(vertex);
                piece.positions.push_back(mesh.positions[vertex]);
                piece.normals.push_back(mesh.normals[vertex]);
                piece.uvs.push_back(mesh.uvs[vertex]);
                piece.tangents.push_back(mesh.tangents[vertex]);
            }
            piece.indices.push_back(piece_index[vertex]);
        }
    }
    return pieces;
}

}  // namespace bake
