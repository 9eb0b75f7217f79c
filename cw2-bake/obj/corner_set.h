// A set of the corners of a polygon, in their order.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace bake {

/// Numbers below some count. Everything takes time in the logarithm of the count.
class CornerSet {
 public:
    static constexpr std::uint32_t kNone = 0xFFFF'FFFF;

    /// Empty, for numbers below `count`; keeps its memory.
    void clear(std::uint32_t count) {
        for (depth_ = 0; depth_ == 0 || count > 1; ++depth_) {
            count = (count + 63) / 64;
            levels_[depth_].assign(count, 0);
        }
    }

    void insert(std::uint32_t v) {
        for (std::size_t k = 0; k < depth_; ++k, v /= 64) {
            std::uint64_t& word = levels_[k][v / 64];
            const bool was_empty = word == 0;
            word |= std::uint64_t{1} << v % 64;
            if (!was_empty) return;
        }
    }

    void erase(std::uint32_t v) {
        for (std::size_t k = 0; k < depth_; ++k, v /= 64) {
            std::uint64_t& word = levels_[k][v / 64];
            word &= ~(std::uint64_t{1} << v % 64);
            if (word != 0) return;
        }
    }

    bool contains(std::uint32_t v) const { return (levels_[0][v / 64] >> v % 64 & 1) != 0; }

    /// The smallest that is at least v; kNone if there is none.
    std::uint32_t next(std::uint32_t v) const {
        for (std::size_t k = 0; k < depth_; ++k, v = v / 64 + 1) {
            if (v / 64 >= levels_[k].size()) return kNone;
            const std::uint64_t rest = levels_[k][v / 64] >> v % 64;
            if (rest == 0) continue;
            v += static_cast<std::uint32_t>(std::countr_zero(rest));
            while (k-- > 0) {
                v = v * 64 + static_cast<std::uint32_t>(std::countr_zero(levels_[k][v]));
            }
            return v;
        }
        return kNone;
    }

 private:
    /// A bit for each number; above it one for each word of the level below that is not 0; until
    /// one word is left. 64^6 is above 2^32.
    std::array<std::vector<std::uint64_t>, 6> levels_;
    std::size_t depth_ = 0;
};

}  // namespace bake
