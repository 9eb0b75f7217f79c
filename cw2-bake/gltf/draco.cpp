#include "cw2-bake/gltf/draco.h"

#include <fmt/format.h>

#include <map>
#include <tuple>
#include <utility>

#include "common/program.h"
#include "cw2-bake/gltf/draco_reader.h"
#include "cw2-bake/gltf/json.h"

namespace bake {
namespace {

/// Bytes that hold a mesh, of one or more primitives: decoded once, with all that these ask for.
struct Part {
    DracoMesh mesh{};
    /// By its id, component type and number of components: which attribute of the mesh it is.
    std::map<std::tuple<int, int, int>, std::size_t> attributes{};
    std::vector<int> views{};  ///< of the attributes
    int indices = -1;          ///< accessor; -1: not decoded yet
};

class Decoder {
 public:
    explicit Decoder(GltfFile& file) : file_(file), model_(file.model) {}

    /// Notes what the primitive asks for; to be called for all before the first is decoded.
    void expect(tinygltf::Primitive& primitive) {
        if (!is_compressed(primitive)) return;
        Part& part = part_of(primitive);
        for_attributes(primitive, [&](int id, int& accessor) {
            const auto [type, components] = form_of(accessor);
            auto& wanted = part.mesh.attributes;
            if (part.attributes.try_emplace({id, type, components}, wanted.size()).second)
                wanted.push_back({static_cast<std::uint32_t>(id), type, components});
        });
    }

    void decode(tinygltf::Primitive& primitive, const std::string& pointer) {
        if (!is_compressed(primitive)) return;
        Part& part = part_of(primitive);
        if (part.indices < 0) decode(part, bytes_of(primitive), pointer);
        for_attributes(primitive, [&](int id, int& accessor) {
            const auto [type, components] = form_of(accessor);
            tinygltf::Accessor described = model_.accessors[static_cast<std::size_t>(accessor)];
            described.count = part.mesh.vertex_count;
            accessor =
                add(std::move(described), part.views[part.attributes.at({id, type, components})]);
        });
        primitive.indices = part.indices;
        primitive.mode = TINYGLTF_MODE_TRIANGLES;
    }

 private:
    static bool is_compressed(const tinygltf::Primitive& primitive) {
        return primitive.extensions.contains(kDracoExtension) &&
               primitive.mode >= TINYGLTF_MODE_TRIANGLES;
    }

    std::span<const std::byte> bytes_of(const tinygltf::Primitive& primitive) const {
        const auto& extension = primitive.extensions.at(kDracoExtension);
        return file_.view_bytes(extension.Get("bufferView").GetNumberAsInt());
    }

    Part& part_of(const tinygltf::Primitive& primitive) {
        const std::span<const std::byte> bytes = bytes_of(primitive);
        return parts_[{bytes.data(), bytes.size()}];
    }

    /// Calls `use(id, accessor)` for each attribute that is compressed.
    template <typename Use>
    static void for_attributes(tinygltf::Primitive& primitive, const Use& use) {
        const auto& ids = primitive.extensions.at(kDracoExtension).Get("attributes");
        for (auto& [name, accessor] : primitive.attributes)
            if (ids.Has(name)) use(ids.Get(name).GetNumberAsInt(), accessor);
    }

    /// Component type, and number of components.
    std::pair<int, int> form_of(int accessor) const {
        const auto& described = model_.accessors[static_cast<std::size_t>(accessor)];
        return {described.componentType,
                tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(described.type))};
    }

    void decode(Part& part, std::span<const std::byte> data, const std::string& pointer) {
        const std::string place = pointer + "/extensions/" + kDracoExtension;
        // Parts that overlap would make any number of decoded ones of few bytes.
        bytes_ += data.size();
        if (bytes_ > file_.size) fail_at(file_.path, place, "its bytes belong to others, too");
        read(data, part.mesh, place);
        for (DracoAttribute& attribute : part.mesh.attributes)
            part.views.push_back(add_view(std::move(attribute.values)));
        tinygltf::Accessor indices;
        indices.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
        indices.type = TINYGLTF_TYPE_SCALAR;
        indices.count = part.mesh.indices.size();
        const auto bytes = std::as_bytes(std::span(part.mesh.indices));
        part.indices = add(std::move(indices), add_view({bytes.begin(), bytes.end()}));
        part.mesh.indices = {};
    }

    void read(std::span<const std::byte> data, DracoMesh& mesh, const std::string& place) const {
        std::string error;
        static auto* const reader = reinterpret_cast<DracoReader*>(
            common::load_symbol(kDracoReaderModule, kDracoReaderSymbol, error));
        if (!reader)
            fail_at(file_.path, place, "cannot be read without the library of Draco: " + error);
        if (!reader(data, mesh, error))
            fail_at(file_.path, place, "its Draco data is damaged: " + error);
    }

    /// Returns its index.
    int add_view(std::vector<std::byte> bytes) {
        tinygltf::BufferView view;
        view.buffer = static_cast<int>(file_.buffers.size());
        view.byteLength = bytes.size();
        file_.buffers.push_back(file_.decoded.emplace_back(std::move(bytes)));
        model_.bufferViews.push_back(std::move(view));
        return static_cast<int>(model_.bufferViews.size()) - 1;
    }

    /// Of what the view holds. Returns its index.
    int add(tinygltf::Accessor accessor, int view) {
        accessor.bufferView = view;
        accessor.byteOffset = 0;
        accessor.sparse.isSparse = false;
        model_.accessors.push_back(std::move(accessor));
        return static_cast<int>(model_.accessors.size()) - 1;
    }

    GltfFile& file_;
    tinygltf::Model& model_;
    std::map<std::pair<const std::byte*, std::size_t>, Part> parts_;
    std::size_t bytes_ = 0;  // that were decoded
};

}  // namespace

void decode_draco(GltfFile& file, const std::set<int>& meshes) {
    Decoder decoder(file);
    for (const int mesh : meshes)
        for (auto& primitive : file.model.meshes[static_cast<std::size_t>(mesh)].primitives)
            decoder.expect(primitive);
    for (const int mesh : meshes) {
        auto& primitives = file.model.meshes[static_cast<std::size_t>(mesh)].primitives;
        for (std::size_t i = 0; i < primitives.size(); ++i)
            decoder.decode(primitives[i], fmt::format("/meshes/{}/primitives/{}", mesh, i));
    }
}

}  // namespace bake
