// Which of many values are equal, told by hashing.
#pragma once

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <functional>
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

/// For each of some values the first that is equal to it.
class FirstEqual {
 public:
    /// Of fewer than 2^31 values. No component is -0 or NaN, so that equal bits are equal values.
    template <typename Vector>
    explicit FirstEqual(const std::vector<Vector>& values);

    bool all_differ() const { return first_.empty(); }
    std::uint32_t operator[](std::uint32_t i) const { return first_.empty() ? i : first_[i]; }

 private:
    /// The place of each value's slot among those of its part is the low half of its hash.
    template <typename Vector>
    static std::uint64_t hash(const Vector& value) {
        if constexpr (Vector::length() == 2)
            return hash_of(value.x, value.y);
        else
            return hash_of(value.x, value.y, value.z);
    }
    template <typename Vector>
    bool find(const std::vector<Vector>& values, std::uint32_t part, std::uint32_t parts,
              std::span<std::uint32_t> slots);
    static std::uint32_t part_of(std::uint64_t hash, std::uint32_t parts) {
        return static_cast<std::uint32_t>((hash >> 48) * parts >> 16);
    }

    RawVector<std::uint32_t> first_;  // empty where no two are equal
};

/// A slot holds an index, and above it the upper bits of the hash. The first of equal values is
/// found as all of a part are met in their order. Returns whether any two are equal.
template <typename Vector>
bool FirstEqual::find(const std::vector<Vector>& values, std::uint32_t part, std::uint32_t parts,
                      std::span<std::uint32_t> slots) {
    // More than the last index: no slot in use has all bits set.
    constexpr std::uint32_t kEmpty = 0xFFFF'FFFF;
    const auto index_bits = static_cast<std::uint32_t>(std::bit_ceil(values.size() + 1) - 1);
    std::ranges::fill(slots, kEmpty);
    const auto place_of = [&](std::uint64_t hashed) {
        return (hashed & 0xFFFF'FFFF) * slots.size() >> 32;
    };
    const auto find_or_insert = [&](std::uint64_t hashed, std::uint32_t index) {
        const std::uint32_t tag = static_cast<std::uint32_t>(hashed >> 32) & ~index_bits;
        for (std::size_t place = place_of(hashed);; ++place) {
            if (place == slots.size()) place = 0;
            const std::uint32_t slot = slots[place];
            if (slot == kEmpty) {
                slots[place] = tag | index;
                return index;
            }
            const std::uint32_t other = slot & index_bits;
            if ((slot & ~index_bits) == tag && values[other] == values[index]) return other;
        }
    };
    // The slots are too many for caches: memory is asked for some values ahead.
    constexpr std::size_t kAhead = 16;
    struct Waiting {
        std::uint64_t hashed;
        std::uint32_t index;
    };
    std::array<Waiting, kAhead> waiting;
    std::size_t met = 0;
    bool some_are_equal = false;
    const auto settle = [&](const Waiting& one) {
        first_[one.index] = find_or_insert(one.hashed, one.index);
        some_are_equal |= first_[one.index] != one.index;
    };
    const auto count = static_cast<std::uint32_t>(values.size());
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint64_t hashed = hash(values[i]);
        if (parts > 1 && part_of(hashed, parts) != part) continue;
        Waiting& place = waiting[met % kAhead];
        if (met++ >= kAhead) settle(place);
        place = {hashed, i};
        __builtin_prefetch(&slots[place_of(hashed)]);
    }
    for (std::size_t i = met - std::min(met, kAhead); i < met; ++i) settle(waiting[i % kAhead]);
    return some_are_equal;
}

/// Values of one part of the hashes each are told apart by one task.
template <typename Vector>
FirstEqual::FirstEqual(const std::vector<Vector>& values) : first_(values.size()) {
    constexpr std::size_t kWorthATask = 1 << 14;
    const auto parts = static_cast<std::uint32_t>(std::clamp<std::size_t>(
        values.size() / kWorthATask, 1,
        tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism)));
    std::vector<std::uint32_t> counts(parts * parts);  // by task and part
    tbb::parallel_for(std::uint32_t{0}, parts > 1 ? parts : 0, [&](std::uint32_t task) {
        std::vector<std::uint32_t> own(parts);
        const std::size_t begin = values.size() * task / parts;
        const std::size_t end = values.size() * (task + 1) / parts;
        for (std::size_t i = begin; i < end; ++i) ++own[part_of(hash(values[i]), parts)];
        std::ranges::copy(own, counts.begin() + task * parts);
    });
    if (parts == 1) counts[0] = static_cast<std::uint32_t>(values.size());
    std::vector<std::size_t> first_slot(parts + 1);
    for (std::uint32_t part = 0; part < parts; ++part) {
        std::size_t count = 0;
        for (std::uint32_t task = 0; task < parts; ++task) count += counts[task * parts + part];
        first_slot[part + 1] = first_slot[part] + count * 3 / 2 + 4;
    }
    RawVector<std::uint32_t> slots(first_slot[parts]);
    std::vector<char> some_are_equal(parts);
    tbb::parallel_for(std::uint32_t{0}, parts, [&](std::uint32_t part) {
        some_are_equal[part] = find(
            values, part, parts,
            std::span(slots).subspan(first_slot[part], first_slot[part + 1] - first_slot[part]));
    });
    if (std::ranges::none_of(some_are_equal, std::identity()))
        RawVector<std::uint32_t>().swap(first_);
}

}  // namespace bake
