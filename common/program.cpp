#include "common/program.h"

namespace common {

std::filesystem::path beside_program(const std::filesystem::path& path) {
    const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe");
    return std::filesystem::weakly_canonical(program.parent_path() / path);
}

}  // namespace common
