#!/usr/bin/env bash
# Installs what is missing, builds Release, runs the tests.
# Arguments go to ctest (-R NAME, -L LABEL).
set -euo pipefail
cd "$(dirname "$0")"

third_party/install_packages.sh
cmake --preset release >/dev/null
[[ -t 1 ]] && quiet=() || quiet=(-- --quiet)
cmake --build --preset release "${quiet[@]}"
ctest --preset release -j2 "$@"
