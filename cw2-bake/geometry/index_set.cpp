#include "cw2-bake/geometry/index_set.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <numeric>

namespace bake {
namespace {

/// The place of each value's slot among those of its part is the low half of its hash.
std::uint64_t hash(const glm::vec3& value) {
    return hash_of(value.x, value.y, value.z);
}

std::uint32_t part_of(std::uint64_t hashed, std::uint32_t parts) {
    return static_cast<std::uint32_t>((hashed >> 48) * parts >> 16);
}

}  // namespace

/// A slot holds an index, and above it the upper bits of the hash. The first of equal values is
/// found as all of a part are met in their order. Returns how many differ.
std::size_t FirstEqual::find(const std::vector<glm::vec3>& values, std::uint32_t part,
                             std::uint32_t parts, std::span<std::uint32_t> slots) {
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
    // The slots are too many for caches: memory is asked for a batch ahead.
    constexpr std::size_t kBatch = 32;
    struct Waiting {
        std::uint64_t hashed;
        std::uint32_t index;
    };
    std::array<Waiting, kBatch + 1> waiting;  // one more is written and not kept
    std::size_t differ = 0;
    const auto settle = [&](std::size_t count) {
        for (std::size_t i = 0; i < count; ++i)
            __builtin_prefetch(&slots[place_of(waiting[i].hashed)]);
        for (std::size_t i = 0; i < count; ++i) {
            const std::uint32_t index = waiting[i].index;
            first_[index] = find_or_insert(waiting[i].hashed, index);
            differ += first_[index] == index;
        }
    };
    std::size_t kept = 0;
    const auto count = static_cast<std::uint32_t>(values.size());
    for (std::uint32_t i = 0; i < count; ++i) {
        const std::uint64_t hashed = hash(values[i]);
        // Without a branch on what no processor foresees.
        waiting[kept] = {hashed, i};
        kept += part_of(hashed, parts) == part;
        if (kept < kBatch) continue;
        settle(kept);
        kept = 0;
    }
    settle(kept);
    return differ;
}

/// Values of one part of the hashes each are told apart by one task.
FirstEqual::FirstEqual(const std::vector<glm::vec3>& values) : first_(values.size()) {
    constexpr std::size_t kWorthATask = 1 << 15;
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
    std::vector<std::size_t> differ(parts);
    tbb::parallel_for(std::uint32_t{0}, parts, [&](std::uint32_t part) {
        differ[part] = find(
            values, part, parts,
            std::span(slots).subspan(first_slot[part], first_slot[part + 1] - first_slot[part]));
    });
    count_ = std::reduce(differ.begin(), differ.end());
    if (count_ == values.size()) RawVector<std::uint32_t>().swap(first_);
}

}  // namespace bake
