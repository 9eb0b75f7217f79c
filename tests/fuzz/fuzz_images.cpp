// An image file that a material takes for everything.
#include "tests/fuzz/fuzzing.h"

namespace {

constexpr char kScene[] =
    "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "usemtl all\nf 1/1 2/2 3/3 4/4\nusemtl relief\nf 1/1 2/2 3/3\n";
constexpr char kMaterials[] =
    "newmtl all\nmap_Kd image\nmap_Pr image\nmap_Pm image\nnorm image\nmap_d image\nmap_Ke image\n"
    "newmtl relief\nbump image\nmap_Kd image\nmap_Pr image\n";

template <std::size_t size>
std::span<const std::uint8_t> text(const char (&literal)[size]) {
    return {reinterpret_cast<const std::uint8_t*>(literal), size - 1};
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzzing::write("scene.obj", text(kScene));
    fuzzing::write("m.mtl", text(kMaterials));
    fuzzing::write("image", {data, size});
    fuzzing::bake_any("scene.obj", {data, size});
    return 0;
}
