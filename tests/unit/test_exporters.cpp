// OBJ and MTL as modelling programs and scanners write them: what each of their habits becomes, and
// that habits warn of nothing. The samples are made up, in the manner of each.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/unit/obj_text.h"

namespace {

using bake::SourceMaterial;
using mesh_format::MapUse;

/// What a reading comes to, a line for the geometry and one for each material.
std::vector<std::string> summary(const bake::SourceScene& scene) {
    const auto with = [&](auto member) {
        return std::ranges::count_if(
            scene.corners, [&](const bake::Corner& c) { return c.*member != bake::kAbsent; });
    };
    const std::set<std::uint32_t> groups(scene.smoothing_group.begin(),
                                         scene.smoothing_group.end());
    std::vector<std::string> lines{
        fmt::format("{} triangles, {} normals, {} UVs, {} smoothing groups{}",
                    scene.corners.size() / 3, with(&bake::Corner::normal), with(&bake::Corner::uv),
                    groups.size() - groups.count(0), scene.colors.empty() ? "" : ", colours")};
    for (const SourceMaterial& material : scene.materials) {
        std::string line =
            fmt::format("{}: {:.2f} {:.2f} {:.2f}, roughness {:.2f}, metalness {:.2f}",
                        material.name, material.base_color.r, material.base_color.g,
                        material.base_color.b, material.roughness, material.metalness);
        const auto add = [&](const char* what, const bake::TextureMap& map) {
            line += fmt::format(", {} {}", what, map.file.filename().string());
        };
        const std::pair<MapUse, const char*> uses[] = {
            {MapUse::base_color, "colour"},   {MapUse::roughness, "roughness"},
            {MapUse::metalness, "metalness"}, {MapUse::normal, "normal"},
            {MapUse::alpha_mask, "mask"},     {MapUse::emission, "emission"}};
        for (const auto& [use, what] : uses)
            if (material.maps[use]) add(what, *material.maps[use]);
        if (material.bump_map) add("bump", material.bump_map->map);
        if (material.blend) line += fmt::format(", opacity {:.2f}", material.opacity);
        lines.push_back(line);
    }
    return lines;
}

struct Sample {
    const char* exporter;
    const char* obj;
    std::vector<std::pair<std::string, std::string>> files;  ///< names and texts
    std::vector<std::string> expected;                       ///< summary()
    std::vector<std::string> warnings;
    bool crlf = false;  ///< lines end as on Windows
};

std::string with_line_ends(const std::string& text, bool crlf) {
    std::string result;
    for (const char c : text) {
        if (crlf && c == '\n') result += '\r';
        result += c;
    }
    return result;
}

class Exporter : public testing::TestWithParam<Sample> {};

TEST_P(Exporter, IsReadAsItIsMeant) {
    const Sample& sample = GetParam();
    const TemporaryFolder folder;
    for (const auto& [name, text] : sample.files)
        folder.write(name, with_line_ends(text, sample.crlf));
    const Reading reading = read(folder, with_line_ends(sample.obj, sample.crlf));
    EXPECT_EQ(summary(reading.scene), sample.expected);
    EXPECT_EQ(reading.warnings, sample.warnings);
}

const Sample kSamples[] = {
    {"Blender",
     R"(# Blender 4.1.1
# www.blender.org
mtllib scene.mtl
o Plane.001
v -1.000000 0.000000 1.000000 0.8000 0.5000 0.2000
v 1.000000 0.000000 1.000000 0.8000 0.5000 0.2000
v -1.000000 0.000000 -1.000000 1.0000 1.0000 1.0000
v 1.000000 0.000000 -1.000000 1.0000 1.0000 1.0000
vn -0.0000 1.0000 -0.0000
vt 1.000000 0.000000
vt 0.000000 1.000000
vt 0.000000 0.000000
vt 1.000000 1.000000
s 0
usemtl Wood floor.001
f 1/3/1 2/1/1 4/4/1 3/2/1
o Empty
s 1
usemtl Gold
f 1/3/1 2/1/1 4/4/1
)",
     {{"scene.mtl", R"(# Blender 4.1.1 MTL File: 'room.blend'
# www.blender.org

newmtl Gold
Ns 1000.000000
Ka 1.000000 1.000000 1.000000
Kd 0.800000 0.500000 0.100000
Ke 0.000000 0.000000 0.000000
Ni 1.500000
d 1.000000
illum 3
Pr 0.250000
Pm 1.000000
Ps 0.000000
Pc 0.000000
Pcr 0.030000
aniso 0.000000
anisor 0.000000

newmtl Wood floor.001
Ns 250.000000
Ka 1.000000 1.000000 1.000000
Kd 0.800000 0.800000 0.800000
Ks 0.500000 0.500000 0.500000
Ke 0.000000 0.000000 0.000000
Ni 1.450000
d 1.000000
illum 2
map_Kd textures/wood floor.png
map_Pr textures/wood_rough.png
map_Bump -bm 1.000000 textures/wood_normal.png
)"},
      {"textures/wood floor.png", ""},
      {"textures/wood_rough.png", ""},
      {"textures/wood_normal.png", ""}},
     {"3 triangles, 9 normals, 9 UVs, 0 smoothing groups, colours",
      "Wood floor.001: 0.80 0.80 0.80, roughness 1.00, metalness 0.00, colour wood floor.png, "
      "roughness wood_rough.png, bump wood_normal.png",
      "Gold: 0.80 0.50 0.10, roughness 0.25, metalness 1.00"},
     {}},

    {"Blender279",
     R"(# Blender v2.79 (sub 0) OBJ File: ''
# www.blender.org
mtllib scene.mtl
o Cube_Cube.001
v -1 0 1
v 1 0 1
v 1 0 -1
v -1 0 -1
usemtl None
s 1
f 1 2 3
usemtl (null)
s off
f 1 3 4
)",
     {{"scene.mtl", R"(# Blender MTL File: 'None'
# Material Count: 1

newmtl None
Ns 0
Ka 0.000000 0.000000 0.000000
Kd 0.8 0.8 0.8
Ks 0.8 0.8 0.8
d 1
illum 2
)"}},
     {"2 triangles, 0 normals, 0 UVs, 1 smoothing groups",
      "None: 0.80 0.80 0.80, roughness 1.00, metalness 0.00",
      "(null): 0.80 0.80 0.80, roughness 1.00, metalness 0.00"},
     {}},

    {"Maya",
     R"(# This file uses centimeters as units for non-parametric coordinates.

mtllib scene.mtl
g default
v -5.000000 0.000000 5.000000
v 5.000000 0.000000 5.000000
v -5.000000 0.000000 -5.000000
v 5.000000 0.000000 -5.000000
vt 0.000000 0.000000
vt 1.000000 0.000000
vt 0.000000 1.000000
vt 1.000000 1.000000
vn 0.000000 1.000000 0.000000
vn 0.000000 1.000000 0.000000
vn 0.000000 1.000000 0.000000
vn 0.000000 1.000000 0.000000
s off
g pPlane1 group1
usemtl initialShadingGroup
f 1/1/1 2/2/2 4/4/3 3/3/4
g default
s 1
g pPlane2
usemtl phong1SG
f 1/1/1 2/2/2 4/4/3 3/3/4
)",
     {{"scene.mtl", R"(newmtl initialShadingGroup
illum 4
Kd 0.50 0.50 0.50
Ka 0.00 0.00 0.00
Tf 1.00 1.00 1.00
Ni 1.00
newmtl phong1SG
illum 4
Kd 0.00 0.00 0.00
Ka 0.00 0.00 0.00
Tf 1.00 1.00 1.00
map_Kd C:\Users\me\project\sourceimages\wood.png
bump C:\Users\me\project\sourceimages\bump.png
Ni 1.00
Ks 0.50 0.50 0.50
Ns 18.00
)"},
      {"sourceimages/wood.png", ""},
      {"wood.png", ""},
      {"bump.png", ""}},
     {"4 triangles, 12 normals, 12 UVs, 0 smoothing groups",
      "initialShadingGroup: 0.50 0.50 0.50, roughness 1.00, metalness 0.00",
      "phong1SG: 1.00 1.00 1.00, roughness 0.56, metalness 0.00, colour wood.png, bump bump.png"},
     {}},

    {"3dsMax",
     R"(# 3ds Max Wavefront OBJ Exporter v0.97b
# File Created: 02.05.2019 10:20:30

mtllib scene.mtl

#
# object Plane001
#

v  -10.0000 0.0000 10.0000
v  10.0000 0.0000 10.0000
v  -10.0000 0.0000 -10.0000
v  10.0000 0.0000 -10.0000
# 4 vertices

vn 0.0000 1.0000 -0.0000
# 1 vertex normals

vt 0.0000 0.0000 0.0000
vt 1.0000 0.0000 0.0000
vt 0.0000 1.0000 0.0000
vt 1.0000 1.0000 0.0000
# 4 texture coords

g Plane001
usemtl 01___Default
s 1
f 3/3/1 1/1/1 2/2/1 
f 2/2/1 4/4/1 3/3/1 
# 0 polygons - 2 triangles

)",
     {{"scene.mtl", R"(# 3ds Max Wavefront OBJ Exporter v0.97b
# File Created: 02.05.2019 10:20:30

newmtl 01___Default
	Ns 10.0000
	Ni 1.5000
	d 1.0000
	Tr 0.0000
	Tf 1.0000 1.0000 1.0000 
	illum 2
	Ka 0.5880 0.5880 0.5880
	Kd 0.5880 0.5880 0.5880
	Ks 0.0000 0.0000 0.0000
	Ke 0.0000 0.0000 0.0000
	map_Ka maps\wood.jpg
	map_Kd maps\wood.jpg
	map_d maps\mask.jpg
	map_bump maps\bump.jpg
	bump maps\bump.jpg
)"},
      {"maps/wood.jpg", ""},
      {"maps/mask.jpg", ""},
      {"maps/bump.jpg", ""}},
     {"2 triangles, 6 normals, 6 UVs, 0 smoothing groups",
      "01___Default: 0.59 0.59 0.59, roughness 0.64, metalness 0.00, colour wood.jpg, mask "
      "mask.jpg, bump bump.jpg"},
     {},
     true},

    {"ZBrush",
     R"(#
# File written by ZBrush version 2022
#Vertex Count 4
#UV Vertex Count 4
#Face Count 1
#Auto scale x=2.000000 y=2.000000 z=2.000000
#Auto offset x=0.000000 y=0.000000 z=0.000000
g default
usemtl defaultMat
v -1 0 1
v 1 0 1
v 1 0 -1
v -1 0 -1
#A block of MRGB follows
#MRGB ff804020ff804020ffffffffffffffff
# End of MRGB block
vt 0 0
vt 1 0
vt 1 1
vt 0 1
g default
f 1/1 2/2 3/3 4/4
)",
     {},
     {"2 triangles, 0 normals, 6 UVs, 0 smoothing groups, colours",
      "defaultMat: 1.00 1.00 1.00, roughness 1.00, metalness 0.00"},
     {"scene.obj:9: no material library defines 'defaultMat'; a default is used"}},

    {"Rhino",
     R"(# Rhino

mtllib scene.mtl
usemtl Plaster_White
o object_1
v -5 0 5
v 5 0 5
v 5 0 -5
v -5 0 -5
vt 0 0
vt 1 0
vt 1 1
vt 0 1
vn 0 1 0
vn 0 1 0
vn 0 1 0
vn 0 1 0
f 1/1/1 2/2/2 \
3/3/3 4/4/4
)",
     {{"scene.mtl", R"(# Rhino
newmtl Plaster_White
Ka 0.0000 0.0000 0.0000
Kd 0.9000 0.9000 0.8500
Ks 0.0000 0.0000 0.0000
Tf 0.0000 0.0000 0.0000
d 1.0000
Ns 0
map_Kd "plaster white.png"
)"},
      {"plaster white.png", ""}},
     {"2 triangles, 6 normals, 6 UVs, 0 smoothing groups",
      "Plaster_White: 0.90 0.90 0.85, roughness 1.00, metalness 0.00, colour plaster white.png"},
     {},
     true},

    {"SketchUp",
     R"(# Alias OBJ Model File
# Exported from SketchUp
# File units = inches

mtllib scene.mtl

g Mesh1 Group1 Model

usemtl _Wood_Floor_1
v 0 0 0
vt 0 0
vn 0 1 0
v 40 0 0
vt 1.01 0
v 40 0 -40
vt 1.01 1.01
f 1/1/1 2/2/1 3/3/1 

v 0 0 -40
vt 0 1.01
f 3/3/1 4/4/1 1/1/1 

usemtl FrontColor
vn 0 -1 0
f 3/3/2 2/2/2 1/1/2 

)",
     {{"scene.mtl", R"(# Alias OBJ Material File
# Exported from SketchUp

newmtl _Wood_Floor_1
Ka 0.000000 0.000000 0.000000
Kd 0.625490 0.572549 0.447059
Ks 0.330000 0.330000 0.330000
map_Kd scene/_Wood_Floor_1.jpg

newmtl FrontColor
Ka 0.000000 0.000000 0.000000
Kd 1.000000 1.000000 1.000000
Ks 0.330000 0.330000 0.330000

)"},
      {"scene/_Wood_Floor_1.jpg", ""}},
     {"3 triangles, 9 normals, 9 UVs, 0 smoothing groups",
      "_Wood_Floor_1: 0.63 0.57 0.45, roughness 1.00, metalness 0.00, colour _Wood_Floor_1.jpg",
      "FrontColor: 1.00 1.00 1.00, roughness 1.00, metalness 0.00"},
     {},
     true},

    // Its normals are as long as the angles around them, and Tr 1 is opaque.
    {"MeshLab",
     R"(####
#
# OBJ File Generated by Meshlab
#
####
# Object scene.obj
#
# Vertices: 4
# Faces: 2
#
####
mtllib ./scene.obj.mtl

vn 0.000000 1.570796 0.000000
v 0.000000 0.000000 1.000000 1.000000 0.500000 0.250000
vn 0.000000 1.570796 0.000000
v 1.000000 0.000000 1.000000 1.000000 0.500000 0.250000
vn 0.000000 1.570796 0.000000
v 1.000000 0.000000 0.000000 1.000000 1.000000 1.000000
vn 0.000000 1.570796 0.000000
v 0.000000 0.000000 0.000000 1.000000 1.000000 1.000000
# 4 vertices, 0 vertices normals


usemtl material_0
vt 0.000000 0.000000
vt 1.000000 0.000000
vt 1.000000 1.000000
f 1/1/1 2/2/2 3/3/3
vt 0.000000 1.000000
f 1/1/1 3/3/3 4/4/4
# 2 faces, 4 coords texture

# End of File
)",
     {{"scene.obj.mtl", R"(#
# Wavefront material file
# Converted by Meshlab Group
#

newmtl material_0
Ka 0.200000 0.200000 0.200000
Kd 1.000000 1.000000 1.000000
Ks 1.000000 1.000000 1.000000
Tr 1.000000
illum 2
Ns 0.000000
map_Kd paint.png

)"},
      {"paint.png", ""}},
     {"2 triangles, 6 normals, 6 UVs, 0 smoothing groups, colours",
      "material_0: 1.00 1.00 1.00, roughness 1.00, metalness 0.00, colour paint.png"},
     {}},

    // Photogrammetry: a texture for each tile of the atlas, places of a map's grid.
    {"Photogrammetry",
     R"(# Created by a scanner
mtllib scene.mtl
v 458123.125000 5431234.500000 312.250000
v 458124.125000 5431234.500000 312.250000
v 458124.125000 5431235.500000 312.250000
v 458123.125000 5431235.500000 312.250000
vt 0.250000 0.250000
vt 0.500000 0.250000
vt 0.500000 0.500000
vt 0.250000 0.500000
g scan_u1_v1
usemtl scan_u1_v1
f 1/1 2/2 3/3
usemtl scan_u2_v1
f 1/1 3/3 4/4
)",
     {{"scene.mtl", R"(newmtl scan_u1_v1
Ka 1.000000 1.000000 1.000000
Kd 1.000000 1.000000 1.000000
Ks 0.000000 0.000000 0.000000
Tr 0.000000
Ns 1.000000
illum 0
map_Kd scan_u1_v1_diffuse.png

newmtl scan_u2_v1
Ka 1.000000 1.000000 1.000000
Kd 1.000000 1.000000 1.000000
Ks 0.000000 0.000000 0.000000
Tr 0.000000
Ns 1.000000
illum 0
map_Kd scan_u2_v1_diffuse.png
)"},
      {"scan_u1_v1_diffuse.png", ""},
      {"scan_u2_v1_diffuse.png", ""}},
     {"2 triangles, 0 normals, 6 UVs, 0 smoothing groups",
      "scan_u1_v1: 1.00 1.00 1.00, roughness 0.90, metalness 0.00, colour scan_u1_v1_diffuse.png",
      "scan_u2_v1: 1.00 1.00 1.00, roughness 0.90, metalness 0.00, colour scan_u2_v1_diffuse.png"},
     {}},

    // A scanner of colours without UVs, in bytes.
    {"ColourScan",
     R"(# scan, 3 vertices
v 0.10 0.20 0.30 255 128 64
vn 0 0 1
v 1.10 0.20 0.30 250 120 60
vn 0 0 1
v 1.10 1.20 0.30 10 20 30
vn 0 0 1
f 1//1 2//2 3//3
)",
     {},
     {"1 triangles, 3 normals, 0 UVs, 0 smoothing groups, colours",
      "default: 1.00 1.00 1.00, roughness 1.00, metalness 0.00"},
     {"scene.obj:2: vertex colours are taken as 0 to 255, for some are above 1 (3 in all)"}},
};

INSTANTIATE_TEST_SUITE_P(All, Exporter, testing::ValuesIn(kSamples),
                         [](const auto& sample) { return std::string(sample.param.exporter); });

}  // namespace
