#!/usr/bin/env bash
# Draws the pictures of the README and of docs/ from the demo scene.
# Usage: docs/figures.sh BUILD_DIRECTORY    (the target `figures` calls it)
set -euo pipefail
cd "$(dirname "$0")"

bin=$1/bin
model=$1/assets/demo/courtyard.obj
work=$1/figures
mkdir -p "$work"

"$bin/cw2-bake" "$model" -o "$work/courtyard.cw2mesh" --quiet
"$bin/cw2" "$work/courtyard.cw2mesh" --output courtyard.png --size 960x540 \
    --camera-position 7.8,2.5,2.3 --camera-target -1.5,2.15,-0.3 --light-position 4,7,5 \
    --light-color 2.5,2.4,2.2 --time 5.4

# The lion's face, each form of its frames beside the exact one.
face=(--size 256x256 --samples 1 --camera-position 2.6,2.6,3 --camera-target 1.15,2.35,1.15
      --light-position 5,4.5,2.5 --light-color 2,2,2)
forms=(f32 quat48 quat32 half3)
for form in "${forms[@]}"; do
    "$bin/cw2-bake" "$model" -o "$work/$form.cw2mesh" --tangent-frame "$form" --quiet
    for view in shaded vertex-normal tangent bitangent; do
        "$bin/cw2" "$work/$form.cw2mesh" --output "$work/$form-$view.exr" --view $view "${face[@]}"
    done
done
"$bin/frame_figure" tangent-frames.png "$work" "${forms[@]}"
