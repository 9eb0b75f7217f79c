#!/usr/bin/env bash
# Checks that the sources are as clang-format leaves them. Other versions of it format otherwise:
# without version 14 it exits 77. Usage: check_format.sh [ROOT OF THE REPOSITORY]
set -euo pipefail
cd "${1:-$(dirname "$0")/..}"

version=$(clang-format --version 2>/dev/null) || version=none
if [[ ! $version =~ version\ 14\. ]]; then
    echo "skipped: needs clang-format 14; here: $version"
    exit 77
fi
find assets common cw2 cw2-bake docs mesh-format packaging shaders tests \
    \( -name '*.cpp' -o -name '*.h' \) -exec clang-format --dry-run -Werror {} +
