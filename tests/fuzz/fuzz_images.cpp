// An image file that materials take for some of their maps.
#include <cstdlib>
#include <string_view>
#include <utility>

#include "tests/fuzz/fuzzing.h"

namespace {

constexpr char kScene[] =
    "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
    "usemtl all\nf 1/1 2/2 3/3 4/4\nusemtl relief\nf 1/1 2/2 3/3\n";

std::span<const std::uint8_t> bytes_of(std::string_view text) {
    return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

/// A file name of the format as whose file the image begins.
std::string name_of(std::string_view image) {
    constexpr std::pair<std::string_view, const char*> kStarts[] = {
        {"\x89PNG", "png"}, {"\xff\xd8", "jpg"}, {"v/1\x01", "exr"}, {"#?RADIANCE", "hdr"},
        {"BM", "bmp"},      {"GIF8", "gif"},     {"P6", "ppm"},      {"P5", "pgm"},
        {"Pf", "pfm"},      {"II*", "tif"},      {"MM", "tif"},      {"RIFF", "webp"},
        {"DDS ", "dds"},    {"\x01\xda", "sgi"}, {"8BPS", "psd"},
    };
    for (const auto& [start, extension] : kStarts)
        if (image.starts_with(start)) return std::string("image.") + extension;
    return "image.tga";  // which may begin with anything
}

std::string materials_with(const std::string& image, std::uint64_t drawn) {
    std::string text = "newmtl all\n";
    const auto maybe = [&](const char* map) {
        if (drawn % 2 == 1) text += map + (" " + image + "\n");
        drawn /= 2;
    };
    for (const char* map : {"map_Kd", "map_Pr", "map_Pm", "norm", "map_d", "map_Ke"}) maybe(map);
    text += "newmtl relief\n";
    for (const char* map : {"bump", "map_Kd", "map_Pr"}) maybe(map);
    return text;
}

}  // namespace

/// OpenImageIO takes the reader that the name asks for: to try all takes most of the time.
extern "C" int LLVMFuzzerInitialize(int*, char***) {
    return setenv("OPENIMAGEIO_OPTIONS", "try_all_readers=0", 1);
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string name = name_of({reinterpret_cast<const char*>(data), size});
    const std::uint64_t drawn = fuzzing::draw_from({data, size}) >> 40;
    // Its readers are no part of what libFuzzer sees, and are slow: each takes 64 MiB of memory.
    const bool is_common = name == "image.png" || name == "image.jpg";
    if (!is_common && drawn % 8 != 0) return 0;
    fuzzing::write(name, {data, size});
    fuzzing::write("scene.obj", bytes_of(kScene));
    fuzzing::write("m.mtl", bytes_of(materials_with(name, drawn / 8)));
    fuzzing::bake_any("scene.obj", {data, size});
    return 0;
}
