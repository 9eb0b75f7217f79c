#!/usr/bin/env bash
# Draws an OBJ with cw2, with f3d and, where Chromium and npm are, with three.js, by turns, from the
# same camera, and prints medians and ratios: from the launch to the PNG with a warm and with an
# empty shader cache, from a baked file and from the OBJ with an empty cache, and steady frames.
# Usage: tests/bench/bench_render.sh [OBJ CAMERA TARGET LIGHT]    X,Y,Z each; default: the demo scene
# BEFORE=FOLDER: a folder with another build of both programs, which takes part, too. RUNS=N sets
# how often each runs [5]. Wants f3d, Xvfb and GNU time. A benchmark, no test.
set -euo pipefail
cd "$(dirname "$0")/../.."

runs=${RUNS:-5}
work=$PWD/build/bench
now=$PWD/build/release/bin
scene=$(realpath "${1:-build/release/assets/demo/courtyard.obj}")
camera=${2:-0.5,1.7,7.5} target=${3:-0,1.4,0} light=${4:-0,4,2}
size=1280x720
mkdir -p "$work"
rm -rf "$work"/*.runs "$work"/shaders.*

# Both draw by the same Mesa.
for icd in /usr/share/vulkan/icd.d/lvp_icd*.json; do export VK_DRIVER_FILES=$icd; done
mkfifo "$work/display.$$"
Xvfb -displayfd 5 -screen 0 1280x720x24 5>"$work/display.$$" >/dev/null 2>&1 &
xvfb=$!
read -r display <"$work/display.$$"
rm "$work/display.$$"
export DISPLAY=:$display
trap 'kill $xvfb' EXIT

# measure NAME COMMAND...: appends "wall cpu KiB" of one run to NAME.
measure() {
    local name=$1 TIMEFORMAT='%R %U %S'
    shift
    { time /usr/bin/time -f '%M' -o "$work/memory" "$@" >/dev/null 2>"$work/log"; } 2>"$work/time" || {
        cat "$work/log" >&2
        exit 1
    }
    echo "$(<"$work/time") $(tail -1 "$work/memory")" | awk '{ print $1, $2 + $3, $4 }' >>"$work/$name.runs"
}

# cw2_png NAME BIN SHADERS SCENE [OPTION...]
cw2_png() {
    local name=$1 bin=$2 shaders=$3 input=$4
    shift 4
    MESA_SHADER_CACHE_DIR=$shaders measure "$name" "$bin/cw2" "$input" --output "$work/cw2.png" \
        --size $size --camera-position "$camera" --camera-target "$target" --light-position "$light" "$@"
}

# bench_of NAME BIN: appends the median frame's milliseconds, wall and CPU.
bench_of() {
    local line
    MESA_SHADER_CACHE_DIR=$work/shaders.$1 "$2/cw2" "$work/$1.cw2mesh" --output "$work/cw2.png" --bench 9 \
        --samples 1 --size $size --camera-position "$camera" --camera-target "$target" \
        --light-position "$light" --stats "$work/$1.json" >/dev/null
    line=$(grep -oE '"(wall_median_ms|median_frame_ms|cpu_median_ms)": [0-9.]+' "$work/$1.json" |
        awk '{ printf "%s ", $2 }')
    echo "$line" >>"$work/$1.frame.runs"
}

programs=("now $now")
[[ -z ${BEFORE:-} ]] || programs+=("before $(realpath "$BEFORE")")
three=
if command -v chromium >/dev/null && command -v npm >/dev/null; then
    [[ -d $work/node_modules/three ]] || npm install --silent --prefix "$work" three@0.160.0
    three=yes
fi
for program in "${programs[@]}"; do
    read -r name bin <<<"$program"
    "$bin/cw2-bake" "$scene" -o "$work/$name.cw2mesh" --quiet 2>/dev/null
done
f3d_png() {
    MESA_SHADER_CACHE_DIR=$2 measure "$1" f3d --dry-run "$scene" --output "$work/f3d.png" \
        --resolution ${size/x/,} --camera-position "$camera" --camera-focal-point "$target" \
        --camera-view-up 0,1,0
}
for ((run = -1; run < runs; ++run)); do
    # The first turn fills the caches.
    ((run)) || rm -f "$work"/*.runs
    for program in "${programs[@]}"; do
        read -r name bin <<<"$program"
        baked=$work/$name.cw2mesh
        cw2_png "$name.warm" "$bin" "$work/shaders.$name" "$baked" --samples 1
        cw2_png "$name.four" "$bin" "$work/shaders.$name" "$baked"
        rm -rf "$work/shaders.cold"
        cw2_png "$name.cold" "$bin" "$work/shaders.cold" "$baked" --samples 1
        rm -rf "$work/cache"
        XDG_CACHE_HOME=$work/cache cw2_png "$name.obj" "$bin" "$work/shaders.$name" "$scene" --samples 1
        rm -rf "$work/cache" "$work/shaders.cold"
        XDG_CACHE_HOME=$work/cache cw2_png "$name.objcold" "$bin" "$work/shaders.cold" "$scene"
        bench_of "$name" "$bin"
    done
    f3d_png f3d.warm "$work/shaders.f3d"
    rm -rf "$work/shaders.cold"
    f3d_png f3d.cold "$work/shaders.cold"
    [[ -z $three ]] || node tests/bench/three.mjs "$work/node_modules" "$(command -v chromium)" "$scene" \
        $size "$camera" "$target" "$light" 2>>"$work/three.log" >>"$work/three.runs"
done

# median FILE COLUMN
median() { awk -v c="$2" 'NF >= c { print $c }' "$work/$1.runs" | sort -g | awk '{ v[NR] = $1 } END { print NR ? v[int((NR + 1) / 2)] : "-" }'; }

# row TITLE FILE PEER: medians, and the ratios to the peer's.
row() {
    local peer=${3:-}
    awk -v t="$1" -v w="$(median "$2" 1)" -v c="$(median "$2" 2)" -v m="$(median "$2" 3)" \
        -v pw="${peer:+$(median "$peer" 1)}" -v pc="${peer:+$(median "$peer" 2)}" \
        -v pm="${peer:+$(median "$peer" 3)}" 'BEGIN {
            printf "  %-38s %8.2f %8.2f %8.0f", t, w, c, m / 1024
            if (pw) printf "   %5.2f %5.2f %5.2f", w / pw, c / pc, m / pm
            print ""
        }'
}
echo "$scene, $size, $runs runs each"
printf '  %-38s %8s %8s %8s   %s\n' 'launch to PNG, median' 'wall s' 'CPU s' 'MiB' 'over f3d'
row 'f3d, from the OBJ' f3d.warm
row 'f3d, no shader cache' f3d.cold
for program in "${programs[@]}"; do
    name=${program%% *}
    row "cw2 $name: baked, 1 sample" "$name.warm" f3d.warm
    row "cw2 $name: baked, 4 samples" "$name.four" f3d.warm
    row "cw2 $name: baked, 1, no shader cache" "$name.cold" f3d.cold
    row "cw2 $name: OBJ, 1 sample, no bake" "$name.obj" f3d.warm
    row "cw2 $name: OBJ, 4, neither cache" "$name.objcold" f3d.cold
done
for program in "${programs[@]}"; do
    name=${program%% *}
    echo "  cw2 $name: a steady frame of 1 sample: $(median "$name.frame" 1) ms, CPU $(median "$name.frame" 2) ms"
done
[[ -z $three ]] ||
    echo "  three.js on $(tail -1 "$work/three.log"): $(median three 1) ms to the first picture; frames: Phong $(median three 2), standard $(median three 3) ms"
