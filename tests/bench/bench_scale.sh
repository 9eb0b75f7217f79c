#!/usr/bin/env bash
# Bakes and draws scenes of many triangles and prints what both take: seconds, peak memory, bytes.
# A scene is so many rooms, side by side, of a million smooth triangles each.
# Usage: tests/bench/bench_scale.sh [MILLIONS...]    default: 1 10 50; 50 want 7 GB of disk
# Wants the targets cw2, cw2-bake and make_meshes, and GNU time. A benchmark, no test.
set -euo pipefail
cd "$(dirname "$0")/../.."

work=build/bench
bin=build/release/bin
mkdir -p "$work"

# measure COMMAND...: prints "wall cpu KiB" of one run.
measure() {
    /usr/bin/time -f '%e %U %S %M' -o "$work/time" "$@" >/dev/null 2>"$work/log" || {
        cat "$work/log" >&2
        exit 1
    }
    awk '{ print $1, $2 + $3, $4 }' "$work/time"
}

printf '%9s  %-22s %8s %8s %8s %12s\n' triangles '' 'wall s' 'CPU s' MiB 'bytes each'
(($#)) || set -- 1 10 50
obj=$work/rooms.obj baked=$work/rooms.cw2mesh
for million; do
    "$bin/make_meshes" rooms "$million" >"$obj"
    # row TITLE RUN
    row() {
        awk -v m="$million M" -v t="$1" -v n=$((million * 2 * 707 * 707)) -v run="$2" 'BEGIN {
            split(run, r)
            printf "%9s  %-22s %8.2f %8.2f %8.0f %12.1f\n", m, t, r[1], r[2], r[3] / 1024, r[3] * 1024 / n
        }'
    }
    row "bake, $(($(stat -c %s "$obj") / 1000000)) MB" \
        "$(measure "$bin/cw2-bake" "$obj" -o "$baked" --quiet)"
    rm "$obj"
    row 'picture, 1 sample' "$(measure "$bin/cw2" "$baked" --output "$work/rooms.png" --samples 1)"
    row 'picture, 4 samples' "$(measure "$bin/cw2" "$baked" --output "$work/rooms.png")"
    rm "$baked"
done
