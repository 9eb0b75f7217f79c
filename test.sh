#!/usr/bin/env bash
# Installs what is missing, builds Release, runs the tests; then the unit tests with clang's
# sanitizers. Arguments go to ctest (-R NAME, -L LABEL), and then only Release is tested.
set -euo pipefail
cd "$(dirname "$0")"
[[ -t 1 ]] && quiet=() || quiet=(-- --quiet)

third_party/install_packages.sh
cmake --preset release >/dev/null
cmake --build --preset release "${quiet[@]}"
ctest --preset release -j2 "$@"
[[ $# -eq 0 ]] || exit 0

cmake --preset sanitize >/dev/null
cmake --build --preset sanitize "${quiet[@]}"
ctest --preset sanitize -j2
