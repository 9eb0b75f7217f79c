#!/usr/bin/env bash
# The checkers of includes and format pass a small tree without faults, and name each fault put in.
set -euo pipefail
checkers=$(cd "$(dirname "$0")" && pwd)
tree=$(mktemp -d)
trap 'rm -rf "$tree"' EXIT
cd "$tree"
status=0

# Makes the tree anew: base/low.h below geometry/high.h, and a test that includes both.
make_tree() {
    rm -rf ./* && mkdir -p assets common cw2/render cw2-bake/base cw2-bake/geometry docs mesh-format packaging \
        shaders tests
    cp "$checkers/../.clang-format" .
    printf '#pragma once\n\nstruct Low {\n    int value;\n};\n' >cw2-bake/base/low.h
    printf '#pragma once\n\n#include "cw2-bake/base/low.h"\n\nstruct High {\n    Low low;\n};\n' \
        >cw2-bake/geometry/high.h
    printf '#include <vector>\n\nstd::vector<int> shared;\n' >common/shared.cpp
}

# expect PASSES|FINDS=TEXT CHECKER...: what each checker says of the tree as it is now.
expect() {
    local wanted=$1 checker output outcome
    shift
    for checker in "$@"; do
        outcome=0
        output=$("$checkers/$checker" "$tree" 2>&1) || outcome=$?
        case $outcome/$wanted in
        77/*) echo "skipped: $output" ;;
        0/PASSES) ;;
        1/FINDS=*)
            [[ $output == *"${wanted#FINDS=}"* ]] || outcome=wrong ;;
        *) outcome=wrong ;;
        esac
        [[ $outcome != wrong ]] || { echo "$checker: not $wanted: $output" && status=1; }
    done
}

make_tree
expect PASSES check_includes.sh check_format.sh check_unused_includes.pl

printf '#pragma once\n\n#include "cw2-bake/geometry/high.h"\n\nHigh f();\n' >cw2-bake/base/upwards.h
expect FINDS="cw2-bake/base/upwards.h:3" check_includes.sh

make_tree
printf '#include <vector>\n\nstd::vector<int>   shared;\n' >common/shared.cpp
expect FINDS=common/shared.cpp:3 check_format.sh

make_tree
printf '#include <map>\n#include <vector>\n\nstd::vector<int> shared;\n' >common/shared.cpp
expect FINDS="common/shared.cpp:1" check_unused_includes.pl
printf '#include "cw2-bake/base/low.h"\n\nint shared;\n' >tests/other.cpp
expect FINDS="tests/other.cpp:1" check_unused_includes.pl

exit $status
