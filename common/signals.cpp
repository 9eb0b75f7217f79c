#include "common/signals.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <utility>
#include <vector>

#include "common/io.h"

namespace common {

namespace {

struct Mapping {
    std::span<const std::byte> bytes;
    std::string message;
};

std::atomic_flag locked;
pid_t owner = 0;  // a child that has not become another program yet must remove nothing
std::string program_name;
std::vector<std::string> temporaries;
std::vector<Mapping> mappings;
pid_t noted_child = 0;

void acquire() {
    while (locked.test_and_set(std::memory_order_acquire)) ::usleep(10);
}

/// The one way to change what is noted. No handler runs on a thread that holds it; so one that
/// waits for it does so for another thread.
class Lock {
 public:
    Lock() {
        sigset_t all;
        ::sigfillset(&all);
        ::pthread_sigmask(SIG_BLOCK, &all, &before_);
        acquire();
    }
    ~Lock() {
        locked.clear(std::memory_order_release);
        ::pthread_sigmask(SIG_SETMASK, &before_, nullptr);
    }
    Lock(const Lock&) = delete;
    Lock& operator=(const Lock&) = delete;

 private:
    sigset_t before_;
};

bool remove_path(const char* path) {
    return ::unlink(path) == 0 || (errno == EISDIR && ::rmdir(path) == 0) || errno == ENOENT;
}

/// For handlers, which hold the lock until the program ends.
void remove_all() {
    if (noted_child > 0 && ::kill(noted_child, SIGTERM) == 0)
        while (::waitpid(noted_child, nullptr, 0) < 0 && errno == EINTR) continue;
    for (auto path = temporaries.rbegin(); path != temporaries.rend(); ++path)
        remove_path(path->c_str());
}

void on_end(int signal) {
    if (::getpid() == owner) {
        acquire();
        remove_all();
    }
    ::signal(signal, SIG_DFL);
    ::raise(signal);  // comes once this handler has returned
}

void on_bus_error(int signal, siginfo_t* info, void*) {
    const auto* const address = static_cast<const std::byte*>(info->si_addr);
    if (::getpid() == owner) {
        acquire();
        for (const Mapping& mapping : mappings) {
            const std::byte* const begin = mapping.bytes.data();
            if (address < begin || address >= begin + mapping.bytes.size()) continue;
            remove_all();
            [[maybe_unused]] const ssize_t ignored =
                ::write(STDERR_FILENO, mapping.message.data(), mapping.message.size());
            ::_exit(1);
        }
    }
    ::signal(signal, SIG_DFL);
    ::raise(signal);
}

/// Libraries that cannot make a thread throw where nobody can catch it.
void on_terminate() {
    const std::exception_ptr thrown = std::current_exception();
    if (!thrown) std::abort();
    try {
        std::rethrow_exception(thrown);
    } catch (const std::exception& error) {
        const Lock lock;
        if (::getpid() == owner) remove_all();
        tell(program_name, error.what());
        ::_exit(1);
    } catch (...) {
        std::abort();
    }
}

}  // namespace

void handle_signals(const char* program) {
    int descriptor = ::open("/dev/null", O_RDWR);
    while (descriptor >= 0 && descriptor <= STDERR_FILENO) descriptor = ::dup(descriptor);
    if (descriptor >= 0) ::close(descriptor);

    owner = ::getpid();
    program_name = program;
    struct sigaction action {};
    ::sigfillset(&action.sa_mask);
    action.sa_handler = on_end;
    for (const int signal : {SIGHUP, SIGINT, SIGQUIT, SIGABRT, SIGPIPE, SIGTERM, SIGXCPU}) {
        struct sigaction before {};
        ::sigaction(signal, nullptr, &before);
        if (before.sa_handler != SIG_IGN) ::sigaction(signal, &action, nullptr);
    }
    action.sa_flags = SA_SIGINFO;
    action.sa_sigaction = on_bus_error;
    ::sigaction(SIGBUS, &action, nullptr);
    ::signal(SIGXFSZ, SIG_IGN);
    std::set_terminate(on_terminate);
}

int create_temporary(const std::string& path, mode_t mode) {
    const Lock lock;
    temporaries.emplace_back().reserve(path.size());  // nothing may fail once the file is there
    const int descriptor = ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, mode);
    const int cause = errno;
    if (descriptor >= 0) {
        temporaries.back() = path;
    } else {
        temporaries.pop_back();
    }
    errno = cause;
    return descriptor;
}

void note_temporary(const std::string& path) {
    const Lock lock;
    temporaries.push_back(path);
}

bool remove_temporary(const std::string& path) {
    const Lock lock;
    std::erase(temporaries, path);
    return remove_path(path.c_str());
}

void note_child(pid_t child) {
    const Lock lock;
    noted_child = child;
}

void guard_mapping(std::span<const std::byte> bytes, const std::string& path) {
    std::string message =
        program_name + ": " + one_line(path) + ": became shorter while it was read\n";
    const Lock lock;
    mappings.push_back({bytes, std::move(message)});
}

void unguard_mapping(std::span<const std::byte> bytes) {
    const Lock lock;
    std::erase_if(mappings,
                  [&](const Mapping& mapping) { return mapping.bytes.data() == bytes.data(); });
}

}  // namespace common
