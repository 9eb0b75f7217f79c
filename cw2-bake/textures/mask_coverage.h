// How much an alpha mask shows at each level, and what keeps it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "cw2-bake/textures/mip_chain.h"

namespace bake {

/// What becomes of a texel's mean: times `scale`; then its distance to the threshold times `above`
/// or, below it, `below`; then cut to [0, 1].
struct MaskCurve {
    float scale = 1.0f;
    float above = 1.0f;
    float below = 1.0f;
};

/// Makes the levels of one mask, the largest first, and watches what a trilinear sampler shows of
/// them: the share of the area that is at or above the threshold, at each level and between it and
/// the one before. Both count, since a mean of two levels shows less, or more, than either where
/// their details do not meet.
class MaskCoverage {
 public:
    /// `texels`: level 0 as it is stored without blocks.
    MaskCoverage(std::span<const std::byte> texels, std::uint32_t width, std::uint32_t height,
                 const MaskUse& use);

    /// Writes to `out` the bytes of the next level, of which `level` has the means. It shows what
    /// level 0 shows, as near as its texels allow: the means as they are, if that is within 2 %,
    /// or else the curve of theirs that is nearest. `level` is left changed.
    void store_next(Level& level, std::byte* out);

 private:
    /// The texels around each place; one array a member, so that loops over places become vectors.
    struct Corners {
        std::array<std::vector<float>, 4> texels;
        std::vector<float> across;
        std::vector<float> down;
    };
    /// How far the numbers of shown places are from the wanted one, over all blends of two levels.
    struct Miss {
        std::int64_t least;
        std::int64_t most;

        std::int64_t worst() const { return most > -least ? most : -least; }
    };
    struct Fit {
        MaskCurve curve;
        Miss miss;
    };
    /// What a curve makes of a level, looked at in the first `places` places.
    using Trial = std::function<Miss(const MaskCurve& curve, std::size_t places)>;

    template <typename TexelAt>
    void gather(const TexelAt& texel_at, std::uint32_t width, std::uint32_t height);
    Miss try_plain(const MaskCurve& curve, std::size_t places);
    Miss try_blocks(const Level& level, const MaskCurve& curve, std::size_t places);
    Fit refine(const Trial& trial, MaskCurve curve, float reach, int steps, std::size_t places);
    MaskCurve choose(Level& level);
    std::int64_t wanted(std::size_t places) const;
    bool is_near(const Miss& miss, std::size_t places) const;

    MaskUse use_;
    bool hidden_beyond_;  ///< the edges, where it clamps
    float threshold_;
    std::size_t places_;          ///< in use; the first few of them are spread evenly, too
    double share_ = 0.0;          ///< of level 0 that is shown
    Corners corners_;             ///< of the level at work
    std::vector<float> finer_;    ///< what the level before has at each place
    std::vector<float> current_;  ///< what the level at work has under the curve last tried
};

}  // namespace bake
