#!/bin/sh
# record.sh [BUILD_DIR]: writes recorded_tangents.bin anew, after small_meshes() has changed. Needs
# Node, npm and the built target tangents_oracle.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
build=${1:-$here/../../build/release}
sh "$here/install_package.sh" "$build/oracle" mikktspace 1.1.1
"$build/bin/tangents_oracle" record "$here/recorded_tangents.bin" "$build/oracle" "" "" \
    "$(command -v node)" "$here/mikktspace.mjs" "$build/oracle"
