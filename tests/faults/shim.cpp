// Preloaded into a program under test: makes one of its allocations fail, or one of the calls with
// which it writes files. Counts from the start of main(); of allocations not those that TBB and the
// loader make for themselves, which hang or end the program where they fail; of writes only those
// to files.
//
// FAULT_ALLOCATION=N or FAULT_WRITE=N: the N-th, from 1, fails; with FAULT_FROM_THEN_ON, all after
// it, too. FAULT_COUNT=FILE: writes how many there were of both to FILE at the end.
#include <dlfcn.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <new>

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* place, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
}

#define CALLER __builtin_return_address(0)

namespace {

/// Of calls of one kind.
struct Fault {
    std::atomic<long> count = 0;
    long at = 0;

    bool strikes();
};

bool has_begun = false;
bool goes_on = false;
Fault allocations, writes;

bool Fault::strikes() {
    if (!has_begun) return false;
    const long number = ++count;
    return at > 0 && (number == at || (goes_on && number > at));
}

long number_in(const char* variable) {
    const char* const text = std::getenv(variable);
    return text ? std::atol(text) : 0;
}

void tell_counts() {
    const char* const path = std::getenv("FAULT_COUNT");
    has_begun = false;
    FILE* const file = path ? std::fopen(path, "w") : nullptr;
    if (!file) return;
    std::fprintf(file, "%ld %ld\n", allocations.count.load(), writes.count.load());
    std::fclose(file);
}

using Main = int(int, char**, char**);
Main* program = nullptr;

int begin(int argc, char** argv, char** environment) {
    allocations.at = number_in("FAULT_ALLOCATION");
    writes.at = number_in("FAULT_WRITE");
    goes_on = std::getenv("FAULT_FROM_THEN_ON") != nullptr;
    std::atexit(tell_counts);
    has_begun = true;
    return program(argc, argv, environment);
}

bool is_of_library(const void* caller) {
    Dl_info info{};
    if (dladdr(caller, &info) == 0 || !info.dli_fname) return false;
    return std::strstr(info.dli_fname, "/libtbb") || std::strstr(info.dli_fname, "/ld-linux") ||
           std::strstr(info.dli_fname, "/libc.so");
}

/// Sets errno and says so where an allocation is to fail.
bool lacks_memory(const void* caller) {
    if (!has_begun || is_of_library(caller) || !allocations.strikes()) return false;
    errno = ENOMEM;
    return true;
}

void* allocate(const void* caller, std::size_t alignment, std::size_t size) {
    void* const place = lacks_memory(caller) ? nullptr : __libc_memalign(alignment, size);
    if (!place) throw std::bad_alloc();
    return place;
}

bool disk_is_full() {
    if (!writes.strikes()) return false;
    errno = ENOSPC;
    return true;
}

template <typename Function>
Function* original(const char* name) {
    return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

int __libc_start_main(Main* main, int argc, char** argv, Main* init, void (*fini)(),
                      void (*rtld_fini)(), void* stack_end) {
    program = main;
    using Start = int(Main*, int, char**, Main*, void (*)(), void (*)(), void*);
    return original<Start>("__libc_start_main")(begin, argc, argv, init, fini, rtld_fini,
                                                stack_end);
}

void* malloc(std::size_t size) {
    return lacks_memory(CALLER) ? nullptr : __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
    return lacks_memory(CALLER) ? nullptr : __libc_calloc(count, size);
}
void* realloc(void* place, std::size_t size) {
    return lacks_memory(CALLER) ? nullptr : __libc_realloc(place, size);
}
void* memalign(std::size_t alignment, std::size_t size) {
    return lacks_memory(CALLER) ? nullptr : __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
    return lacks_memory(CALLER) ? nullptr : __libc_memalign(alignment, size);
}
int posix_memalign(void** place, std::size_t alignment, std::size_t size) {
    *place = lacks_memory(CALLER) ? nullptr : __libc_memalign(alignment, size);
    return *place ? 0 : ENOMEM;
}

ssize_t write(int descriptor, const void* bytes, std::size_t size) {
    static auto* const next = original<ssize_t(int, const void*, std::size_t)>("write");
    struct stat status {};
    const bool to_file =
        descriptor > STDERR_FILENO && ::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
    return to_file && disk_is_full() ? -1 : next(descriptor, bytes, size);
}
int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) {
    static auto* const next =
        original<int(int, const char*, int, const char*, unsigned)>("renameat2");
    return disk_is_full() ? -1 : next(from_folder, from, to_folder, to, flags);
}
int rename(const char* from, const char* to) {
    static auto* const next = original<int(const char*, const char*)>("rename");
    return disk_is_full() ? -1 : next(from, to);
}
int fchmod(int descriptor, mode_t mode) {
    static auto* const next = original<int(int, mode_t)>("fchmod");
    return disk_is_full() ? -1 : next(descriptor, mode);
}
int flock(int descriptor, int operation) {
    static auto* const next = original<int(int, int)>("flock");
    return disk_is_full() ? -1 : next(descriptor, operation);
}
/// Of files to be written only.
int open(const char* path, int flags, ...) {
    static auto* const next = original<int(const char*, int, ...)>("open");
    va_list more;
    va_start(more, flags);
    const auto mode = va_arg(more, mode_t);
    va_end(more);
    constexpr int kWrites =
        0101;  // O_WRONLY, O_CREAT; of <fcntl.h>, which declares open() otherwise
    return (flags & kWrites) != 0 && disk_is_full() ? -1 : next(path, flags, mode);
}

}  // extern "C"

// Those of the library would hide who calls.
void* operator new(std::size_t size) {
    return allocate(CALLER, alignof(std::max_align_t), size);
}
void* operator new[](std::size_t size) {
    return allocate(CALLER, alignof(std::max_align_t), size);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
    return allocate(CALLER, static_cast<std::size_t>(alignment), size);
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
    return allocate(CALLER, static_cast<std::size_t>(alignment), size);
}
void operator delete(void* place) noexcept {
    std::free(place);
}
void operator delete(void* place, std::size_t) noexcept {
    std::free(place);
}
