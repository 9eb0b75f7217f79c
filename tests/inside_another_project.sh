#!/usr/bin/env bash
# The project works inside another, by add_subdirectory and by FetchContent: there the library is built
# alone, and asks for no package; with CW2_PROGRAMS the programs can be built, too.
# Usage: inside_another_project.sh FOLDER, which is made and kept, so that the next run is short
set -euo pipefail
project=$(cd "$(dirname "$0")/.." && pwd)
mkdir -p "$1"
cat >"$1/main.cpp" <<'END_OF_FILE'
#include <mesh-format/file.h>

int main() {
    return mesh_format::Document().meshes.empty() ? 0 : 1;
}
END_OF_FILE

# outer NAME LINE...: a project that gets cw2 by these lines, and is configured.
outer() {
    local folder=$1
    shift
    mkdir -p "$folder"
    {
        printf '%s\n' 'cmake_minimum_required(VERSION 3.25)' 'project(outer LANGUAGES CXX)' "$@" \
            'add_executable(outer ../main.cpp)' 'target_link_libraries(outer PRIVATE cw2::mesh-format)'
    } >"$folder/CMakeLists.txt"
    cmake -S "$folder" -B "$folder/build" -G Ninja >"$folder/configure.txt" 2>&1 ||
        { cat "$folder/configure.txt" && exit 1; }
    ! grep -A5 'CMake Warning' "$folder/configure.txt"
}

cd "$1"
fetch=('include(FetchContent)' "FetchContent_Declare(cw2 SOURCE_DIR $project)" 'FetchContent_MakeAvailable(cw2)')
outer subfolder 'set(CMAKE_DISABLE_FIND_PACKAGE_PkgConfig ON)' "add_subdirectory($project cw2)"
outer fetched 'set(CMAKE_DISABLE_FIND_PACKAGE_PkgConfig ON)' "${fetch[@]}"
for folder in subfolder fetched; do
    cmake --build "$folder/build" -- --quiet
    "$folder/build/outer"
done
outer programs 'set(CW2_PROGRAMS ON)' "${fetch[@]}"
planned=$(ninja -C programs/build -t commands cw2-bake cw2)
grep -q cw2-bake/bake.cpp <<<"$planned"
