#!/usr/bin/env bash
# docs/figures.md is what its template, the shaders and the bakes make of it today, and has every
# picture.
# Usage: docs/check_page.sh BUILD_DIRECTORY
set -euo pipefail
directory=$(dirname "$0")
status=0

page=$(mktemp)
trap 'rm -f "$page"' EXIT
"$directory/page.sh" "$1" "$page"
diff "$directory/figures.md" "$page" || {
    echo "docs/figures.md is out of date: cmake --build --preset release --target figures-page"
    status=1
}
cd "$directory"
named=$(grep -o '[a-z0-9/-]*\.png' figures.md | sort -u)
for picture in $named; do
    [[ -s $picture ]] || { echo "docs/figures.md shows $picture, which is missing" && status=1; }
done
for picture in figures/*.png; do
    grep -qxF "$picture" <<<"$named" || { echo "docs/$picture is on no page" && status=1; }
done
exit $status
