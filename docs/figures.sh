#!/usr/bin/env bash
# Draws the pictures of the README and of docs/ from the demo scene, and writes docs/figures.md.
# Usage: docs/figures.sh BUILD_DIRECTORY    (the target `figures` calls it)
set -euo pipefail
build=$(realpath "$1")
cd "$(dirname "$0")"

bin=$build/bin
model=$build/assets/demo/courtyard.obj
work=$build/figures
mkdir -p "$work" figures
rm -f figures/*.png

forms=(f32 quat48 quat32 half3)
for form in "${forms[@]}"; do
    "$bin/cw2-bake" "$model" -o "$work/$form.cw2mesh" --tangent-frame "$form" --quiet
done

awk -f sphere.awk >"$work/sphere.obj"
"$bin/cw2-bake" "$work/sphere.obj" -o "$work/sphere.cw2mesh" --quiet

# Draws the lines of standard input, two at a time: SCENE NAME OPTION...
draw() {
    # shellcheck disable=SC2016 # the inner shell expands these
    xargs -P2 -L1 bash -c 'cw2=$0 scene=$1/$2.cw2mesh name=$3
        shift 3
        exec "$cw2" "$scene" --output "$name" "$@"' "$bin/cw2" "$work"
}

court='--camera-position 7.8,2.5,2.3 --camera-target -1.5,2.15,-0.3'
day="$court --light-position 4,7,5"
against="$court --light-position -6,5,-1"
lion='--camera-position 2.6,2.6,3 --camera-target 1.15,2.35,1.15'
plants="--camera-position 9.35,1.5,0.35 --camera-target 5.9,1.15,-2.9 --light-position 8,5,3"
chain="--camera-position 7.6,1.25,0.2 --camera-target 8.61,0.6,-2.59 --fov 18 \
--light-position 7,4,3"
tiles="--camera-position 2.1,1.35,-4.6 --camera-target 2,1.15,-6 --fov 42 \
--light-position 0.6,2.1,-5.65"
nose="--camera-position 2,2.6,2.4 --camera-target 1.22,2.36,1.22 --fov 9 \
--light-position 1.6,3,2.4"
palm="--camera-position 6.2,1.2,-1.6 --camera-target 5.76,0.6,-3.3 --fov 20"

draw <<END
quat48 courtyard.png --size 960x540 $day --time 5.4
sphere sphere.png --size 480x320 --roughness 0.45
quat48 figures/court.png --size 640x360 $day
quat48 figures/lion.png --size 640x360 $lion --light-position 5,4.5,2.5
quat48 figures/plants.png --size 640x360 $plants
quat48 figures/tiles.png --size 640x360 $tiles --exposure 2.3 --split shaded:no-normal-map,shaded
END

sed 's/^\([^ ]*\)/quat48 figures\/\1.png --size 320x180/' <<END | draw
normal $day --view normal
view-direction $day --view view-direction
light-direction $day --view light-direction
light-front $court --light-position 4,7,5
light-low $court --light-position 6.5,0.4,2.5
light-arcade $court --light-position -2,2.2,-5.2
light-behind $court --light-position -6,1.6,-1
lion-right $lion --fov 42 --light-position 5,4.5,2.5
lion-left $lion --fov 42 --light-position 0,4,5
lion-above $lion --fov 42 --light-position 2,6,1.2
lion-behind $lion --fov 42 --light-position 2.4,4.5,-2.8
diffuse $day --view diffuse --exposure 1.65
specular $day --view specular --exposure 2
specular-range $day --view specular --false-color 0.001,10
distribution $lion --fov 42 --light-position 5,4.5,2.5 --view distribution --exposure -2
distribution-range $lion --fov 42 --light-position 5,4.5,2.5 --view distribution --false-color auto
masking $against --view masking
fresnel $against --view fresnel
foliage-whole $plants --no-alpha-mask
foliage $plants
chain-whole $chain --no-alpha-mask
chain $chain
nose-flat $nose --no-normal-map
nose $nose
tiles-vertex-normal $tiles --view vertex-normal
tiles-normal $tiles --view normal
palm-vertex-normal $palm --view vertex-normal
palm-normal $palm --view normal
END

# The lion's face, each form of its frames held to the exact one.
face="--size 256x256 --samples 1 --camera-position 2.6,2.6,3 --camera-target 1.15,2.35,1.15 \
--light-position 5,4.5,2.5"
for form in "${forms[@]}"; do
    for view in shaded vertex-normal tangent bitangent; do
        echo "$form \"$work/$form-$view.exr\" --view $view $face"
    done
done | draw
"$bin/frame_figure" figures "$work" "${forms[@]}"

./page.sh "$build"
