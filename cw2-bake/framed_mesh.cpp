#include "cw2-bake/framed_mesh.h"

#include <algorithm>

#include "cw2-bake/tangents.h"

namespace bake {

namespace {

constexpr std::uint32_t kNone = 0xFFFF'FFFF;

/// One a corner: the source's, and those of MikkTSpace where it gives none.
std::vector<glm::vec4> tangents_of(const WeldedMesh& mesh) {
    const auto is_given = [](const glm::vec4& tangent) { return tangent.w != 0.0f; };
    const bool complete = !mesh.tangents.empty() && std::ranges::all_of(mesh.tangents, is_given);
    if (complete) return mesh.tangents;
    std::vector<glm::vec4> tangents =
        generate_tangents(mesh.positions, mesh.normals, mesh.uvs, mesh.indices);
    for (std::size_t i = 0; i < mesh.tangents.size(); ++i) {
        if (is_given(mesh.tangents[i])) tangents[i] = mesh.tangents[i];
    }
    return tangents;
}

}  // namespace

FramedMesh add_tangents(WeldedMesh mesh) {
    const std::vector<glm::vec4> corner_tangents = tangents_of(mesh);

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
            framed.uvs.emplace_back(mesh.uvs[source].x, 1.0f - mesh.uvs[source].y);
            framed.tangents.push_back(tangent);
            framed.indices.push_back(*link);
            next.push_back(kNone);  // may move what `link` points to: the last use of it is above
        } else {
            framed.indices.push_back(*link);
        }
    }
    return framed;
}

}  // namespace bake
