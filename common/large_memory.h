// Memory that is touched in less time: huge pages, and a heap that keeps its own.
#pragma once

#include <cstddef>

namespace common {

constexpr std::size_t kHugePage = 2 << 20;

/// Asks the kernel for huge pages where the `size` bytes at `place` cover such, for they take far
/// less time to be touched first than as many bytes of ordinary ones. Does nothing for small
/// arrays: what stays untouched of the last page would be too much memory beside them.
void prefer_huge_pages(void* place, std::size_t size);

/// One heap for all threads, which keeps what it has got but for blocks of more than `largest`
/// bytes, 32 MiB at most: for programs that are over soon, and make much, one after the other.
void keep_heap(int largest);

/// Lets what that heap grows by, up to so many bytes, lie on huge pages; what nobody touches of
/// them costs nothing. Called while there is one thread.
void prefer_huge_heap(int bytes);

}  // namespace common
