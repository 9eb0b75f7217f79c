#include "tests/fuzz/fuzzing.h"

#include <cstdlib>
#include <fstream>
#include <stdexcept>

#include "common/encode_png.h"
#include "common/io.h"
#include "cw2-bake/bake.h"
#include "cw2-bake/gltf/write_gltf.h"
#include "cw2-bake/inspection.h"
#include "cw2-bake/settings.h"
#include "mesh-format/decode.h"
#include "mesh-format/file.h"
#include "tests/support/temporary_folder.h"

namespace fuzzing {
namespace {

const bake::Warn kIgnore = [](const std::string&) {};

}  // namespace

const std::filesystem::path& folder() {
    static const TemporaryFolder made;
    static const bool has_image = [] {
        const std::vector<std::byte> texels(std::size_t{4} * 4 * 4, std::byte{100});
        const auto png = common::encode_png({.width = 4,
                                             .height = 4,
                                             .channels = common::PngPicture::Channels::rgba,
                                             .says_srgb = false,
                                             .texels = texels});
        std::ofstream(made / "a.png")
            .write(reinterpret_cast<const char*>(png.data()),
                   static_cast<std::streamsize>(png.size()));
        return true;
    }();
    static_cast<void>(has_image);
    return made.path();
}

void write(const std::string& name, std::span<const std::uint8_t> bytes) {
    std::ofstream(folder() / name, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()),
               static_cast<std::streamsize>(bytes.size()));
}

std::uint64_t draw_from(std::span<const std::uint8_t> bytes) {
    std::uint64_t hash = 0xCBF2'9CE4'8422'2325;
    for (const std::uint8_t byte : bytes) hash = (hash ^ byte) * 0x100'0000'01B3;
    return hash ^ hash >> 32;
}

void bake_any(const std::string& name, std::span<const std::uint8_t> bytes) {
    std::uint64_t drawn = draw_from(bytes);
    const auto draw = [&](std::uint64_t count) {
        const std::uint64_t result = drawn % count;
        drawn /= count;
        return result;
    };
    bake::Settings settings{.input = folder() / name, .threads = 1, .quiet = true};
    settings.frame_form = static_cast<mesh_format::FrameForm>(draw(4));
    settings.position_form = static_cast<mesh_format::PositionForm>(draw(2));
    settings.textures = static_cast<bake::TextureMode>(draw(3));
    settings.compress = draw(2) == 1;
    settings.z_up = draw(4) == 0;
    const bool exports = draw(2) == 1;
    settings.output = folder() / (exports ? "out.glb" : "out.cw2mesh");
    std::filesystem::remove(settings.output);
    try {
        bake::bake(settings, kIgnore);
    } catch (const std::runtime_error&) {
        if (std::filesystem::exists(settings.output)) std::abort();
        return;
    }
    if (exports) {
        settings.input = settings.output;
        settings.output = folder() / "out.cw2mesh";
        bake::bake(settings, kIgnore);
    }
    const common::MappedFile baked(settings.output);
    mesh_format::Document document = mesh_format::parse(baked.bytes(), "out.cw2mesh");
    mesh_format::decode(document, "out.cw2mesh");
}

void read_mesh(std::span<const std::byte> bytes) {
    try {
        mesh_format::Document document = mesh_format::parse(bytes, "the file");
        bake::inspection(document, bytes.size());
        bake::inspection_json(document, bytes.size());
        const mesh_format::DecodedGeometry decoded = mesh_format::decode(document, "the file");
        std::vector<mesh_format::Payload> decoded_payloads;
        std::vector<std::span<const std::byte>> payloads;
        for (std::size_t i = 0; i < document.textures.size(); ++i) {
            decoded_payloads.push_back(mesh_format::decode_payload(document, i, "the file"));
            payloads.push_back(decoded_payloads.back().bytes);
        }
        bake::write_gltf(document, payloads, folder() / "out.glb", kIgnore);
    } catch (const std::runtime_error&) {
        return;
    }
}

}  // namespace fuzzing
