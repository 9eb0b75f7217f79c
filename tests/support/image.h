// Image files that the tests write and read.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <utility>
#include <vector>

/// Samples as a file stores them: integers divided by their largest value, floats as they are.
struct Picture {
    int width = 0;
    int height = 0;
    int channels = 0;
    std::vector<float> samples;  ///< rows from the top, channels together

    const float* at(int x, int y) const {
        return &samples[(static_cast<std::size_t>(y) * static_cast<std::size_t>(width) +
                         static_cast<std::size_t>(x)) *
                        static_cast<std::size_t>(channels)];
    }
    float* at(int x, int y) { return const_cast<float*>(std::as_const(*this).at(x, y)); }
};

/// Throws std::runtime_error "PATH: what is wrong".
Picture read_picture(const std::filesystem::path& path);

/// Writes a PNG of 8 bits; samples beyond [0, 1] are clamped. Throws as read_picture() does.
void write_picture(const std::filesystem::path& path, const Picture& picture);

/// A texel's samples, each in [0, 1].
using Paint = std::function<std::vector<double>(int x, int y)>;

Picture painted(int width, int height, int channels, const Paint& paint);
