// A bake over an earlier one: it takes over exactly what it would make again.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <set>

#include "cw2-bake/bake.h"
#include "cw2-bake/obj/read_obj.h"
#include "cw2-bake/textures/reuse.h"
#include "cw2-bake/textures/textures.h"
#include "image_files.h"
#include "mesh-format/decode.h"
#include "mesh-format/file.h"

namespace {

using mesh_format::MapUse;

namespace fs = std::filesystem;
using bake::Channel;
using bake::ImageRequest;
using bake::TextureForm;
using bake::TextureMode;
using Bytes = std::vector<std::byte>;
using Names = std::multiset<std::string>;

constexpr const char* kMaterials =
    "newmtl wall\nmap_Kd wall.png\nnorm bumps.png\nmap_Pr rough.png\nPr 0.7\n"
    "newmtl twin\nmap_Kd twin.png\nnorm flat.png\n"
    "newmtl leaf\nmap_Kd leaf.png\nmap_Pm leaf.png\n"
    "newmtl fern\nmap_Kd wall.png\nmap_d mask.png\n"
    "newmtl sand\nbump -bm 3 heights.png\nPr 0.5\n";

Bytes bytes_of(const fs::path& path) {
    const common::MappedFile file(path);
    return {file.bytes().begin(), file.bytes().end()};
}

/// A scene of five materials in a folder of its own.
class Reuse : public testing::Test {
 protected:
    void SetUp() override {
        write_bytes(folder_ / "scene.mtl", kMaterials);
        std::string obj = "mtllib scene.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";
        for (const char* name : {"wall", "twin", "leaf", "fern", "sand"}) {
            obj += std::string("usemtl ") + name + "\nf 1/1 2/2 3/3\n";
        }
        write_bytes(folder_ / "scene.obj", obj);
        paint("wall.png", 3, 0.0);
        fs::copy_file(folder_ / "wall.png", folder_ / "twin.png");
        paint("rough.png", 1, 0.3);
        paint("leaf.png", 4, 0.1);
        paint("mask.png", 1, 0.2);
        paint("heights.png", 1, 0.4);
        paint_normals("bumps.png", 1.0);
        write_image(folder_ / "flat.png", 4, 4, 3, [](int, int) {
            return std::vector{128 / 255.0, 128 / 255.0, 1.0};
        });
    }

    void paint(const std::string& name, int channels, double shift) {
        write_image(folder_ / name, 32, 16, channels, [&](int x, int y) {
            std::vector<double> texel;
            for (int c = 0; c < channels; ++c) {
                texel.push_back(0.5 + 0.4 * std::sin(0.3 * x + 0.2 * y * (c + 1) + 9 * shift));
            }
            return texel;
        });
    }
    void paint_normals(const std::string& name, double scale) {
        write_image(folder_ / name, 32, 32, 3, [&](int x, int y) {
            return std::vector{0.5 + 0.3 * scale * std::sin(2.0 * x),
                               0.5 + 0.3 * scale * std::sin(1.7 * y), 0.9};
        });
    }

    Bytes bake(const std::string& output, TextureForm form = TextureMode::bc) {
        bake::bake({.input = folder_ / "scene.obj",
                    .output = folder_ / output,
                    .textures = form.mode,
                    .compress = form.compressed,
                    .quiet = true},
                   [&](const std::string& line) { warnings_.push_back(line); });
        return bytes_of(folder_ / output);
    }

    /// The names of the textures that a bake over scene.cw2mesh would make anew.
    Names made_anew(TextureForm form = TextureMode::bc) {
        const auto scene = bake::read_obj(folder_ / "scene.obj", [](const std::string&) {});
        const bake::TextureSet set = bake::bake_textures(
            scene.materials, form, folder_ / "scene.cw2mesh", [](const std::string&) {}, {});
        Names names;
        for (const bake::Texture& texture : set.textures) {
            if (texture.earlier_payload.empty()) names.insert(texture.name);
        }
        return names;
    }

    /// A bake over scene.cw2mesh makes `names` anew, and gives what a fresh bake gives.
    void expect_made_anew(const Names& names, TextureForm form = TextureMode::bc) {
        EXPECT_EQ(made_anew(form), names);
        EXPECT_TRUE(bake("scene.cw2mesh", form) == bake("fresh.cw2mesh", form));
        fs::remove(folder_ / "fresh.cw2mesh");
    }

    /// Changes scene.cw2mesh.
    void damage(const std::function<void(Bytes&)>& change) {
        Bytes bytes = bytes_of(folder_ / "scene.cw2mesh");
        change(bytes);
        write_bytes(folder_ / "scene.cw2mesh",
                    {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    }

    void edit_materials(const std::string& text, const std::string& by) {
        std::string materials = kMaterials;
        materials.replace(materials.find(text), text.size(), by);
        write_bytes(folder_ / "scene.mtl", materials);
    }

    TemporaryFolder folder_;
    std::vector<std::string> warnings_;
};

const TextureForm kForms[] = {
    TextureMode::bc, TextureMode::lossless, {TextureMode::bc, true}, {TextureMode::lossless, true}};

const Names kAllLossless{"wall.png", "wall.png", "bumps.png", "rough.png",  "leaf.png",
                         "leaf.png", "leaf.png", "mask.png",  "heights.png"};
const Names kAll{"wall.png", "wall.png", "bumps.png", "rough.png",   "leaf.png",
                 "leaf.png", "leaf.png", "mask.png",  "heights.png", "heights.png"};

TEST_F(Reuse, WithoutAnEarlierFileEverythingIsMade) {
    EXPECT_EQ(made_anew(), kAll);
}

TEST_F(Reuse, ASecondBakeMakesNothingAnewAndGivesTheSameBytes) {
    for (const TextureForm form : kForms) {
        const Bytes first = bake("scene.cw2mesh", form);
        expect_made_anew({}, form);
        EXPECT_TRUE(bytes_of(folder_ / "scene.cw2mesh") == first);
    }
    EXPECT_EQ(warnings_, std::vector<std::string>());
}

TEST_F(Reuse, OnlyWhatDependsOnAChangedImageIsMadeAnew) {
    bake("scene.cw2mesh");
    paint_normals("bumps.png", 0.5);
    expect_made_anew({"bumps.png", "rough.png"});
    paint("rough.png", 1, 0.7);
    expect_made_anew({"rough.png"});
    paint("mask.png", 1, 0.9);
    expect_made_anew({"wall.png", "mask.png"});
    paint("leaf.png", 4, 0.9);
    expect_made_anew({"leaf.png", "leaf.png", "leaf.png"});
    paint("heights.png", 1, 0.9);
    expect_made_anew({"heights.png", "heights.png"});
    paint_normals("flat.png", 0.25);
    expect_made_anew({"flat.png"});
}

TEST_F(Reuse, AnotherFormMakesEverythingAnew) {
    bake("scene.cw2mesh");
    expect_made_anew(kAllLossless, TextureMode::lossless);
    expect_made_anew(kAll, {TextureMode::bc, true});
    expect_made_anew(kAll, TextureMode::bc);
}

TEST_F(Reuse, CompressedTexturesAreSmallerAndDecodeToThePlainOnes) {
    for (const TextureMode mode : {TextureMode::bc, TextureMode::lossless}) {
        const Bytes plain_bytes = bake("scene.cw2mesh", mode);
        const Bytes bytes = bake("compressed.cw2mesh", {mode, true});
        const auto plain = mesh_format::parse(plain_bytes, "plain");
        const auto document = mesh_format::parse(bytes, "compressed");
        EXPECT_LT(document.texels.size(), plain.texels.size());
        ASSERT_EQ(document.textures.size(), plain.textures.size());
        std::set<std::uint32_t> scalars;  // whose blocks may repeat others
        for (const mesh_format::MaterialRecord& material : document.materials) {
            scalars.insert(material.textures[MapUse::roughness]);
            scalars.insert(material.textures[MapUse::metalness]);
        }
        for (std::uint32_t i = 0; i < plain.textures.size(); ++i) {
            const auto payload = mesh_format::decode_payload(document, i, "compressed");
            const bool is_equal =
                std::ranges::equal(payload.bytes, plain.payload(plain.textures[i]));
            EXPECT_TRUE(is_equal || (scalars.contains(i) && mode == TextureMode::bc)) << i;
            EXPECT_EQ(payload.bytes.size(), plain.payload(plain.textures[i]).size());
        }
    }
}

TEST_F(Reuse, WhatAMaterialStatesCounts) {
    const auto expect = [&](const std::string& text, const std::string& by, const Names& names) {
        SCOPED_TRACE(by);
        write_bytes(folder_ / "scene.mtl", kMaterials);
        bake("scene.cw2mesh");
        edit_materials(text, by);
        expect_made_anew(names);
    };
    expect("Pr 0.7", "Pr 0.6", {"rough.png"});
    expect("Pr 0.5", "Pr 0.6", {"heights.png"});
    expect("-bm 3", "-bm 2", {"heights.png", "heights.png"});
    expect("map_Pr rough.png", "map_Pr -clamp on rough.png", {"rough.png"});
    expect("map_Pm leaf.png", "map_Pm -imfchan g leaf.png", {"leaf.png"});
    expect("Kd leaf.png\nmap_Pm", "Kd leaf.png\nKd 1 0 0\nmap_Pm", {});
}

TEST_F(Reuse, NamesAreThoseOfTheImagesOfToday) {
    bake("scene.cw2mesh");
    edit_materials("map_Kd wall.png\nnorm", "map_Kd twin.png\nnorm");
    fs::rename(folder_ / "leaf.png", folder_ / "blade.png");
    fs::copy_file(folder_ / "blade.png", folder_ / "leaf.png");
    std::string materials = kMaterials;
    for (std::size_t at; (at = materials.find("leaf.png")) != std::string::npos;) {
        materials.replace(at, 8, "blade.png");
    }
    write_bytes(folder_ / "scene.mtl", materials);
    expect_made_anew({});
    edit_materials("map_Kd wall.png\nnorm", "norm");  // wall.png was the first of two equal images
    expect_made_anew({});
}

TEST_F(Reuse, AnAlteredPayloadIsMadeAnewAlone) {
    bake("scene.cw2mesh");
    damage([](Bytes& bytes) {
        const auto document = mesh_format::parse(bytes, "");
        for (const auto& texture : document.textures) {
            if (document.text(texture.name) != "bumps.png") continue;
            const_cast<std::byte&>(document.payload(texture)[40]) ^= std::byte{4};
        }
    });
    expect_made_anew({"bumps.png"});
}

TEST_F(Reuse, FilesThatAreDamagedOrOfAnotherVersionServeNothing) {
    const std::function<void(Bytes&)> changes[] = {
        [](Bytes& bytes) { bytes.clear(); },
        [](Bytes& bytes) { bytes.resize(100); },
        [](Bytes& bytes) { bytes.resize(bytes.size() - 1); },
        [](Bytes& bytes) { bytes.push_back(std::byte{0}); },
        [](Bytes& bytes) { bytes[0] = std::byte{'X'}; },
        [](Bytes& bytes) { bytes[sizeof(mesh_format::Header) + 8] ^= std::byte{1}; },
        [](Bytes& bytes) {
            mesh_format::Header header;
            std::memcpy(&header, bytes.data(), sizeof header);
            --header.version;
            header.checksum = 0;
            header.checksum = mesh_format::checksum(std::as_bytes(std::span(&header, 1)));
            std::memcpy(bytes.data(), &header, sizeof header);
        }};
    for (const auto& change : changes) {
        bake("scene.cw2mesh");
        damage(change);
        expect_made_anew(kAll);
    }
}

TEST_F(Reuse, WarningsComeAgain) {
    fs::resize_file(folder_ / "rough.png", 60);
    fs::remove(folder_ / "mask.png");
    bake("scene.cw2mesh");
    ASSERT_EQ(warnings_.size(), 2u);
    const std::vector<std::string> first = std::exchange(warnings_, {});
    bake("scene.cw2mesh");
    EXPECT_EQ(warnings_, first);
}

TEST_F(Reuse, WhatAnImageIsTakenForIsSaidAgain) {
    paint("heights.png", 3, 0.4);
    write_image(folder_ / "bumps.png", 8, 8, 3, [](int x, int) {
        return std::vector{0.4 + 0.03 * x, 0.5, 0.0};
    });
    write_image(folder_ / "leaf.png", 8, 8, 4, [](int, int) {
        return std::vector{0.4, 0.5, 0.2, 0.3};
    });
    const Bytes first = bake("scene.cw2mesh");
    const std::vector<std::string> warnings = std::exchange(warnings_, {});
    ASSERT_EQ(warnings.size(), 3u);
    EXPECT_TRUE(bake("scene.cw2mesh") == first);
    EXPECT_EQ(warnings_, warnings);
}

TEST(SourceKeys, TellEverythingApartThatATextureDependsOn) {
    const TemporaryFolder folder;
    write_bytes(folder / "a.png", "one");
    write_bytes(folder / "b.png", "two");
    write_bytes(folder / "a.tga", "one");
    write_bytes(folder / "like_a.png", "one");
    const bake::TextureMap a = map_of(folder / "a.png");
    const bake::TextureMap b = map_of(folder / "b.png");
    bake::TextureMap clamped = a;
    clamped.clamp = true;
    bake::TextureMap embedded = a;  // has other bytes than the file of its name
    embedded.embedded = std::make_shared<const std::vector<std::byte>>(9, std::byte{7});
    const ImageRequest base{.kind = ImageRequest::Kind::surface, .map = a, .alpha_map = b};
    const ImageRequest requests[] = {
        base,
        {.kind = ImageRequest::Kind::normal, .map = a, .alpha_map = b},
        {.kind = ImageRequest::Kind::surface, .map = b, .alpha_map = a},
        {.kind = ImageRequest::Kind::surface, .map = a},
        {.kind = ImageRequest::Kind::surface, .alpha_map = a},
        {.kind = ImageRequest::Kind::surface, .map = clamped},
        {.kind = ImageRequest::Kind::surface, .map = map_of(folder / "a.tga")},
        {.kind = ImageRequest::Kind::surface, .map = map_of(folder / "a.png", "", Channel::g)},
        {.kind = ImageRequest::Kind::surface, .map = a, .alpha_cutoff = 0.5f},
        {.kind = ImageRequest::Kind::surface, .map = a, .bump_scale = 0.5f},
        {.kind = ImageRequest::Kind::surface, .map = a, .relief = b},
        {.kind = ImageRequest::Kind::surface, .map = a, .relief = b, .relief_is_bump = true},
        {.kind = ImageRequest::Kind::surface, .map = a, .relief = b, .normal_scale = 0.5f},
        {.kind = ImageRequest::Kind::surface, .map = a, .color_alpha_is_mask = false},
        {.kind = ImageRequest::Kind::surface, .map = embedded},
        {.kind = ImageRequest::Kind::surface, .map = a, .factor = 0.5f},
    };
    std::set<bake::SourceKey> keys;
    for (const TextureForm form : kForms) {
        for (const auto& key : bake::source_keys(requests, form)) keys.insert(key.value());
    }
    EXPECT_EQ(keys.size(), std::size(kForms) * std::size(requests));

    const ImageRequest elsewhere[] = {{.kind = ImageRequest::Kind::surface,
                                       .map = map_of(folder / "like_a.png", "b.mtl:7"),
                                       .alpha_map = b}};
    EXPECT_EQ(bake::source_keys(elsewhere, TextureMode::bc),
              bake::source_keys({{base}}, TextureMode::bc));
    const ImageRequest missing[] = {{.map = map_of(folder / "c.png")}};
    EXPECT_EQ(bake::source_keys(missing, TextureMode::bc).at(0), std::nullopt);
}

}  // namespace
