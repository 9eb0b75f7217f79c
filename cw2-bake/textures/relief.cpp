#include "cw2-bake/textures/relief.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "cw2-bake/textures/texels.h"

namespace bake {
namespace {

/// Counts of texels, as vectors of which 0.5 n + 0.5 is stored.
struct Vectors {
    double count = 0;
    double coloured = 0;    ///< not grey
    double unit = 0;        ///< of these about of length 1
    double unit_up = 0;     ///< about of length 1, and z not below 0
    double in_disk = 0;     ///< x and y are those of a unit vector
    double not_up = 0;      ///< z is 0 at most
    double least_blue = 0;  ///< z is -1
    double sum_x = 0, sum_y = 0, sum_chroma = 0;
    double off_unit = 0;  ///< sum of the distances of squared lengths from 1
    float smallest_z = 1, largest_z = -1;

    bool nearly_all(double part) const { return part >= 0.95 * count; }
    double tilt_of_mean() const { return std::hypot(sum_x, sum_y) / count; }
};

/// What 8 bits hold, and JPEGs, mips and filters lose, of length 1 (squared).
constexpr float kShortest = 0.6f, kLongest = 1.5f;
constexpr float kByte = 2.0f / 255.0f;

void count(const float* texel, Vectors& vectors) {
    const float x = 2.0f * texel[0] - 1.0f;
    const float y = 2.0f * texel[1] - 1.0f;
    const float z = 2.0f * texel[2] - 1.0f;
    const float disk = x * x + y * y;
    const float square = disk + z * z;
    const float chroma = std::max({x, y, z}) - std::min({x, y, z});
    const bool is_coloured = chroma > 4 * kByte;
    vectors.count += 1;
    vectors.coloured += is_coloured;
    vectors.unit += is_coloured && square > kShortest && square < kLongest;
    vectors.unit_up += square > kShortest && square < kLongest && z > -6 * kByte;
    vectors.off_unit += std::abs(square - 1.0f);
    vectors.in_disk += disk < 1.1f;
    vectors.not_up += z < 0.6f * kByte;  // 128 of 255 is a middle, too
    vectors.least_blue += z < -1.0f + 4 * kByte;
    vectors.sum_x += x;
    vectors.sum_y += y;
    vectors.sum_chroma += chroma;
    vectors.smallest_z = std::min(vectors.smallest_z, z);
    vectors.largest_z = std::max(vectors.largest_z, z);
}

/// Of all texels, or of some 50,000 in rows at an odd distance, so that no pattern hides in it.
Vectors count_vectors(const Image& image) {
    constexpr std::uint64_t kMost = 50'000;
    const std::uint64_t texels = std::uint64_t{image.width} * image.height;
    const auto step = static_cast<std::uint32_t>(texels / kMost) | 1u;
    const TexelSource source = stored_texels(image);
    std::vector<float> row(std::size_t{3} * image.width);
    Vectors vectors;
    for (std::uint32_t y = 0; y < image.height; y += step) {
        source.read_row(y, row);
        for (std::size_t i = 0; i < row.size(); i += 3) count(row.data() + i, vectors);
    }
    return vectors;
}

/// Two channels in a file of three: blue is the same everywhere.
bool lacks_z(const Vectors& vectors) {
    const bool constant = vectors.largest_z - vectors.smallest_z < 0.5f * kByte;
    const bool full =
        vectors.smallest_z > 1.0f - 1.5f * kByte && !vectors.nearly_all(vectors.unit_up);
    return constant && (full || vectors.nearly_all(vectors.not_up));
}

}  // namespace

Relief relief_of_bump(const Image& image) {
    if (is_grey(image)) return Relief::heights;
    const Vectors vectors = count_vectors(image);
    // Tilts of whole maps as large as this have not been seen; a blue sky's is 0.6.
    constexpr double kMostTilt = 0.55;
    if (vectors.tilt_of_mean() < kMostTilt && vectors.unit_up >= 0.9 * vectors.count &&
        vectors.off_unit < 0.2 * vectors.count)
        return Relief::normals;
    if (vectors.tilt_of_mean() < 0.5 * kMostTilt && vectors.nearly_all(vectors.in_disk) &&
        (lacks_z(vectors) || vectors.nearly_all(vectors.least_blue)))
        return Relief::normals_xy;
    constexpr double kNoise = 12.0 / 255.0;
    return 0.5 * vectors.sum_chroma < kNoise * vectors.count ? Relief::heights : Relief::colors;
}

Relief relief_of_normals(const Image& image) {
    if (image.channels == 2 && !image.has_alpha) return Relief::normals_xy;
    if (is_grey(image)) return Relief::heights;
    const Vectors vectors = count_vectors(image);
    if (vectors.nearly_all(vectors.not_up) || lacks_z(vectors)) return Relief::normals_xy;
    return 2 * vectors.unit < vectors.coloured ? Relief::vectors : Relief::normals;
}

}  // namespace bake
