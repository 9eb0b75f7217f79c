#include "common/huge_pages.h"

#include <sys/mman.h>

#include <cstdint>

namespace common {

void prefer_huge_pages(void* place, std::size_t size) {
    constexpr std::size_t kWorthwhile = 12 << 20;
    if (size < kWorthwhile) return;
    const auto address = reinterpret_cast<std::uintptr_t>(place);
    const std::uintptr_t begin = (address + kHugePage - 1) / kHugePage * kHugePage;
    const std::uintptr_t end = (address + size) / kHugePage * kHugePage;
    // Where there are none, all stays as it is.
    ::madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
}

}  // namespace common
