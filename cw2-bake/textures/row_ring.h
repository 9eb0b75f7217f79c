// The rows around a row, for filters that look at neighbours.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

#include "cw2-bake/textures/mip_chain.h"

namespace bake {

/// Coordinate `at + step` of `extent`, repeated or clamped.
inline std::uint32_t neighbour(std::uint32_t at, int step, std::uint32_t extent, bool clamp) {
    const std::int64_t moved = std::int64_t{at} + step;
    return static_cast<std::uint32_t>(clamp ? std::clamp<std::int64_t>(moved, 0, extent - 1)
                                            : (moved + extent) % extent);
}

/// Keeps the three rows last read, so that going down an image reads each row once.
class RowRing {
 public:
    RowRing(TexelSource source, bool clamp) : source_(std::move(source)), clamp_(clamp) {
        for (Slot& slot : slots_) {
            slot.texels.resize(std::size_t{source_.width} * source_.channels);
        }
    }

    /// Row y + step, step in -1..1; valid while only the rows y - 1, y and y + 1 are asked for.
    const float* row(std::uint32_t y, int step) {
        const std::int64_t wanted = std::int64_t{y} + step;
        Slot& slot = slots_[static_cast<std::size_t>((wanted + 3) % 3)];
        if (slot.y != wanted) {
            source_.read_row(neighbour(y, step, source_.height, clamp_), slot.texels);
            slot.y = wanted;
        }
        return slot.texels.data();
    }

 private:
    struct Slot {
        std::int64_t y = -2;
        std::vector<float> texels;
    };
    TexelSource source_;
    bool clamp_;
    std::array<Slot, 3> slots_;
};

}  // namespace bake
