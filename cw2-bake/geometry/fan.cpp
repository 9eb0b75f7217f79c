#include "cw2-bake/geometry/fan.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <glm/geometric.hpp>
#include <iterator>

#include "common/every_cpu.h"

namespace bake {

/// Whether all faces hang together across their edges at the vertex, none of which has more than
/// two.
CW2_EVERY_CPU bool Fan::hangs_together() const {
    using Few = std::uint32_t __attribute__((vector_size(4 * kFew)));
    Few from;
    std::memcpy(&from, previous_, sizeof(from));
    // Bit i of candidates[j], whether j arrives from where i leaves to.
    Few candidates{};
    Few bit = Few{} + 1;
    for (std::size_t i = 0; i < count_; ++i) {
        candidates |= (from == Few{} + next_[i]) & bit;
        bit += bit;
    }
    constexpr std::size_t kNobody = kFew;
    std::uint8_t behind[kFew + 1];
    std::fill(std::begin(behind), std::end(behind), kNobody);
    std::uint32_t doubts = 0;
    std::uint32_t ends = 0;
    std::size_t start = 0;
    for (std::size_t j = 0; j < count_; ++j) {
        const std::uint32_t matches = candidates[j];
        const bool is_end = matches == 0;
        doubts |= matches & (matches - 1);
        behind[std::countr_zero(matches | 1u << kNobody)] = static_cast<std::uint8_t>(j);
        ends += is_end;
        start = is_end ? j : start;
    }
    if (doubts != 0 || ends > 1) return false;
    std::size_t at = start;
    for (std::size_t step = 1; step < count_; ++step) {
        at = behind[at];
        if (at == start || at == kNobody) return false;
    }
    return ends == 1 || behind[at] == start;
}

std::optional<glm::vec4> Fan::tangent() const {
    if (count_ == 0 || count_ > kFew || !in_order_ || usable_ != count_ ||
        (preserving_ != 0 && preserving_ != count_))
        return std::nullopt;
    // Two opposite ones would leave count - 2 at most of these sums of unit vectors.
    const float enough = std::max(static_cast<float>(count_) - 1.9f, 0.0f);
    if (glm::dot(s_, s_) < enough * enough || glm::dot(t_, t_) < enough * enough ||
        !hangs_together())
        return std::nullopt;
    const glm::vec3 unit = unit_or_zero(weighted_s_);
    if (!is_unit(unit)) return std::nullopt;
    return glm::vec4(unit, preserving_ != 0 ? 1.0f : -1.0f);
}

}  // namespace bake
