#include "cw2-bake/base/raw_vector.h"

#include <sys/mman.h>

#include <cstdint>

namespace bake {
namespace {

std::uintptr_t address_of(const void* place) {
    return reinterpret_cast<std::uintptr_t>(place);
}

}  // namespace

void prefer_huge_pages(void* place, std::size_t size) {
    constexpr std::size_t kWorthwhile = 12 << 20;
    if (size < kWorthwhile) return;
    const auto address = address_of(place);
    const std::uintptr_t begin = (address + kHugePage - 1) / kHugePage * kHugePage;
    const std::uintptr_t end = (address + size) / kHugePage * kHugePage;
    // Where there are none, all stays as it is.
    ::madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
}

void PageReleaser::release(std::size_t end) {
    if (end - released_ < 2 * unit_) return;
    const auto whole = [&](std::size_t at) {
        const std::uintptr_t address = address_of(array_.data());
        return (address + at + unit_ - 1) / unit_ * unit_ - address;
    };
    const std::size_t from = whole(released_);
    const std::size_t to = whole(end) - unit_;
    ::madvise(array_.data() + from, to - from, MADV_DONTNEED);
    released_ = to;
}

}  // namespace bake
