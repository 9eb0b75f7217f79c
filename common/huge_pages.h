// Large arrays on huge pages.
#pragma once

#include <cstddef>

namespace common {

constexpr std::size_t kHugePage = 2 << 20;

/// Asks the kernel for huge pages where the `size` bytes at `place` cover such, for they take far
/// less time to be touched first than as many bytes of ordinary ones. Does nothing for small
/// arrays: what stays untouched of the last page would be too much memory beside them.
void prefer_huge_pages(void* place, std::size_t size);

}  // namespace common
