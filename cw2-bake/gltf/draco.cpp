#include "cw2-bake/gltf/draco.h"

#include <dlfcn.h>
#include <fmt/format.h>

#include <utility>

#include "common/program.h"
#include "cw2-bake/gltf/draco_reader.h"
#include "cw2-bake/gltf/json.h"

namespace bake {
namespace {

/// The module stays loaded. Null, and why in `error`, where it
/// cannot be.
DracoReader* load_draco_reader(std::string& error) {
    const auto module = common::beside_program(kDracoReaderModule);
    void* handle = dlopen(module.c_str(), RTLD_LAZY | RTLD_LOCAL);
    void* symbol = handle ? dlsym(handle, kDracoReaderSymbol) : nullptr;
    if (!symbol) error = dlerror();
    return reinterpret_cast<DracoReader*>(symbol);
}

class Decoder {
 public:
    explicit Decoder(GltfFile& file) : file_(file), model_(file.model) {}

    void decode(tinygltf::Primitive& primitive, const std::string& pointer) {
        const auto extension = primitive.extensions.find(kDracoExtension);
        if (extension == primitive.extensions.end() || primitive.mode < TINYGLTF_MODE_TRIANGLES)
            return;
        const std::string place = pointer + "/extensions/" + kDracoExtension;
        const auto view = extension->second.Get("bufferView").GetNumberAsInt();
        const auto& ids = extension->second.Get("attributes");
        const std::span<const std::byte> data = file_.view_bytes(view);
        // Primitives that share their bytes would make any number of decoded ones of them.
        bytes_ += data.size();
        if (bytes_ > file_.size) fail_at(file_.path, place, "its bytes belong to others, too");
        DracoMesh mesh;
        std::vector<int*> accessors;  // of the attributes
        for (auto& [name, accessor] : primitive.attributes) {
            if (!ids.Has(name)) continue;
            const auto& described = model_.accessors[static_cast<std::size_t>(accessor)];
            mesh.attributes.push_back(
                {static_cast<std::uint32_t>(ids.Get(name).GetNumberAsInt()),
                 described.componentType,
                 tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(described.type))});
            accessors.push_back(&accessor);
        }
        read(data, mesh, place);
        for (std::size_t i = 0; i < accessors.size(); ++i) {
            tinygltf::Accessor described =
                model_.accessors[static_cast<std::size_t>(*accessors[i])];
            described.count = mesh.vertex_count;
            *accessors[i] = add(std::move(described), std::move(mesh.attributes[i].values));
        }
        tinygltf::Accessor indices;
        indices.componentType = TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
        indices.type = TINYGLTF_TYPE_SCALAR;
        indices.count = mesh.indices.size();
        const auto bytes = std::as_bytes(std::span(mesh.indices));
        primitive.indices = add(std::move(indices), {bytes.begin(), bytes.end()});
        primitive.mode = TINYGLTF_MODE_TRIANGLES;
    }

 private:
    void read(std::span<const std::byte> data, DracoMesh& mesh, const std::string& place) const {
        std::string error;
        static DracoReader* const reader = load_draco_reader(error);
        if (!reader)
            fail_at(file_.path, place, "cannot be read without the library of Draco: " + error);
        if (!reader(data, mesh, error))
            fail_at(file_.path, place, "its Draco data is damaged: " + error);
    }

    /// Returns the index of the accessor.
    int add(tinygltf::Accessor accessor, std::vector<std::byte> bytes) {
        tinygltf::BufferView view;
        view.buffer = static_cast<int>(file_.buffers.size());
        view.byteLength = bytes.size();
        file_.buffers.push_back(file_.decoded.emplace_back(std::move(bytes)));
        accessor.bufferView = static_cast<int>(model_.bufferViews.size());
        accessor.byteOffset = 0;
        accessor.sparse.isSparse = false;
        model_.bufferViews.push_back(std::move(view));
        model_.accessors.push_back(std::move(accessor));
        return static_cast<int>(model_.accessors.size()) - 1;
    }

    GltfFile& file_;
    tinygltf::Model& model_;
    std::size_t bytes_ = 0;  // that were decoded
};

}  // namespace

void decode_draco(GltfFile& file, const std::set<int>& meshes) {
    Decoder decoder(file);
    for (const int mesh : meshes) {
        auto& primitives = file.model.meshes[static_cast<std::size_t>(mesh)].primitives;
        for (std::size_t i = 0; i < primitives.size(); ++i)
            decoder.decode(primitives[i], fmt::format("/meshes/{}/primitives/{}", mesh, i));
    }
}

}  // namespace bake
