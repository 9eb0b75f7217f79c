#include "tests/support/image.h"

#include <OpenImageIO/imageio.h>

#include <stdexcept>

Picture read_picture(const std::filesystem::path& path) {
    // Colours as the file has them, whatever their alpha.
    OIIO::ImageSpec wishes;
    wishes["oiio:UnassociatedAlpha"] = 1;
    const auto input = OIIO::ImageInput::open(path.string(), &wishes);
    if (!input) throw std::runtime_error(path.string() + ": " + OIIO::geterror());
    const OIIO::ImageSpec& spec = input->spec();
    Picture picture{spec.width, spec.height, spec.nchannels, {}};
    picture.samples.resize(spec.image_pixels() * static_cast<std::size_t>(spec.nchannels));
    if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT,
                           picture.samples.data())) {
        throw std::runtime_error(path.string() + ": " + input->geterror());
    }
    return picture;
}

void write_picture(const std::filesystem::path& path, const Picture& picture) {
    OIIO::ImageSpec spec(picture.width, picture.height, picture.channels, OIIO::TypeDesc::UINT8);
    spec["oiio:UnassociatedAlpha"] = 1;
    const auto output = OIIO::ImageOutput::create(path.string());
    if (!output || !output->open(path.string(), spec) ||
        !output->write_image(OIIO::TypeDesc::FLOAT, picture.samples.data()) || !output->close()) {
        throw std::runtime_error(path.string() + ": " +
                                 (output ? output->geterror() : OIIO::geterror()));
    }
}

Picture painted(int width, int height, int channels, const Paint& paint) {
    Picture picture{width, height, channels, {}};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            for (const double sample : paint(x, y)) {
                picture.samples.push_back(static_cast<float>(sample));
            }
        }
    }
    return picture;
}
