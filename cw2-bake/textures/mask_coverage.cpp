#include "cw2-bake/textures/mask_coverage.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/every_cpu.h"
#include "cw2-bake/textures/block_encoders.h"
#include "mesh-format/blocks.h"

namespace bake {
namespace {

/// Large levels have details that only many places find; each next level does with half as many.
#ifdef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
constexpr std::size_t kMostPlaces = 64;  // all inputs have small masks, and they should be many
constexpr std::size_t kLeastPlaces = 64;
#else
constexpr std::size_t kMostPlaces = 131072;
constexpr std::size_t kLeastPlaces = 16384;
#endif

/// Texels of a level whose blocks are tried: in larger ones what blocks change evens out.
constexpr std::size_t kMostInBlocks = 64 * 64;

/// Of the coarser of two levels.
constexpr std::array kBlends{0.06f, 0.2f, 0.4f, 0.6f, 0.8f, 0.94f, 1.0f};

/// From plain to strong contrast; what is above the threshold favoured, or what is below it kept
/// near, when details of two levels do not meet. Found by trial on leaves, blades, grids and
/// chains.
constexpr std::array kCurves{MaskCurve{1.0f, 1.0f, 1.0f},    MaskCurve{1.0f, 16.0f, 16.0f},
                             MaskCurve{1.0f, 4.0f, 1.0f},    MaskCurve{1.0f, 1.0f, 0.25f},
                             MaskCurve{1.0f, 16.0f, 4.0f},   MaskCurve{1.0f, 1.0f, 0.125f},
                             MaskCurve{1.0f, 1.0f, 0.0625f}, MaskCurve{1.0f, 16.0f, 2.0f}};

/// The byte that is stored of a texel's mean, as a sampler reads it.
inline std::int32_t stored(float mean, const MaskCurve& curve, float threshold) {
    const float beyond = mean * curve.scale - threshold;
    const float bent = threshold + beyond * (beyond < 0.0f ? curve.below : curve.above);
    return static_cast<std::int32_t>(std::min(std::max(bent, 0.0f), 1.0f) * 255.0f + 0.5f);
}

void store(std::span<const float> means, const MaskCurve& curve, float threshold, std::byte* out) {
    std::ranges::transform(means, out, [&](float mean) {
        return static_cast<std::byte>(stored(mean, curve, threshold));
    });
}

float sampled(std::byte byte) {
    return static_cast<float>(std::to_integer<int>(byte)) * (1.0f / 255.0f);
}

/// What a level has at each place.
CW2_EVERY_CPU void filter(const std::array<const float*, 4>& texels, const float* across,
                          const float* down, const MaskCurve& curve, float threshold,
                          std::span<float> out) {
    for (std::size_t i = 0; i < out.size(); ++i) {
        const auto at = [&](int corner) {
            return static_cast<float>(stored(texels[corner][i], curve, threshold));
        };
        const float above = at(0) + (at(1) - at(0)) * across[i];
        const float below = at(2) + (at(3) - at(2)) * across[i];
        out[i] = (above + (below - above) * down[i]) * (1.0f / 255.0f);
    }
}

/// How many places are shown `share` of the way from one level to the next.
CW2_EVERY_CPU std::int32_t count_shown(const float* finer, const float* coarser, std::size_t places,
                                       float share, float threshold) {
    std::int32_t count = 0;
    for (std::size_t i = 0; i < places; ++i) {
        count += finer[i] + (coarser[i] - finer[i]) * share >= threshold ? 1 : 0;
    }
    return count;
}

/// Place i as a fraction of the texture, in 2^-32: multiples of the powers of 1 / 1.32471796, which
/// cover a square evenly (Roberts, "The unreasonable effectiveness of quasirandom sequences",
/// 2018).
struct Place {
    std::uint32_t x;
    std::uint32_t y;
};

constexpr Place place(std::size_t i) {
    const auto n = static_cast<std::uint32_t>(i);
    return {n * 3242174889u + 0x8000'0000u, n * 2447445414u + 0x8000'0000u};
}

/// In the place of a texel: beyond the edge, where there is 0.
constexpr std::uint32_t kNowhere = 0xFFFF'FFFF;

/// What is beyond a texture's edges.
enum class Beyond { opposite_edge, same_edge, nothing };

/// The texels beside a place along one axis.
struct Span {
    std::uint32_t first;
    std::uint32_t second;
    float share;
};

Span span_at(std::uint32_t place, std::uint32_t extent, Beyond beyond) {
    // In 2^-32 of a texel, from the centre of the one before the first.
    const std::uint64_t at = std::uint64_t{place} * extent + 0x8000'0000u;
    const auto before = static_cast<std::uint32_t>(at >> 32);
    const float share = static_cast<float>(static_cast<std::uint32_t>(at)) * 0x1p-32f;
    const std::uint32_t last = extent - 1;
    const auto outside = [&](std::uint32_t edge, std::uint32_t opposite) {
        return beyond == Beyond::nothing ? kNowhere : beyond == Beyond::same_edge ? edge : opposite;
    };
    if (before == 0) return {outside(0, last), 0, share};
    if (before == extent) return {last, outside(last, 0), share};
    return {before - 1, before, share};
}

/// Makes equal texels a little different, so that some can be shown and others not.
void add_grain(Level& level) {
    constexpr float kGrain = 0.3f;
    for (std::size_t i = 0; i < level.texels.size(); ++i) {
        const float noise = static_cast<float>(place(i).x ^ place(i / level.width).y) * 0x1p-32f;
        level.texels[i] *= 1.0f + kGrain * (noise - 0.5f);
    }
}

/// What blocks make of a level's bytes.
std::vector<std::byte> through_blocks(const std::vector<std::byte>& bytes, std::uint32_t width,
                                      std::uint32_t height, std::uint32_t limit) {
    constexpr auto kFormat = mesh_format::TextureFormat::bc4_unorm;
    std::vector<std::byte> blocks(std::size_t{mesh_format::block_count(kFormat, width)} *
                                  mesh_format::block_bytes(kFormat));
    std::vector<std::byte> decoded(bytes.size());
    for (std::uint32_t y = 0; y < height; y += 4) {
        encode_bc4_row({bytes.data(), width, height}, y, limit, blocks.data());
        mesh_format::decode_block_row(kFormat, blocks.data(), width, std::min(4u, height - y),
                                      decoded.data() + std::size_t{y} * width);
    }
    return decoded;
}

}  // namespace

MaskCoverage::MaskCoverage(std::span<const std::byte> texels, std::uint32_t width,
                           std::uint32_t height, const MaskUse& use)
    : use_(use),
      hidden_beyond_(use.clamp && hides_its_edges(texels, width, height, use.cutoff)),
      threshold_(shown_from(use.cutoff)),
      places_(std::clamp(texels.size(), kLeastPlaces, kMostPlaces)),
      finer_(places_),
      current_(places_) {
    for (std::vector<float>& corner : corners_.texels) corner.resize(places_);
    corners_.across.resize(places_);
    corners_.down.resize(places_);
    gather([&](std::size_t i) { return sampled(texels[i]); }, width, height);
    try_plain({}, places_);
    share_ = count_shown(current_.data(), current_.data(), places_, 0.0f, threshold_) /
             static_cast<double>(places_);
    std::swap(finer_, current_);
}

template <typename TexelAt>
void MaskCoverage::gather(const TexelAt& texel_at, std::uint32_t width, std::uint32_t height) {
    const Beyond beyond = hidden_beyond_ ? Beyond::nothing
                          : use_.clamp   ? Beyond::same_edge
                                         : Beyond::opposite_edge;
    const auto at = [&](std::uint32_t x, std::uint32_t y) {
        return x == kNowhere || y == kNowhere ? 0.0f : texel_at(std::size_t{y} * width + x);
    };
    for (std::size_t i = 0; i < places_; ++i) {
        const Span x = span_at(place(i).x, width, beyond);
        const Span y = span_at(place(i).y, height, beyond);
        corners_.texels[0][i] = at(x.first, y.first);
        corners_.texels[1][i] = at(x.second, y.first);
        corners_.texels[2][i] = at(x.first, y.second);
        corners_.texels[3][i] = at(x.second, y.second);
        corners_.across[i] = x.share;
        corners_.down[i] = y.share;
    }
}

MaskCoverage::Miss MaskCoverage::try_plain(const MaskCurve& curve, std::size_t places) {
    filter({corners_.texels[0].data(), corners_.texels[1].data(), corners_.texels[2].data(),
            corners_.texels[3].data()},
           corners_.across.data(), corners_.down.data(), curve, threshold_,
           std::span(current_).first(places));
    Miss miss{std::numeric_limits<std::int64_t>::max(), std::numeric_limits<std::int64_t>::min()};
    for (const float blend : kBlends) {
        const std::int64_t off =
            count_shown(finer_.data(), current_.data(), places, blend, threshold_) - wanted(places);
        miss = {std::min(miss.least, off), std::max(miss.most, off)};
    }
    return miss;
}

MaskCoverage::Miss MaskCoverage::try_blocks(const Level& level, const MaskCurve& curve,
                                            std::size_t places) {
    std::vector<std::byte> bytes(level.texels.size());
    store(level.texels, curve, threshold_, bytes.data());
    bytes = through_blocks(bytes, level.width, level.height, cutoff_byte(use_.cutoff));
    gather([&](std::size_t i) { return sampled(bytes[i]); }, level.width, level.height);
    return try_plain({}, places);
}

/// The best scale between that of `curve` divided by `reach` and times it, found in so many steps.
MaskCoverage::Fit MaskCoverage::refine(const Trial& trial, MaskCurve curve, float reach, int steps,
                                       std::size_t places) {
    Fit best{curve, trial(curve, places)};
    for (Miss miss = best.miss; steps > 0; --steps) {
        reach = std::sqrt(reach);
        curve.scale *= miss.least + miss.most < 0 ? reach : 1.0f / reach;
        miss = trial(curve, places);
        if (miss.worst() < best.miss.worst()) best = {curve, miss};
    }
    return best;
}

std::int64_t MaskCoverage::wanted(std::size_t places) const {
    return std::llround(share_ * static_cast<double>(places));
}

bool MaskCoverage::is_near(const Miss& miss, std::size_t places) const {
    const std::int64_t shown = wanted(places);
    return miss.worst() * 50 <= std::min(shown, static_cast<std::int64_t>(places) - shown);
}

MaskCurve MaskCoverage::choose(Level& level) {
    const Trial plain = [this](const MaskCurve& curve, std::size_t places) {
        return try_plain(curve, places);
    };
    const std::size_t few = places_ / 4;
    const auto search = [&](const MaskCurve& curve) {
        return refine(plain, curve, 32.0f, 12, few);
    };
    const auto mean_at = [&](std::size_t i) { return level.texels[i]; };
    gather(mean_at, level.width, level.height);
    if (is_near(plain({}, places_), places_)) return {};
    Fit best = search({});
    if (!is_near(best.miss, few)) {
        add_grain(level);
        gather(mean_at, level.width, level.height);
        best = search(kCurves[0]);
        for (std::size_t i = 1; i < kCurves.size() && !is_near(best.miss, few); ++i) {
            const Fit other = search(kCurves[i]);
            if (other.miss.worst() < best.miss.worst()) best = other;
        }
    }
    return refine(plain, best.curve, 1.5f, 6, places_).curve;
}

void MaskCoverage::store_next(Level& level, std::byte* out) {
    places_ = std::max(places_ / 2, kLeastPlaces);
    MaskCurve curve = choose(level);
    if (use_.blocks && level.texels.size() <= kMostInBlocks) {
        const Trial blocks = [&](const MaskCurve& tried, std::size_t places) {
            return try_blocks(level, tried, places);
        };
        curve = refine(blocks, curve, 1.2f, 5, places_).curve;
        blocks(curve, places_);
    } else {
        try_plain(curve, places_);
    }
    std::swap(finer_, current_);
    store(level.texels, curve, threshold_, out);
}

}  // namespace bake
