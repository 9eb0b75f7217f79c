#!/usr/bin/env bash
# What textures cost, in four parts:
#   a bake with textures beside reading the images alone, with OpenImageIO, in as many threads;
#   a bake over an earlier output beside a bake of the geometry and a copy of that output;
#   load to first frame of the baked scene beside reading the images and blitting their mips;
#   how far pictures of blocks are from that of a lossless bake, and the bytes of all.
# Usage: tests/bench/bench_textures.sh SCENE.obj FOLDER_OF_ITS_IMAGES
# RUNS=N sets how often each runs [5]; medians are printed. VIEW holds the options of the pictures, if
# not the default view's. Wants GNU time, and the targets bench_textures, bench_blits and
# compare_images, built. A benchmark, no test.
set -euo pipefail
obj=$1 images=$2
cd "$(dirname "$0")/../.."

runs=${RUNS:-5}
work=build/bench
bin=build/release/bin
mkdir -p "$work"

# run NAME COMMAND...: appends "wall cpu KiB" of one run.
run() {
    local name=$1 TIMEFORMAT='%R %U %S'
    shift
    sync  # what was written before is not this run's to write
    { time /usr/bin/time -f '%M' -o "$work/memory" "$@" >/dev/null; } 2>"$work/time"
    echo "$(tail -1 "$work/time") $(<"$work/memory")" |
        awk '{ print $1, $2 + $3, $4 }' >>"$work/$name.runs"
}
copy() { cp "$work/scene.cw2mesh" "$work/copy.tmp" && mv "$work/copy.tmp" "$work/copy.cw2mesh"; }
export -f copy
export work

# median FILE COLUMN
median() { awk -v c="$2" '{ print $c }' "$work/$1.runs" | sort -g | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'; }
line() {
    printf '%-34s %8.3f s wall %8.3f s CPU %8.0f MiB\n' "$1" "$(median "$2" 1)" "$(median "$2" 2)" \
        "$(median "$2" 3 | awk '{ print $1 / 1024 }')"
}
ratio() { awk -v a="$1" -v b="$2" 'BEGIN { printf "%.2f", a / b }'; }

rm -f "$work"/*.runs
for ((i = 0; i < runs; ++i)); do
    run floor "$bin/bench_textures" "$images"
    rm -f "$work/scene.cw2mesh"
    run bake "$bin/cw2-bake" --quiet "$obj" -o "$work/scene.cw2mesh"
    rm -f "$work/compressed.cw2mesh"
    run compressed "$bin/cw2-bake" --quiet "$obj" -o "$work/compressed.cw2mesh" --compress
    rm -f "$work/plain.cw2mesh"
    run lossless "$bin/cw2-bake" --quiet "$obj" -o "$work/plain.cw2mesh" --textures lossless
    run again "$bin/cw2-bake" --quiet "$obj" -o "$work/scene.cw2mesh"
    run geometry "$bin/cw2-bake" --quiet "$obj" -o "$work/geometry.cw2mesh" --textures none
    run copy bash -c copy
    "$bin/cw2" "$work/scene.cw2mesh" --output "$work/shot.png" --samples 1 --stats "$work/stats.json"
    sed -n 's/.*"\(load\|first_frame\)_ms": \([0-9.]*\).*/\2/p' "$work/stats.json" | paste -sd' ' \
        >>"$work/first.runs"
    "$bin/bench_blits" "$images" >>"$work/blits.runs"
done

line 'reading alone' floor
line 'bake, in blocks' bake
line 'bake, compressed' compressed
line 'bake, lossless' lossless
echo "  bake / reading: $(ratio "$(median bake 1)" "$(median floor 1)") wall," \
    "$(ratio "$(median bake 2)" "$(median floor 2)") CPU"
line 'bake over an earlier output' again
line 'bake of the geometry' geometry
line 'copy of the output' copy
sum=$(awk -v a="$(median geometry 1)" -v b="$(median copy 1)" 'BEGIN { print a + b }')
echo "  again / (geometry + copy): $(ratio "$(median again 1)" "$sum")"
first=$(awk '{ print $1 + $2 }' "$work/first.runs" | sort -g | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }')
echo "load to first frame: $first ms (loading $(median first 1))"
echo "reading and blitting: $(median blits 1) ms (reading $(median blits 2))"
echo "  first frame / blitting: $(ratio "$first" "$(median blits 1)")"
read -ra view <<<"${VIEW-}"
for name in plain scene compressed; do
    "$bin/cw2" "$work/$name.cw2mesh" --output "$work/$name.png" "${view[@]}"
    echo "$name: $(stat -c %s "$work/$name.cw2mesh") bytes"
    "$bin/compare_images" "$work/plain.png" "$work/$name.png" || true
done
