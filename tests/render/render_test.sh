#!/usr/bin/env bash
# Renders a picture and compares it with its golden, a picture known to be right.
# Usage: render_test.sh COMPARE_IMAGES GOLDEN PICTURE REPORT CW2 SCENE OPTION...
# With CW2_UPDATE_GOLDENS set the golden becomes what was rendered. Beside GOLDEN.png a GOLDEN.DRIVER.png
# may be right, too: where a texture's anisotropic samples lie is a driver's own choice.
set -euo pipefail

compare_images=$1 golden=$2 picture=$3 report=$4
shift 4
mkdir -p "${picture%/*}"
rm -rf "$picture" "$report"
"$@" --output "$picture" --validation
if [[ -n ${CW2_UPDATE_GOLDENS:-} ]]; then
    cp "$picture" "$golden"
    exit
fi
"$compare_images" --report "$report" "$golden" "$picture" && exit
for other in "${golden%.png}".*.png; do
    if [[ -e $other ]] && "$compare_images" "$other" "$picture"; then
        rm -rf "$report"
        exit
    fi
done
exit 1
