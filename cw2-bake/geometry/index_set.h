// Which of many values are equal, told by hashing.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <glm/vec3.hpp>
#include <span>
#include <vector>

#include "cw2-bake/base/raw_vector.h"

namespace bake {

/// Spreads the words of a value over 64 bits.
template <typename... Words>
std::uint64_t hash_of(Words... words) {
    std::uint64_t hash = 0;
    const auto mix = [&](std::uint32_t word) {
        hash = (hash ^ word) * 0x9E37'79B9'7F4A'7C15;  // 2^64 over the golden ratio
        hash ^= hash >> 32;
    };
    (mix(std::bit_cast<std::uint32_t>(words)), ...);
    return hash;
}

/// Counts numbers, at most some ten thousand, that differ; some few of one hash count as one.
class DistinctCount {
 public:
    void add(std::uint32_t number) {
        const std::uint32_t hash = number * 0x9E37'79B9u >> (32 - kBits);
        count_ += !met_[hash];
        met_[hash] = true;
    }
    std::size_t count() const { return count_; }

 private:
    static constexpr int kBits = 17;
    std::vector<bool> met_ = std::vector<bool>(std::size_t{1} << kBits);
    std::size_t count_ = 0;
};

/// A set of values that someone else keeps in an array: holds their indices and hashes.
class IndexSet {
 public:
    explicit IndexSet(std::size_t expected) : slots_(std::bit_ceil(expected * 3 / 2 + 4)) {}

    /// The index of the value in the set for which `is_equal(index)` holds; `index`, which joins
    /// the set, if there is none.
    template <typename IsEqual>
    std::uint32_t find_or_insert(std::uint64_t hash, std::uint32_t index, IsEqual is_equal) {
        const auto tag = static_cast<std::uint32_t>(hash);
        std::size_t place = tag & (slots_.size() - 1);
        for (; slots_[place].index != kEmpty; place = (place + 1) & (slots_.size() - 1)) {
            if (slots_[place].tag == tag && is_equal(slots_[place].index)) {
                return slots_[place].index;
            }
        }
        slots_[place] = {tag, index};
        if (++size_ > slots_.size() / 4 * 3) grow();
        return index;
    }

 private:
    static constexpr std::uint32_t kEmpty = 0xFFFF'FFFF;
    struct Slot {
        std::uint32_t tag = 0;
        std::uint32_t index = kEmpty;
    };

    void grow() {
        std::vector<Slot> larger(slots_.size() * 2);
        for (const Slot& slot : slots_) {
            if (slot.index == kEmpty) continue;
            std::size_t place = slot.tag & (larger.size() - 1);
            while (larger[place].index != kEmpty) place = (place + 1) & (larger.size() - 1);
            larger[place] = slot;
        }
        slots_.swap(larger);
    }

    std::vector<Slot> slots_;  // a power of two
    std::size_t size_ = 0;
};

/// For each of some positions the first that is equal to it.
class FirstEqual {
 public:
    /// Of fewer than 2^31 positions. No component is -0 or NaN, so that equal bits are equal
    /// values.
    explicit FirstEqual(const std::vector<glm::vec3>& values);

    bool all_differ() const { return first_.empty(); }
    std::uint32_t operator[](std::uint32_t i) const { return first_.empty() ? i : first_[i]; }
    /// Of those that differ.
    std::size_t count() const { return count_; }

 private:
    std::size_t find(const std::vector<glm::vec3>& values, std::uint32_t part, std::uint32_t parts,
                     std::span<std::uint32_t> slots);

    RawVector<std::uint32_t> first_;  // empty where no two are equal
    std::size_t count_ = 0;
};

}  // namespace bake
