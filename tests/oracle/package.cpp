#include "tests/oracle/package.h"

#include <cstdlib>
#include <fstream>
#include <stdexcept>

namespace oracle {
namespace {

template <typename T>
void write(std::ofstream& file, const std::vector<T>& values) {
    file.write(reinterpret_cast<const char*>(values.data()),
               static_cast<std::streamsize>(values.size() * sizeof(T)));
}

std::string argument(const std::filesystem::path& path) {
    return " \"" + path.string() + '"';
}

}  // namespace

PackageResult run_package(const Package& package, const std::vector<CornerMesh>& meshes,
                          const std::filesystem::path& work_dir) {
    const std::filesystem::path input = work_dir / "meshes.bin";
    const std::filesystem::path output = work_dir / "tangents.bin";
    const std::filesystem::path times = work_dir / "times.txt";
    std::ofstream file(input, std::ios::binary);
    for (const CornerMesh& mesh : meshes) {
        write(file, std::vector{static_cast<std::uint32_t>(mesh.positions.size())});
        write(file, mesh.positions);
        write(file, mesh.normals);
        write(file, mesh.uvs);
    }
    file.close();
    const std::string command = argument(package.node) + argument(package.script) +
                                argument(package.dir) + argument(input) + argument(output) + " >" +
                                argument(times);
    if (std::system(command.c_str()) != 0) throw std::runtime_error("failed:" + command);

    PackageResult result;
    std::ifstream tangents(output, std::ios::binary);
    std::ifstream lines(times);
    for (const CornerMesh& mesh : meshes) {
        Tangents& of_mesh = result.tangents.emplace_back(mesh.positions.size());
        tangents.read(reinterpret_cast<char*>(of_mesh.data()),
                      static_cast<std::streamsize>(of_mesh.size() * sizeof(of_mesh[0])));
        std::size_t corners = 0;
        lines >> corners >> result.milliseconds.emplace_back();
        if (!tangents || !lines || corners != mesh.positions.size())
            throw std::runtime_error("too little came back from:" + command);
    }
    return result;
}

}  // namespace oracle
