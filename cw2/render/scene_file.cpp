#include "cw2/render/scene_file.h"

#include <tbb/parallel_for.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <new>
#include <span>
#include <string>

#include "cw2/render/vertex_positions.h"

namespace cw2 {

namespace {

void read(SceneFile& file, std::span<const std::byte> bytes, const std::string& name) {
    using mesh_format::Payloads;
    file.name = name;
    file.document = mesh_format::parse(bytes, name, Payloads::unchecked);
    tbb::parallel_for(std::size_t{0}, file.document.textures.size(), [&](std::size_t i) {
        mesh_format::check_payload(file.document, i, name);
        // All of them need not be in memory beside what becomes of them.
        file.forget(file.document.payload(file.document.textures[i]));
    });
    file.decoded =
        mesh_format::decode(file.document, name, [](std::size_t count, const auto& decode_mesh) {
            tbb::parallel_for(std::size_t{0}, count, decode_mesh);
        });
    file.positions = vertex_positions(file.document);
    file.bounds = bounds_of(file.document.scene, file.positions);
    file.start = start_of(file.document.scene);
}

}  // namespace

void SceneFile::forget(std::span<const std::byte> part) const {
    if (!mapped) return;
    // Decoded vertices are elsewhere.
    const auto address = [](const std::byte* place) {
        return reinterpret_cast<std::uintptr_t>(place);
    };
    const std::span<const std::byte> all = mapped->bytes();
    if (address(all.data()) <= address(part.data()) &&
        address(part.data()) + part.size() <= address(all.data()) + all.size())
        common::forget_mapped(part);
}

void refuse_for_memory(const std::filesystem::path& path) {
    throw common::FileError(path.string() + ": there is not enough memory to load it");
}

SceneFile load_scene_file(const std::filesystem::path& path) {
    try {
        SceneFile file;
        file.mapped.emplace(path);
        read(file, file.mapped->bytes(), path.string());
        return file;
    } catch (const std::bad_alloc&) {
        refuse_for_memory(path);
    }
}

SceneFile read_scene_file(const std::filesystem::path& path) {
    try {
        SceneFile file;
        // What is no such file may be larger than memory.
        file.bytes = common::read_file(path, sizeof(mesh_format::Header));
        mesh_format::Header header{};
        std::memcpy(&header, file.bytes.data(), file.bytes.size());
        if (header.magic == mesh_format::kMagic && header.version == mesh_format::kVersion)
            file.bytes = common::read_file(path, header.file_size + 1);
        read(file, file.bytes, path.string());
        return file;
    } catch (const std::bad_alloc&) {
        refuse_for_memory(path);
    }
}

}  // namespace cw2
