#include "cw2/render/vertex_positions.h"

#include <tbb/parallel_for.h>

#include <cstring>
#include <glm/gtc/type_precision.hpp>
#include <glm/gtc/type_ptr.hpp>

namespace cw2 {

namespace {

using mesh_format::MeshRecord;

template <typename Words>
Words words_at(const std::byte* bytes) {
    Words words;
    std::memcpy(&words, bytes, sizeof words);
    return words;
}

}  // namespace

std::vector<glm::vec3> vertex_positions(const mesh_format::Document& document) {
    std::vector<std::size_t> first;
    std::size_t count = 0;
    for (const MeshRecord& mesh : document.meshes) {
        first.push_back(count);
        count += mesh.vertex_count;
    }
    std::vector<glm::vec3> positions(count);
    tbb::parallel_for(std::size_t{0}, document.meshes.size(), [&](std::size_t index) {
        const MeshRecord& mesh = document.meshes[index];
        const std::uint32_t stride = mesh_format::vertex_layout(mesh.forms).stride;
        const std::byte* vertex = document.vertices.data() + mesh.vertex_offset;
        const glm::ivec3 origin = glm::make_vec3(mesh.origin);
        for (std::size_t i = first[index]; i < first[index] + mesh.vertex_count; ++i) {
            positions[i] = mesh.forms.position == mesh_format::PositionForm::quantised
                               ? glm::vec3(origin + glm::ivec3(words_at<glm::u16vec3>(vertex))) *
                                     document.scene.position_step
                               : words_at<glm::vec3>(vertex);
            vertex += stride;
        }
    });
    return positions;
}

}  // namespace cw2
