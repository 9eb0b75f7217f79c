// Which of many values are equal, told by hashing.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

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

/// An IndexSet of values that each belong to one of `place_count` places, of which nearly all hold
/// few: those are chained, which keeps memory accesses close together, and only what exceeds
/// kMaxChain at one place is hashed. Indices join in the order 0, 1, 2, ...
class PlacedIndexSet {
 public:
    explicit PlacedIndexSet(std::size_t place_count) : head_(place_count, kNone), overflow_(0) {}

    /// As IndexSet::find_or_insert; the new index is the number of those in the set.
    template <typename IsEqual>
    std::uint32_t find_or_insert(std::uint32_t place, std::uint64_t hash, IsEqual is_equal) {
        const auto index = static_cast<std::uint32_t>(next_.size());
        int length = 0;
        for (std::uint32_t i = head_[place]; i != kNone; i = next_[i], ++length) {
            if (is_equal(i)) return i;
        }
        if (length == kMaxChain) {
            const std::uint32_t found = overflow_.find_or_insert(hash, index, is_equal);
            if (found == index) next_.push_back(kNone);
            return found;
        }
        next_.push_back(head_[place]);
        head_[place] = index;
        return index;
    }

 private:
    static constexpr std::uint32_t kNone = 0xFFFF'FFFF;
    static constexpr int kMaxChain = 24;
    std::vector<std::uint32_t> head_;  // by place
    std::vector<std::uint32_t> next_;  // by index
    IndexSet overflow_;
};

/// For each of fewer than 2^31 elements the index of the first that is equal to it. No component is
/// -0 or NaN, so that equal bits are equal values.
template <typename Vector>
std::vector<std::uint32_t> first_equal(std::span<const Vector> values) {
    const auto hash = [&](std::uint32_t i) {
        const Vector& value = values[i];
        if constexpr (Vector::length() == 2) {
            return hash_of(value.x, value.y);
        } else {
            return hash_of(value.x, value.y, value.z);
        }
    };
    // A slot holds an index, and above it the upper bits of the hash. More slots than values: no
    // index has all bits set.
    constexpr std::uint32_t kEmpty = 0xFFFF'FFFF;
    std::vector<std::uint32_t> slots(std::bit_ceil(values.size() * 3 / 2 + 4), kEmpty);
    const auto index_bits = static_cast<std::uint32_t>(slots.size() - 1);
    const auto find_or_insert = [&](std::uint64_t hashed, std::uint32_t index) {
        const std::uint32_t tag = static_cast<std::uint32_t>(hashed >> 32) & ~index_bits;
        std::uint32_t place = static_cast<std::uint32_t>(hashed) & index_bits;
        for (;; place = (place + 1) & index_bits) {
            const std::uint32_t slot = slots[place];
            if (slot == kEmpty) break;
            const std::uint32_t other = slot & index_bits;
            if ((slot & ~index_bits) == tag && values[other] == values[index]) return other;
        }
        slots[place] = tag | index;
        return index;
    };
    // The slots are too many for caches: memory is asked for some values ahead.
    constexpr std::uint32_t kAhead = 16;
    std::array<std::uint64_t, kAhead> hashes;
    std::vector<std::uint32_t> first(values.size());
    const auto count = static_cast<std::uint32_t>(values.size());
    for (std::uint32_t i = 0; i < count + kAhead; ++i) {
        if (i >= kAhead) {
            const std::uint32_t v = i - kAhead;
            first[v] = find_or_insert(hashes[v % kAhead], v);
        }
        if (i < count) {
            hashes[i % kAhead] = hash(i);
            __builtin_prefetch(&slots[static_cast<std::uint32_t>(hashes[i % kAhead]) & index_bits]);
        }
    }
    return first;
}

}  // namespace bake
