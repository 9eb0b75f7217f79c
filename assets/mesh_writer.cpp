#include "assets/mesh_writer.h"

#include <charconv>
#include <cmath>
#include <fstream>
#include <stdexcept>
#include <unordered_map>

#include "assets/noise.h"

namespace assets {
namespace {

constexpr double kStep = 1e-5;

using Key = std::array<std::int32_t, 3>;

struct KeyHash {
    std::size_t operator()(const Key& key) const {
        return hash(key[0], key[1], static_cast<std::uint32_t>(key[2]));
    }
};

class Text {
 public:
    Text& operator<<(std::string_view text) {
        text_ += text;
        return *this;
    }
    Text& operator<<(double number) {
        std::array<char, 32> buffer;
        const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(),
                                       static_cast<float>(number + 0.0));
        text_.append(buffer.data(), end.ptr);
        return *this;
    }
    Text& operator<<(std::uint32_t number) {
        text_ += std::to_string(number);
        return *this;
    }
    void save(const std::filesystem::path& path) const {
        std::ofstream file(path, std::ios::binary);
        file.write(text_.data(), static_cast<std::streamsize>(text_.size()));
        file.close();
        if (!file) throw std::runtime_error(path.string() + ": cannot be written");
    }

 private:
    std::string text_;
};

/// One of the attribute lists of an OBJ: writes each value once and knows its 1-based index.
class Attribute {
 public:
    Attribute(std::string_view keyword, int components)
        : keyword_(keyword), components_(components) {}

    std::uint32_t index_of(glm::vec3 value, Text& text) {
        Key key{};
        for (int i = 0; i < components_; ++i) {
            if (!std::isfinite(value[i])) throw std::logic_error("a vertex is not finite");
            key[static_cast<std::size_t>(i)] =
                static_cast<std::int32_t>(std::lround(value[i] / kStep));
        }
        const auto next = static_cast<std::uint32_t>(indices_.size() + 1);
        const auto [found, added] = indices_.try_emplace(key, next);
        if (added) {
            text << keyword_;
            for (int i = 0; i < components_; ++i) {
                text << " " << key[static_cast<std::size_t>(i)] * kStep;
            }
            text << "\n";
        }
        return found->second;
    }

 private:
    std::string_view keyword_;
    int components_;
    std::unordered_map<Key, std::uint32_t, KeyHash> indices_;
};

}  // namespace

void write_obj(const std::filesystem::path& path, const std::string& mtl_name, const Model& model) {
    Attribute positions("v", 3);
    Attribute uvs("vt", 2);
    Attribute normals("vn", 3);
    Text text;
    text << "# The courtyard of cw2's demo. Metres, right-handed, +Y up.\nmtllib " << mtl_name
         << "\n";
    for (const Part& part : model.parts()) {
        std::vector<std::array<std::uint32_t, 3>> indices;
        text << "o " << part.name << "_" << part.material << "\n";
        for (const Vertex& vertex : part.mesh.vertices) {
            indices.push_back({positions.index_of(vertex.position, text),
                               uvs.index_of(glm::vec3(vertex.uv, 0.0f), text),
                               normals.index_of(vertex.normal, text)});
        }
        text << "g " << part.name << "\nusemtl " << part.material << "\n";
        for (const Face& face : part.mesh.faces) {
            text << "f";
            for (const std::uint32_t corner : face) {
                if (corner == kNoCorner) continue;
                const auto& index = indices.at(corner);
                text << " " << index[0] << "/" << index[1] << "/" << index[2];
            }
            text << "\n";
        }
    }
    text.save(path);
}

void write_mtl(const std::filesystem::path& path, std::span<const MaterialStatement> materials) {
    Text text;
    const auto map = [&](std::string_view keyword, const std::string& file) {
        if (!file.empty()) text << keyword << " " << file << "\n";
    };
    for (const MaterialStatement& material : materials) {
        text << "newmtl " << material.name << "\nKd " << material.base_color.x << " "
             << material.base_color.y << " " << material.base_color.z << "\nPr "
             << material.roughness << "\nPm " << material.metalness << "\n";
        map("map_Kd", material.base_color_map);
        map("map_Pr", material.roughness_map);
        map("map_Pm", material.metalness_map);
        map("norm", material.normal_map);
        map("map_d", material.alpha_map);
        text << "\n";
    }
    text.save(path);
}

}  // namespace assets
