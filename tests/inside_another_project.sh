#!/usr/bin/env bash
# The project works inside another: one that adds it as a subfolder can build its mesh_format.
# Usage: inside_another_project.sh FOLDER, which is made and kept, so that the next run is short
set -euo pipefail
project=$(cd "$(dirname "$0")/.." && pwd)
mkdir -p "$1"
cat >"$1/CMakeLists.txt" <<END
cmake_minimum_required(VERSION 3.25)
project(outer LANGUAGES CXX)
set(BUILD_TESTING OFF)
add_subdirectory($project cw2)
add_executable(outer main.cpp)
target_link_libraries(outer PRIVATE mesh_format)
END
cat >"$1/main.cpp" <<'END'
#include "mesh-format/file.h"

int main() {
    return mesh_format::Document().meshes.empty() ? 0 : 1;
}
END
cmake -S "$1" -B "$1/build" -G Ninja >"$1/configure.txt" 2>&1 || { cat "$1/configure.txt" && exit 1; }
! grep -A5 'CMake Warning' "$1/configure.txt"
cmake --build "$1/build" --target outer -- --quiet
"$1/build/outer"
