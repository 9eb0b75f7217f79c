#include "cw2-bake/textures/texels.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>

#include "common/every_cpu.h"
#include "cw2-bake/textures/row_ring.h"
#include "cw2-bake/textures/srgb.h"

namespace bake {
namespace {

/// What stands in for a float that is not finite, and the largest value that stays as it is: sums
/// over a level must stay finite.
constexpr float kLargest = 1e9f;

/// A load takes less than a division.
constexpr std::array<float, 256> kOfBytes = [] {
    std::array<float, 256> values{};
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(i) / 255.0f;
    return values;
}();

float to_float(std::uint8_t value) {
    return kOfBytes[value];
}
float to_float(std::uint16_t value) {
    return static_cast<float>(value) / 65'535.0f;
}
float to_float(float value) {
    return std::isfinite(value) ? std::clamp(value, -kLargest, kLargest) : 0.0f;
}

float to_linear(const SrgbTables& tables, std::uint8_t value) {
    return tables.to_linear(value);
}
float to_linear(const SrgbTables& tables, std::uint16_t value) {
    return tables.to_linear(value);
}
float to_linear(const SrgbTables&, float value) {
    return std::clamp(to_float(value), 0.0f, 1.0f);
}

/// Row y of an image of bytes.
const std::byte* row_bytes(const Image& image, std::uint32_t y) {
    return image.samples.data() + std::size_t{y} * image.width * image.channels;
}

/// Calls `visit` with a pointer to the samples of row y, in the image's own type.
template <typename Visit>
void with_row(const Image& image, std::uint32_t y, Visit visit) {
    const std::size_t first = std::size_t{y} * image.width * image.channels;
    switch (image.type) {
        case SampleType::u8:
            return visit(reinterpret_cast<const std::uint8_t*>(image.samples.data()) + first);
        case SampleType::u16:
            return visit(reinterpret_cast<const std::uint16_t*>(image.samples.data()) + first);
        case SampleType::f32:
            return visit(reinterpret_cast<const float*>(image.samples.data()) + first);
    }
}

/// The places of red, green and blue in a texel.
std::array<std::size_t, 3> color_channels(const Image& image) {
    return image.channels < 3 ? std::array<std::size_t, 3>{0, 0, 0}
                              : std::array<std::size_t, 3>{0, 1, 2};
}

/// The same of texels that are vectors.
std::array<std::size_t, 3> vector_channels(const Image& image) {
    return image.channels == 2 ? std::array<std::size_t, 3>{0, 1, 1} : color_channels(image);
}

/// The components apart, since SSE2 has no loads with a stride of 3.
struct Vectors {
    static constexpr std::size_t kCount = 64;
    std::array<float, kCount> x{};
    std::array<float, kCount> y{};
    std::array<float, kCount> z{};
};

CW2_EVERY_CPU void normalise(Vectors& vectors) {
    auto& [x, y, z] = vectors;
    for (std::size_t i = 0; i < Vectors::kCount; ++i) {
        const float square = x[i] * x[i] + y[i] * y[i] + z[i] * z[i];
        const float scale = 1.0f / std::sqrt(std::max(square, 1e-12f));
        x[i] *= scale;
        y[i] *= scale;
        z[i] *= scale;
    }
}

void rebuild_z(Vectors& vectors) {
    for (std::size_t i = 0; i < Vectors::kCount; ++i) {
        const float square = vectors.x[i] * vectors.x[i] + vectors.y[i] * vectors.y[i];
        vectors.z[i] = std::sqrt(std::max(1.0f - square, 0.0f));
    }
}

/// One channel, not limited to [0, 1].
TexelSource channel_texels(const Image& image, Channel channel) {
    const auto colors = color_channels(image);
    const bool luminance = channel == Channel::luminance;
    const bool alpha = channel == Channel::alpha;
    const bool opaque = alpha && !image.has_alpha;
    const std::size_t place = alpha                   ? image.channels - 1
                              : channel == Channel::g ? colors[1]
                              : channel == Channel::b ? colors[2]
                                                      : colors[0];
    return {image.width, image.height, 1, [=, &image](std::uint32_t y, std::span<float> texels) {
                if (opaque) {
                    std::ranges::fill(texels, 1.0f);
                    return;
                }
                with_row(image, y, [&](const auto* row) {
                    if (!luminance) {
                        const std::size_t step = image.channels;
                        for (std::size_t x = 0; x < texels.size(); ++x) {
                            texels[x] = to_float(row[place + step * x]);
                        }
                        return;
                    }
                    const auto [r, g, b] = colors;
                    for (std::size_t x = 0; x < texels.size(); ++x, row += image.channels) {
                        texels[x] = 0.2126f * to_float(row[r]) + 0.7152f * to_float(row[g]) +
                                    0.0722f * to_float(row[b]);
                    }
                });
            },
            image.type != SampleType::u8 || luminance || opaque
                ? StoredRowSource()
                : [=, &image](std::uint32_t y, std::byte* out) {
                      const std::byte* row = row_bytes(image, y) + place;
                      const std::size_t step = image.channels;
                      for (std::size_t x = 0; x < image.width; ++x) out[x] = row[step * x];
                  }};
}

/// The range of texels of a side of `other` that texel `at` of a side of `extent` covers.
struct Cover {
    std::size_t begin;
    std::size_t end;
};
Cover cover(std::uint32_t at, std::uint32_t extent, std::uint32_t other) {
    return {std::size_t{at} * other / extent, (std::size_t{at + 1} * other + extent - 1) / extent};
}

/// One byte a texel of `image`: whether it covers a texel of `mask` at or above `limit`.
std::vector<std::uint8_t> shown_texels(const Image& image, const TexelSource& mask, float limit) {
    std::vector<std::uint8_t> shown(std::size_t{image.width} * image.height);
    std::vector<float> texels(mask.width);
    for (std::uint32_t my = 0; my < mask.height; ++my) {
        mask.read_row(my, texels);
        const Cover rows = cover(my, mask.height, image.height);
        for (std::uint32_t mx = 0; mx < mask.width; ++mx) {
            if (texels[mx] < limit) {
                continue;
            }
            const Cover columns = cover(mx, mask.width, image.width);
            for (std::size_t y = rows.begin; y < rows.end; ++y) {
                std::fill_n(
                    shown.begin() + static_cast<std::ptrdiff_t>(y * image.width + columns.begin),
                    columns.end - columns.begin, std::uint8_t{1});
            }
        }
    }
    return shown;
}

}  // namespace

TexelSource scalar_texels(const Image& image, Channel channel) {
    TexelSource source = channel_texels(image, channel);
    if (image.type == SampleType::f32) {
        source.read_row = [unlimited = source.read_row](std::uint32_t y, std::span<float> texels) {
            unlimited(y, texels);
            for (float& value : texels) {
                value = std::clamp(value, 0.0f, 1.0f);
            }
        };
    }
    return source;
}

TexelSource color_texels(const Image& image) {
    return {image.width, image.height, 3,
            [&image, &tables = srgb()](std::uint32_t y, std::span<float> texels) {
                with_row(image, y, [&](const auto* row) {
                    const auto [r, g, b] = color_channels(image);
                    for (std::size_t i = 0; i < texels.size(); i += 3, row += image.channels) {
                        texels[i] = to_linear(tables, row[r]);
                        texels[i + 1] = to_linear(tables, row[g]);
                        texels[i + 2] = to_linear(tables, row[b]);
                    }
                });
            },
            image.type != SampleType::u8 ? StoredRowSource()
                                         : [&image](std::uint32_t y, std::byte* out) {
                                               const auto [r, g, b] = color_channels(image);
                                               const std::byte* row = row_bytes(image, y);
                                               for (std::size_t x = 0; x < image.width; ++x) {
                                                   out[4 * x] = row[r];
                                                   out[4 * x + 1] = row[g];
                                                   out[4 * x + 2] = row[b];
                                                   out[4 * x + 3] = std::byte{255};
                                                   row += image.channels;
                                               }
                                           }};
}

TexelSource masked_color_texels(const Image& image, const TexelSource& mask, float cutoff) {
    struct State {
        TexelSource colors;
        std::vector<std::uint8_t> shown;
        std::vector<float> row;
    };
    // Shared, because sources are copied.
    const auto state = std::make_shared<State>(
        State{color_texels(image), shown_texels(image, mask, shown_from(cutoff)),
              std::vector<float>(std::size_t{3} * image.width)});
    return {image.width, image.height, 4, [state](std::uint32_t y, std::span<float> texels) {
                state->colors.read_row(y, state->row);
                const std::size_t width = state->colors.width;
                const std::uint8_t* shown = state->shown.data() + y * width;
                for (std::size_t x = 0; x < width; ++x) {
                    const float weight = shown[x];
                    for (std::size_t c = 0; c < 3; ++c) {
                        texels[4 * x + c] = weight * state->row[3 * x + c];
                    }
                    texels[4 * x + 3] = weight;
                }
            }};
}

TexelSource stored_texels(const Image& image) {
    return {image.width, image.height, 3, [&image](std::uint32_t y, std::span<float> texels) {
                with_row(image, y, [&](const auto* row) {
                    const auto [r, g, b] = vector_channels(image);
                    const bool has_blue = image.channels != 2;
                    for (std::size_t i = 0; i < texels.size(); i += 3, row += image.channels) {
                        texels[i] = to_float(row[r]);
                        texels[i + 1] = to_float(row[g]);
                        texels[i + 2] = has_blue ? to_float(row[b]) : 0.0f;
                    }
                });
            }};
}

TexelSource normal_texels(const Image& image, bool xy_only) {
    return {image.width, image.height, 3,
            [&image, xy_only](std::uint32_t y, std::span<float> texels) {
                with_row(image, y, [&](const auto* row) {
                    const auto [r, g, b] = vector_channels(image);
                    Vectors vectors;
                    for (std::size_t begin = 0; begin < image.width; begin += Vectors::kCount) {
                        const std::size_t count = std::min(Vectors::kCount, image.width - begin);
                        for (std::size_t i = 0; i < count; ++i, row += image.channels) {
                            vectors.x[i] = 2.0f * to_float(row[r]) - 1.0f;
                            vectors.y[i] = 2.0f * to_float(row[g]) - 1.0f;
                            // None points into the surface; fillers beside the used part may.
                            vectors.z[i] = std::abs(2.0f * to_float(row[b]) - 1.0f);
                        }
                        if (xy_only) rebuild_z(vectors);
                        normalise(vectors);
                        float* out = texels.data() + 3 * begin;
                        for (std::size_t i = 0; i < count; ++i, out += 3) {
                            out[0] = vectors.x[i];
                            out[1] = vectors.y[i];
                            out[2] = vectors.z[i];
                        }
                    }
                });
            }};
}

TexelSource normal_texels_of_heights(const Image& image, Channel channel, float scale, bool clamp) {
    return {image.width, image.height, 3,
            [ring = std::make_shared<RowRing>(channel_texels(image, channel), clamp), scale, clamp,
             width = image.width](std::uint32_t y, std::span<float> texels) {
                const float* above = ring->row(y, -1);
                const float* row = ring->row(y, 0);
                const float* below = ring->row(y, 1);
                for (std::uint32_t x = 0; x < width; ++x) {
                    const float right = row[neighbour(x, 1, width, clamp)];
                    const float left = row[neighbour(x, -1, width, clamp)];
                    const float nx = -0.5f * scale * (right - left);
                    // Rows go down, y goes up.
                    const float ny = -0.5f * scale * (above[x] - below[x]);
                    const float inverse = 1.0f / std::sqrt(nx * nx + ny * ny + 1.0f);
                    float* out = texels.data() + std::size_t{3} * x;
                    out[0] = nx * inverse;
                    out[1] = ny * inverse;
                    out[2] = inverse;
                }
            }};
}

bool is_grey(const Image& image) {
    if (image.channels < 3) {
        return true;
    }
    constexpr float kNoise = 2.5f / 255.0f;
    bool grey = true;
    for (std::uint32_t y = 0; y < image.height && grey; ++y) {
        with_row(image, y, [&](const auto* row) {
            for (std::uint32_t x = 0; x < image.width && grey; ++x, row += image.channels) {
                const float r = to_float(row[0]);
                grey = std::abs(to_float(row[1]) - r) < kNoise &&
                       std::abs(to_float(row[2]) - r) < kNoise;
            }
        });
    }
    return grey;
}

Range range_of(const TexelSource& source) {
    std::vector<float> texels(source.width);
    source.read_row(0, texels);
    Range range{texels[0], texels[0]};
    for (std::uint32_t y = 0; y < source.height; ++y) {
        source.read_row(y, texels);
        const auto [smallest, largest] = std::ranges::minmax(texels);
        range = {std::min(range.smallest, smallest), std::max(range.largest, largest)};
    }
    return range;
}

}  // namespace bake
