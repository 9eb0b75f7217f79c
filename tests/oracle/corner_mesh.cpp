#include "tests/oracle/corner_mesh.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <map>
#include <numeric>
#include <random>
#include <stdexcept>
#include <unordered_map>

#include "cw2-bake/tangents.h"

namespace oracle {
namespace {

using Key = std::array<float, 8>;

struct KeyHash {
    std::size_t operator()(const Key& key) const {
        std::size_t hash = 0;
        for (const float x : key) hash = hash * 1'000'003 + std::hash<float>{}(x);
        return hash;
    }
};

}  // namespace

IndexedMesh weld(const CornerMesh& mesh) {
    IndexedMesh welded;
    std::unordered_map<Key, std::uint32_t, KeyHash> vertex_of;
    for (std::size_t c = 0; c < mesh.positions.size(); ++c) {
        const glm::vec3& p = mesh.positions[c];
        const glm::vec3& n = mesh.normals[c];
        const glm::vec2& uv = mesh.uvs[c];
        const auto [found, added] =
            vertex_of.try_emplace(Key{p.x, p.y, p.z, n.x, n.y, n.z, uv.x, uv.y},
                                  static_cast<std::uint32_t>(welded.positions.size()));
        if (added) {
            welded.positions.push_back(p);
            welded.normals.push_back(n);
            welded.uvs.push_back(uv);
        }
        welded.indices.push_back(found->second);
    }
    return welded;
}

IndexedMesh renumber(const IndexedMesh& mesh, std::uint32_t seed) {
    std::vector<std::uint32_t> new_number(mesh.positions.size());
    std::iota(new_number.begin(), new_number.end(), 0u);
    std::shuffle(new_number.begin(), new_number.end(), std::mt19937(seed));
    IndexedMesh renumbered = mesh;
    for (std::size_t v = 0; v < new_number.size(); ++v) {
        renumbered.positions[new_number[v]] = mesh.positions[v];
        renumbered.normals[new_number[v]] = mesh.normals[v];
        renumbered.uvs[new_number[v]] = mesh.uvs[v];
    }
    for (std::uint32_t& index : renumbered.indices) index = new_number[index];
    return renumbered;
}

std::vector<glm::vec4> our_tangents(const IndexedMesh& mesh) {
    return bake::generate_tangents(mesh.positions, mesh.normals, mesh.uvs, mesh.indices);
}

std::vector<CornerMesh> read_obj_by_material(const std::filesystem::path& path) {
    std::ifstream file(path);
    std::vector<glm::vec3> positions;
    std::vector<glm::vec3> normals;
    std::vector<glm::vec2> uvs;
    std::map<std::string, CornerMesh> meshes;
    CornerMesh* mesh = nullptr;
    std::string line;
    while (std::getline(file, line)) {
        std::array<double, 9> numbers{};
        std::size_t count = 0;
        const std::size_t space = line.find(' ');
        const std::string word = line.substr(0, space);
        if (word == "usemtl") {
            mesh = &meshes[line.substr(space + 1)];
            mesh->name = line.substr(space + 1);
            continue;
        }
        if (word != "v" && word != "vt" && word != "vn" && word != "f") continue;
        const char* at = line.data() + space;
        const char* const end = line.data() + line.size();
        while (at != end && count < numbers.size()) {
            const auto [next, error] = std::from_chars(at + 1, end, numbers[count++]);
            if (error != std::errc{}) throw std::runtime_error("not understood: " + line);
            at = next;
        }
        const std::size_t expected = word == "f" ? 9 : word == "vt" ? 2 : 3;
        if (at != end || count != expected) throw std::runtime_error("not understood: " + line);
        if (word == "v") positions.emplace_back(numbers[0], numbers[1], numbers[2]);
        if (word == "vn") normals.emplace_back(numbers[0], numbers[1], numbers[2]);
        if (word == "vt") uvs.emplace_back(numbers[0], numbers[1]);
        if (word != "f") continue;
        if (mesh == nullptr) throw std::runtime_error("face before usemtl: " + line);
        for (std::size_t corner = 0; corner < 9; corner += 3) {
            mesh->positions.push_back(positions.at(std::size_t(numbers[corner]) - 1));
            mesh->uvs.push_back(uvs.at(std::size_t(numbers[corner + 1]) - 1));
            mesh->normals.push_back(normals.at(std::size_t(numbers[corner + 2]) - 1));
        }
    }
    std::vector<CornerMesh> result;
    for (auto& [name, of_material] : meshes) result.push_back(std::move(of_material));
    return result;
}

}  // namespace oracle
