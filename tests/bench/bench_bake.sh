#!/usr/bin/env bash
# Bakes the same OBJ with cw2-bake and with gltfpack (npm's, WebAssembly), by turns, geometry only,
# and prints medians and ratios: wall and CPU seconds, peak memory, bytes written.
# Usage: tests/bench/bench_bake.sh [OBJ...]    default: the demo scene and a grid of 1 M triangles
# RUNS=N sets how often each runs [5]. Wants node, npm and GNU time. A benchmark, no test.
set -euo pipefail
cd "$(dirname "$0")/../.."

runs=${RUNS:-5}
work=build/bench
bake=build/release/bin/cw2-bake
mkdir -p "$work"
if [[ ! -d $work/node_modules/gltfpack ]]; then
    npm install --silent --prefix "$work" gltfpack@1.3.0
fi
gltfpack=(node "$work/node_modules/gltfpack/cli.js")

# A wavy sheet of 2 * 719^2 = 1,033,922 triangles with UVs and normals.
make_grid() {
    awk 'BEGIN {
        n = 719
        for (y = 0; y <= n; ++y) for (x = 0; x <= n; ++x) {
            u = x / n; v = y / n
            h = 0.1 * sin(9 * u) * cos(7 * v)
            dx = 0.9 * cos(9 * u) * cos(7 * v); dy = -0.7 * sin(9 * u) * sin(7 * v)
            l = sqrt(1 + dx * dx + dy * dy)
            printf "v %.6f %.6f %.6f\nvt %.6f %.6f\nvn %.6f %.6f %.6f\n", \
                10 * u, h, -10 * v, u, v, -dx / l, 1 / l, dy / l
        }
        for (y = 0; y < n; ++y) for (x = 1; x <= n; ++x) {
            a = y * (n + 1) + x; b = a + 1; c = a + n + 1; d = c + 1
            printf "f %d/%d/%d %d/%d/%d %d/%d/%d\nf %d/%d/%d %d/%d/%d %d/%d/%d\n", \
                a, a, a, b, b, b, c, c, c, b, b, b, d, d, d, c, c, c
        }
    }' >"$work/grid.obj"
}

# measure NAME OUTPUT COMMAND...: appends "wall cpu KiB bytes" of one run to NAME.
measure() {
    local name=$1 output=$2
    shift 2
    rm -f "$output"
    /usr/bin/time -f '%e %U %S %M' -o "$work/time" "$@" >/dev/null 2>"$work/log" || {
        cat "$work/log" >&2
        exit 1
    }
    awk -v bytes="$(stat -c %s "$output")" '{ print $1, $2 + $3, $4, bytes }' "$work/time" \
        >>"$work/$name.runs"
}

# median NAME COLUMN
median() { awk -v c="$2" '{ print $c }' "$work/$1.runs" | sort -g | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'; }

# compare TITLE OURS THEIRS: one line a program, then the ratios.
compare() {
    local title=$1 name column ours=() theirs=()
    for column in 1 2 3 4; do
        ours+=("$(median "$2" $column)") theirs+=("$(median "$3" $column)")
    done
    printf '%-12s %9s %9s %9s %12s\n' "$title" 'wall s' 'CPU s' 'MiB' 'bytes'
    for name in ours theirs; do
        local -n values=$name
        awk -v n="$([[ $name == ours ]] && echo cw2-bake || echo gltfpack)" \
            -v w="${values[0]}" -v c="${values[1]}" -v m="${values[2]}" -v b="${values[3]}" \
            'BEGIN { printf "  %-10s %9.3f %9.3f %9.1f %12d\n", n, w, c, m / 1024, b }'
    done
    awk -v a="${ours[*]}" -v b="${theirs[*]}" 'BEGIN {
        split(a, o); split(b, t)
        printf "  %-10s %9.3f %9.3f %9.3f %12.3f\n", "ratio", o[1] / t[1], o[2] / t[2], o[3] / t[3], o[4] / t[4]
    }'
}

scenes=("$@")
if [[ ${#scenes[@]} -eq 0 ]]; then
    [[ -f $work/grid.obj ]] || make_grid
    scenes=(build/release/assets/demo/courtyard.obj "$work/grid.obj")
fi
for scene in "${scenes[@]}"; do
    echo "$scene: $(stat -c %s "$scene") bytes, $runs runs each"
    rm -f "$work"/*.runs
    ours=("$bake" "$scene" --textures none --quiet -o "$work/ours.cw2mesh")
    theirs=("${gltfpack[@]}" -i "$scene" -o "$work/theirs.glb" -gt -kv -tr)
    for ((run = 0; run < runs; ++run)); do
        measure raw "$work/ours.cw2mesh" "${ours[@]}"
        measure raw.peer "$work/theirs.glb" "${theirs[@]}"
        measure quat48 "$work/ours.cw2mesh" "${ours[@]}" --compress
        measure quat48.peer "$work/theirs.glb" "${theirs[@]}" -cc -vp 16 -vt 16 -vn 16
        measure quat32 "$work/ours.cw2mesh" "${ours[@]}" --compress --tangent-frame quat32
        measure quat32.peer "$work/theirs.glb" "${theirs[@]}" -cc -vp 16 -vt 16 -vn 10
    done
    compare 'raw' raw raw.peer
    compare '-cc, vn 16' quat48 quat48.peer
    compare '-cc, vn 10' quat32 quat32.peer
done
