// Vectors whose new elements hold anything: for arrays that several threads fill in parallel.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

namespace bake {

inline constexpr std::size_t kHugePage = 2 << 20;

/// Asks the kernel for huge pages where the `size` bytes at `place` cover such, for they take far
/// less time to be touched first than as many bytes of ordinary ones. Does nothing for small
/// arrays: what stays untouched of the last page would be too much memory beside them.
void prefer_huge_pages(void* place, std::size_t size);

/// Gives the memory of an array back from its start on, in large pieces; for what is read once, in
/// order, before the array itself goes.
class PageReleaser {
 public:
    /// It goes in pieces of a few `unit`, a power of two and at least a page.
    explicit PageReleaser(std::span<std::byte> array, std::size_t unit = kHugePage)
        : array_(array), unit_(unit) {}
    /// What comes before `end`, in bytes, is never read again.
    void release(std::size_t end);

 private:
    std::span<std::byte> array_;
    std::size_t unit_;
    std::size_t released_ = 0;
};

/// Leaves elements as the memory is. So their pages are touched first by the thread that writes
/// them, not by the one that makes the array.
template <typename T>
struct RawAllocator : std::allocator<T> {
    static_assert(std::is_trivially_copyable_v<T>);

    template <typename Other>
    struct rebind {
        using other = RawAllocator<Other>;
    };
    T* allocate(std::size_t count) {
        T* const place = std::allocator<T>::allocate(count);
        prefer_huge_pages(place, count * sizeof(T));
        return place;
    }
    void construct(T*) noexcept {}
    template <typename... Args>
    void construct(T* place, Args&&... args) {
        std::construct_at(place, std::forward<Args>(args)...);
    }
};

template <typename T>
using RawVector = std::vector<T, RawAllocator<T>>;

}  // namespace bake
