#include "common/large_memory.h"

#include <malloc.h>
#include <sys/mman.h>
#include <unistd.h>

#include <cstdint>
#include <cstdlib>

namespace common {

namespace {

constexpr int kHeapGrowth = 4 << 20;

void advise_huge_pages(std::uintptr_t begin, std::uintptr_t end) {
    begin = (begin + kHugePage - 1) / kHugePage * kHugePage;
    end = end / kHugePage * kHugePage;
    // Where there are none, all stays as it is.
    if (begin < end) ::madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
}

}  // namespace

void prefer_huge_pages(void* place, std::size_t size) {
    constexpr std::size_t kWorthwhile = 12 << 20;
    if (size < kWorthwhile) return;
    const auto begin = reinterpret_cast<std::uintptr_t>(place);
    advise_huge_pages(begin, begin + size);
}

void keep_heap(int largest) {
    ::mallopt(M_ARENA_MAX, 1);
    ::mallopt(M_MMAP_THRESHOLD, largest);
    ::mallopt(M_TRIM_THRESHOLD, 1 << 30);
    ::mallopt(M_TOP_PAD, kHeapGrowth);
}

void prefer_huge_heap(int bytes) {
    // What the kernel adds to a heap is ordinary again.
    ::mallopt(M_TOP_PAD, bytes);
    void* const first = std::malloc(kHeapGrowth);
    ::mallopt(M_TOP_PAD, kHeapGrowth);
    if (first != nullptr)
        advise_huge_pages(reinterpret_cast<std::uintptr_t>(first),
                          reinterpret_cast<std::uintptr_t>(::sbrk(0)));
    std::free(first);
}

}  // namespace common
