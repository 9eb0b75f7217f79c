#!/usr/bin/env bash
# Installs what is missing, builds Release, runs the tests; then, with clang's sanitizers, the unit tests
# and the fuzz targets. Arguments go to ctest (-R NAME, -L LABEL), and then only Release is tested.
# With --root bookworm or --root trixie it does so in a clean Debian 12 or 13, in build/roots; this
# takes root and debootstrap.
set -euo pipefail
cd "$(dirname "$0")"

if [[ ${1:-} == --root ]]; then
    exec tests/in_root.sh "${@:2}"
fi

third_party/install_packages.sh
# On a terminal one sees what is done.
configure() {
    if [[ -t 1 ]]; then
        cmake --preset "$1"
    else
        cmake --preset "$1" >/dev/null
    fi
}
[[ -t 1 ]] && quiet=() || quiet=(-- --quiet)

configure release
cmake --build --preset release "${quiet[@]}"
ctest --preset release --no-tests=error -j2 "$@"
[[ $# -eq 0 ]] || exit 0

for preset in sanitize fuzz; do
    configure $preset
    cmake --build --preset $preset "${quiet[@]}"
    ctest --preset $preset --no-tests=error -j2
done
