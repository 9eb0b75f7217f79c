#include "cw2-bake/textures/block_reuse.h"

#include <array>
#include <bit>

#include "common/every_cpu.h"
#include "cw2-bake/textures/block_lanes.h"

namespace bake {
namespace {

// What a match saves of about 45 bits that a block takes, measured on roughness and metalness. One
// at the same distance as that of the block before only makes that one longer; another states its
// distance, each doubling of which beyond 32 blocks takes a bit more.
constexpr float kBitsOfRun = kMostBitsSaved;
constexpr float kBitsOfBlock = 30.0f;
constexpr float kBitsOfIndices = 17.0f;

/// How often 32 blocks are doubled to reach a distance, rounded down.
CW2_INLINE Floats doublings(Ints distance) {
    // The exponent.
    return to_floats((__builtin_bit_cast(Ints, to_floats(distance)) >> 23) - (127 + 5));
}
CW2_INLINE float doublings(std::int32_t distance) {
    return static_cast<float>(std::bit_width(static_cast<std::uint32_t>(distance))) - 6.0f;
}

/// What a match of that kind saves.
CW2_INLINE float bits_saved(bool indices_only, std::int32_t distance, std::int32_t run) {
    if (indices_only) return kBitsOfIndices - doublings(distance);
    return distance == run ? kBitsOfRun : kBitsOfBlock - doublings(distance);
}

/// What a block says: a texel is first - range * step / 7, rounded.
struct Block {
    std::int32_t first;
    std::int32_t second;
    std::array<std::int32_t, 16> steps;

    CW2_INLINE static Block unpacked(std::uint64_t bits) {
        Block block{};
        block.first = static_cast<std::int32_t>(bits & 255);
        block.second = static_cast<std::int32_t>(bits >> 8 & 255);
        for (std::uint32_t i = 0; i < 16; ++i) {
            const auto index = static_cast<std::int32_t>(bits >> (16 + 3 * i) & 7);
            block.steps[i] = index == 0 ? 0 : index == 1 ? 7 : index - 1;
        }
        return block;
    }
    CW2_INLINE std::int32_t error(const std::array<std::int32_t, 16>& values) const {
        std::int32_t sum = 0;
        for (std::size_t i = 0; i < 16; ++i) {
            const std::int32_t shown = first - (steps[i] * (first - second) + 3) / 7;
            sum += (values[i] - shown) * (values[i] - shown);
        }
        return sum;
    }
};

/// The texels of a block, and their sums.
struct Texels {
    std::array<std::int32_t, 16> values;
    float sum;
    float square;

    CW2_INLINE Texels(const PlainLevel& level, std::uint32_t left, std::uint32_t top) {
        std::int32_t whole = 0;
        std::int32_t squares = 0;
        for (std::size_t i = 0; i < 16; ++i) {
            const std::size_t at = (top + i / 4) * level.width + left + i % 4;
            values[i] = std::to_integer<std::int32_t>(level.texels[at]);
            whole += values[i];
            squares += values[i] * values[i];
        }
        sum = static_cast<float>(whole);
        square = static_cast<float>(squares);
    }
};

/// One of the recent blocks, as a choice for another.
struct Choice {
    float cost;  ///< about its error, less what the bits are worth that it saves
    std::uint32_t slot;
    bool indices_only;
};

/// The last different blocks, kLanes at a time. A block shows about first + range * w, w being a
/// texel's step in sevenths.
class RecentBlocks {
 public:
    /// Takes the place of the one that was put first.
    CW2_INLINE void put(std::uint64_t bits, std::int32_t place) {
        set(next_, bits, place);
        next_ = (next_ + 1) % kSlots;
    }
    /// The block of a choice is at this place, too, with these bits.
    CW2_INLINE void repeat(const Choice& choice, std::uint64_t bits, std::int32_t place) {
        if (choice.indices_only) return set(choice.slot, bits, place);
        groups_[choice.slot / kLanes].place[choice.slot % kLanes] = place;
    }
    std::uint64_t bits(std::uint32_t slot) const { return bits_[slot]; }
    std::int32_t place(std::uint32_t slot) const {
        return groups_[slot / kLanes].place[slot % kLanes];
    }

    /// The cheapest for the block at `place`, when the one before repeats what lies `run` blocks
    /// before it.
    CW2_INLINE Choice choose(const Texels& texels, std::int32_t place, std::int32_t run) const {
        Floats least = all(kNone);
        Ints kind{};
        for (std::uint32_t g = 0; g < kSlots / kLanes; ++g) {
            const Group& group = groups_[g];
            const Floats product = group.product(texels);
            const Ints distance = place - group.place;
            const Floats farther = doublings(distance);
            const Floats block_bits = distance == run ? all(kBitsOfRun) : kBitsOfBlock - farther;
            const Floats block = texels.square + group.square -
                                 2.0f * (group.first * texels.sum + group.range * product) -
                                 kErrorPerBit * block_bits;
            // The line that fits best leaves this beside it, and rounding about 1.
            const Floats slope = product - group.sum * (texels.sum * (1.0f / 16.0f));
            const Floats line = texels.square - texels.sum * texels.sum * (1.0f / 16.0f) + 1.0f -
                                slope * slope * group.inverse;
            const Ints falls = (slope < 0.0f) & (group.inverse > 0.0f);
            const Floats indices =
                falls ? line - kErrorPerBit * (kBitsOfIndices - farther) : all(kNone);
            const auto number = static_cast<std::int32_t>(2 * g);
            kind = block < least ? Ints{} + number : kind;
            least = smaller(least, block);
            kind = indices < least ? Ints{} + number + 1 : kind;
            least = smaller(least, indices);
        }
        Choice choice{kNone, 0, false};
        for (std::uint32_t lane = 0; lane < kLanes; ++lane) {
            if (least[lane] >= choice.cost) continue;
            const auto number = static_cast<std::uint32_t>(kind[lane]);
            choice = {least[lane], number / 2 * kLanes + lane, number % 2 != 0};
        }
        return choice;
    }

    /// The block with the indices of that in `slot` that fits best; that itself where none does.
    CW2_INLINE std::uint64_t fitted(const Texels& texels, std::uint32_t slot) const {
        const Group& group = groups_[slot / kLanes];
        const std::uint32_t lane = slot % kLanes;
        float product = 0.0f;
        for (std::size_t i = 0; i < 16; ++i)
            product += static_cast<float>(texels.values[i]) * group.w[i][lane];
        const float mean = texels.sum * (1.0f / 16.0f);
        const float range = (product - group.sum[lane] * mean) * group.inverse[lane];
        const float first = mean - range * group.sum[lane] * (1.0f / 16.0f);
        const auto to_byte = [](float value) {
            return static_cast<std::uint64_t>(std::clamp(value, 0.0f, 255.0f) + 0.5f);
        };
        const std::uint64_t from = to_byte(first);
        const std::uint64_t to = to_byte(first + range);
        return from > to ? (bits_[slot] >> 16 << 16) | from | to << 8 : bits_[slot];
    }

 private:
    static constexpr std::uint32_t kSlots = 32;
    static constexpr float kNone = 1e30f;

    struct Group {
        Floats w[16];
        Floats sum;
        Floats inverse;  ///< of the variance of w times 16; 0 where that is 0
        Floats first;
        Floats range;
        Floats square = all(kNone);  ///< the sum of the squares of what it shows; none is in use
        Ints place;

        CW2_INLINE Floats product(const Texels& texels) const {
            Floats sum_of{};
            for (std::size_t i = 0; i < 16; ++i)
                sum_of += w[i] * static_cast<float>(texels.values[i]);
            return sum_of;
        }
    };

    CW2_INLINE void set(std::uint32_t slot, std::uint64_t bits, std::int32_t place) {
        bits_[slot] = bits;
        Group& group = groups_[slot / kLanes];
        const std::uint32_t lane = slot % kLanes;
        const Block block = Block::unpacked(bits);
        float sum = 0.0f;
        float square = 0.0f;
        for (std::size_t i = 0; i < 16; ++i) {
            const float w = static_cast<float>(block.steps[i]) * (1.0f / 7.0f);
            group.w[i][lane] = w;
            sum += w;
            square += w * w;
        }
        const auto first = static_cast<float>(block.first);
        const auto range = static_cast<float>(block.second - block.first);
        const float variance = square - sum * sum * (1.0f / 16.0f);
        group.sum[lane] = sum;
        group.inverse[lane] = variance > 0.01f ? 1.0f / variance : 0.0f;
        group.first[lane] = first;
        group.range[lane] = range;
        group.square[lane] = 16.0f * first * first + range * (2.0f * first * sum + range * square);
        group.place[lane] = place;
    }

    std::array<Group, kSlots / kLanes> groups_{};
    std::array<std::uint64_t, kSlots> bits_{};
    std::uint32_t next_ = 0;
};

}  // namespace

CW2_EVERY_CPU double reuse_blocks(const PlainLevel& level, std::byte* blocks) {
    RecentBlocks recent;
    const std::uint32_t columns = (level.width + 3) / 4;
    std::int64_t added = 0;
    std::int32_t run = 0;
    for (std::uint32_t y = 0; y < level.height / 4; ++y) {
        for (std::uint32_t x = 0; x < level.width / 4; ++x) {
            const std::uint32_t number = y * columns + x;
            const auto place = static_cast<std::int32_t>(number);
            std::byte* const block = blocks + std::size_t{8} * number;
            std::uint64_t bits = 0;
            std::memcpy(&bits, block, sizeof bits);
            const Texels texels(level, 4 * x, 4 * y);
            const std::int32_t error = Block::unpacked(bits).error(texels.values);
            const Choice choice = recent.choose(texels, place, run);
            const std::int32_t distance = place - recent.place(choice.slot);
            const std::uint64_t other =
                choice.indices_only ? recent.fitted(texels, choice.slot) : recent.bits(choice.slot);
            const float worth = kErrorPerBit * bits_saved(choice.indices_only, distance, run);
            const std::int32_t other_error = Block::unpacked(other).error(texels.values);
            if (choice.cost < static_cast<float>(error) &&
                static_cast<float>(other_error - error) < worth) {
                std::memcpy(block, &other, sizeof other);
                added += other_error - error;
                recent.repeat(choice, other, place);
                run = choice.indices_only ? 0 : distance;
            } else {
                recent.put(bits, place);
                run = 0;
            }
        }
    }
    return static_cast<double>(added);
}

}  // namespace bake
