#include "common/program.h"

#include <dlfcn.h>

namespace common {

std::filesystem::path beside_program(const std::filesystem::path& path) {
    const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe");
    return std::filesystem::weakly_canonical(program.parent_path() / path);
}

void* load_symbol(const std::filesystem::path& path, const char* symbol, std::string& error) {
    // Lazy: binding every function of a module's libraries may take longer than what it is for.
    void* const module = dlopen(beside_program(path).c_str(), RTLD_LAZY | RTLD_LOCAL);
    void* const found = module ? dlsym(module, symbol) : nullptr;
    if (!found) error = dlerror();
    return found;
}

}  // namespace common
