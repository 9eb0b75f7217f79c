// Makes the pictures of docs/tangent-frames.md, frames-FORM.png for each form of the tangent frame:
// the shaded picture and, below it, the angle between its frames and those of the form f32, in
// false colour.
//
// Usage: frame_figure OUTPUT_DIRECTORY DIRECTORY FORM...
// DIRECTORY holds, all of one size, FORM-shaded.exr and the views FORM-vertex-normal.exr,
// FORM-tangent.exr and FORM-bitangent.exr of each FORM; the first one is what others are held to.
#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "cw2/render/image_file.h"
#include "cw2/render/legend.h"
#include "shaders/false_color.h"

namespace {

constexpr cw2::ValueRange kDegrees{1e-4f, 10.0f};
constexpr int kLegendHeight = 63;

struct Picture {
    int width = 0;
    int height = 0;
    std::vector<glm::vec4> pixels;
};

Picture read(const std::string& path) {
    Imf::InputFile file(path.c_str());
    const Imath::Box2i window = file.header().dataWindow();
    Picture picture{window.max.x + 1, window.max.y + 1, {}};
    picture.pixels.resize(static_cast<std::size_t>(picture.width) * picture.height);
    Imf::FrameBuffer frame;
    char* const base = reinterpret_cast<char*>(picture.pixels.data());
    const char* const names[] = {"R", "G", "B", "A"};
    for (std::size_t channel = 0; channel < 4; ++channel) {
        frame.insert(names[channel],
                     Imf::Slice(Imf::FLOAT, base + 4 * channel, sizeof(glm::vec4),
                                sizeof(glm::vec4) * static_cast<std::size_t>(picture.width)));
    }
    file.setFrameBuffer(frame);
    file.readPixels(0, picture.height - 1);
    return picture;
}

/// The frames that a form gives, pixel by pixel.
struct Frames {
    Picture tangent, bitangent, normal;

    explicit Frames(const std::string& prefix)
        : tangent(read(prefix + "-tangent.exr")),
          bitangent(read(prefix + "-bitangent.exr")),
          normal(read(prefix + "-vertex-normal.exr")) {}
};

/// Degrees of the rotation between two frames, from the distance of their matrices:
/// |A - B| = 2 sqrt(2) sin(angle / 2).
double angle_between(const Frames& a, const Frames& b, std::size_t pixel) {
    double square = 0.0;
    for (const auto part : {&Frames::tangent, &Frames::bitangent, &Frames::normal}) {
        // A view holds 0.5 d + 0.5.
        const glm::dvec3 difference =
            2.0 * (glm::dvec3((a.*part).pixels[pixel]) - glm::dvec3((b.*part).pixels[pixel]));
        square += glm::dot(difference, difference);
    }
    const double sine = std::min(std::sqrt(square / 8.0), 1.0);
    return 2.0 * std::asin(sine) * 180.0 / 3.14159265358979;
}

std::uint8_t encode_srgb(float linear) {
    const float x = std::clamp(linear, 0.0f, 1.0f);
    const float encoded = x <= 0.0031308f ? 12.92f * x : 1.055f * std::pow(x, 1.0f / 2.4f) - 0.055f;
    return static_cast<std::uint8_t>(std::lround(255.0f * encoded));
}

/// A picture, RGBA of 8 bits.
class Canvas {
 public:
    Canvas(int width, int height) : width_(width), height_(height) {
        bytes_.resize(static_cast<std::size_t>(width) * height * 4, std::byte{24});
    }
    /// `encoded`: components as the PNG holds them.
    void set(int x, int y, const glm::u8vec3& encoded) {
        for (int channel = 0; channel < 3; ++channel) {
            bytes_[(static_cast<std::size_t>(y) * width_ + x) * 4 + channel] =
                static_cast<std::byte>(encoded[channel]);
        }
    }
    void draw_legend() {
        const auto width = static_cast<std::uint32_t>(width_);
        cw2::draw_legend(bytes_, width, static_cast<std::uint32_t>(height_), 0, width, kDegrees);
    }
    void save(const std::string& path) const {
        cw2::write_image(path, static_cast<std::uint32_t>(width_),
                         static_cast<std::uint32_t>(height_), bytes_);
    }

 private:
    int width_, height_;
    std::vector<std::byte> bytes_;
};

void draw_shaded(Canvas& canvas, const Picture& shaded) {
    const float exposure = std::exp2(cw2::kViews[cw2::interop::kViewShaded].exposure);
    for (int y = 0; y < shaded.height; ++y) {
        for (int x = 0; x < shaded.width; ++x) {
            const glm::vec4 p =
                exposure * shaded.pixels[static_cast<std::size_t>(y) * shaded.width + x];
            canvas.set(x, y, {encode_srgb(p.r), encode_srgb(p.g), encode_srgb(p.b)});
        }
    }
}

void draw_error(Canvas& canvas, int top, const Frames& frames, const Frames& truth,
                const std::string& form) {
    double sum = 0.0, worst = 0.0;
    std::size_t count = 0;
    for (int y = 0; y < frames.normal.height; ++y) {
        for (int x = 0; x < frames.normal.width; ++x) {
            const std::size_t pixel = static_cast<std::size_t>(y) * frames.normal.width + x;
            if (truth.normal.pixels[pixel].a == 0.0f) {
                canvas.set(x, top + y, {0, 0, 0});
                continue;
            }
            const double angle = angle_between(frames, truth, pixel);
            sum += angle;
            worst = std::max(worst, angle);
            ++count;
            const float position = cw2::interop::false_color_position(static_cast<float>(angle),
                                                                      kDegrees.low, kDegrees.high);
            canvas.set(x, top + y, cw2::false_color_bytes(position));
        }
    }
    fmt::print("{}: mean {:.5f}, worst {:.5f} degrees over {} pixels\n", form,
               sum / static_cast<double>(std::max<std::size_t>(count, 1)), worst, count);
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 4) {
        fmt::print(stderr, "usage: frame_figure OUTPUT_DIRECTORY DIRECTORY FORM...\n");
        return 2;
    }
    try {
        const std::string directory = std::string(argv[2]) + '/';
        const std::vector<std::string> forms(argv + 3, argv + argc);
        const Frames truth(directory + forms.front());
        const int width = truth.normal.width;
        const int height = truth.normal.height;
        for (const std::string& form : forms) {
            Canvas canvas(width, 2 * height + kLegendHeight);
            draw_shaded(canvas, read(directory + form + "-shaded.exr"));
            draw_error(canvas, height, Frames(directory + form), truth, form);
            canvas.draw_legend();
            canvas.save(fmt::format("{}/frames-{}.png", argv[1], form));
        }
        return 0;
    } catch (const std::exception& error) {
        fmt::print(stderr, "frame_figure: {}\n", error.what());
        return 1;
    }
}
