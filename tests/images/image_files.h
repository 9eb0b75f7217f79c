// Image files that the tests write, and materials that name them.
#pragma once

#include <OpenImageIO/imageio.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "cw2-bake/base/source_scene.h"
#include "tests/support/image.h"
#include "tests/support/temporary_folder.h"

inline void write_image(const std::filesystem::path& path, int width, int height, int channels,
                        const Paint& paint, OIIO::TypeDesc type = OIIO::TypeDesc::UINT8,
                        const std::string& attribute = "", const std::string& value = "") {
    OIIO::ImageSpec spec(width, height, channels, type);
    spec["oiio:UnassociatedAlpha"] = 1;
    spec["pnm:pfmflip"] = 0;  // version 2.5 writes the floats of any PNM upside down
    if (!attribute.empty()) {
        spec.attribute(attribute, value);
    }
    std::vector<float> samples;
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            for (const double sample : paint(x, y)) {
                samples.push_back(static_cast<float>(sample));
            }
        }
    }
    const auto output = OIIO::ImageOutput::create(path.string());
    if (!output || !output->open(path.string(), spec) ||
        !output->write_image(OIIO::TypeDesc::FLOAT, samples.data()) || !output->close()) {
        throw std::runtime_error(path.string() + ": " + OIIO::geterror());
    }
}

inline void write_bytes(const std::filesystem::path& path, const std::string& bytes) {
    std::ofstream(path, std::ios::binary) << bytes;
}

/// Keeps only the first `share` of a file.
inline void truncate(const std::filesystem::path& path, double share) {
    const auto size = static_cast<double>(std::filesystem::file_size(path));
    std::filesystem::resize_file(path, static_cast<std::uintmax_t>(size * share));
}

inline bake::TextureMap map_of(const std::filesystem::path& file,
                               const std::string& stated_in = "a.mtl:1",
                               bake::Channel channel = bake::Channel::standard) {
    return {.file = file, .stated_in = stated_in, .channel = channel};
}
