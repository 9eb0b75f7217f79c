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
    --camera-position 8.5,2.6,2.2 --camera-target -2,2.3,-1 --light-position 3,6,3 \
    --light-color 3.5,3.5,3.3 --time 5.4

# The lion's face, each form of its frames beside the exact one.
face=(--size 256x256 --samples 1 --camera-position 2.1,2.5,2.5 --camera-target 0,2.3,0
      --fov 50 --light-position 3,4,3 --light-color 3,3,3 --time 0.9)
forms=(f32 quat48 quat32 half3)
for form in "${forms[@]}"; do
    "$bin/cw2-bake" "$model" -o "$work/$form.cw2mesh" --tangent-frame "$form" --quiet
    for view in shaded vertex-normal tangent bitangent; do
        "$bin/cw2" "$work/$form.cw2mesh" --output "$work/$form-$view.exr" --view $view "${face[@]}"
    done
done
"$bin/frame_figure" tangent-frames.png "$work" "${forms[@]}"
