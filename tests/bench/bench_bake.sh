#!/usr/bin/env bash
# Bakes the same OBJ with cw2-bake, with npm's gltfpack (WebAssembly) and, where they are installed,
# with a native gltfpack and Filament's filamesh (libfilament-tools; half-float positions, tangent
# frames in 8 bytes), by turns, geometry only, and prints medians and ratios: wall and CPU seconds,
# peak memory, bytes written; then how far the frames of each are from MikkTSpace's (bench_frames),
# and what ten times the triangles cost.
# Debian's gltfpack (0.18, 0.22) makes no tangents. What a native one that does would take is
# estimated: as much less than npm's as it takes less than npm's of its own version.
# Usage: tests/bench/bench_bake.sh [OBJ...]    default: the demo scene and sheets of 103,058 and
# 1,033,922 triangles, one of the latter in no order, for which the target make_meshes is built
# RUNS=N sets how often each runs [5]; NATIVE=COMMAND a gltfpack that is not on the PATH, maybe one
# that its loader starts. Wants node, npm and GNU time. A benchmark, no test.
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
read -ra native <<<"${NATIVE:-$(command -v gltfpack || true)}"
if [[ ${#native[@]} -gt 0 ]]; then
    version=$("${native[@]}" -v | awk '{ print $2 }')
    [[ -d $work/$version/node_modules ]] ||
        npm install --silent --prefix "$work/$version" "gltfpack@$version.0"
    twin=(node "$work/$version/node_modules/gltfpack/cli.js")
fi
filamesh=$(command -v filamesh || true)

# measure NAME OUTPUT COMMAND...: appends "wall cpu KiB bytes" of one run to NAME.
measure() {
    local name=$1 output=$2 TIMEFORMAT='%R %U %S'
    shift 2
    rm -f "$output"
    { time /usr/bin/time -f '%M' -o "$work/memory" "$@" >/dev/null 2>"$work/log"; } \
        2>"$work/time" || {
        cat "$work/log" >&2
        exit 1
    }
    echo "$(<"$work/time") $(tail -1 "$work/memory") $(stat -c %s "$output")" |
        awk '{ print $1, $2 + $3, $4, $5 }' >>"$work/$name.runs"
}

# median NAME COLUMN
median() { awk -v c="$2" '{ print $c }' "$work/$1.runs" | sort -g | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'; }

# row NAME RUNS: the medians of one program.
row() {
    awk -v n="$1" -v w="$(median "$2" 1)" -v c="$(median "$2" 2)" -v m="$(median "$2" 3)" \
        -v b="$(median "$2" 4)" \
        'BEGIN { printf "  %-16s %9.3f %9.3f %9.1f %12d\n", n, w, c, m / 1024, b }'
}

# ratio NAME OURS THEIRS
ratio() {
    local column ours=() theirs=()
    for column in 1 2 3 4; do
        ours+=("$(median "$2" $column)") theirs+=("$(median "$3" $column)")
    done
    awk -v n="$1" -v a="${ours[*]}" -v b="${theirs[*]}" 'BEGIN {
        split(a, o); split(b, t)
        printf "  %-16s %9.3f %9.3f %9.3f %12.3f\n", n, o[1] / t[1], o[2] / t[2], o[3] / t[3], o[4] / t[4]
    }'
}

# estimate KIND: ours beside a native gltfpack that makes tangents.
estimate() {
    local column times=()
    for column in 1 2; do
        times+=("$(median "$1" $column)" "$(median "$1.peer" $column)" \
            "$(median "$1.native" $column)" "$(median "$1.twin" $column)")
    done
    awk -v t="${times[*]}" 'BEGIN {
        split(t, s)
        printf "  %-16s %9.3f %9.3f   of an estimate for %.3f s, %.3f of CPU\n", "ours / native -gt",
            s[1] * s[4] / (s[2] * s[3]), s[5] * s[8] / (s[6] * s[7]), s[2] * s[3] / s[4], s[6] * s[7] / s[8]
    }'
}

# compare TITLE KIND: one line a program, then the ratios.
compare() {
    printf '%-18s %9s %9s %9s %12s\n' "$1" 'wall s' 'CPU s' 'MiB' 'bytes'
    row cw2-bake "$2"
    row 'npm gltfpack' "$2.peer"
    [[ ${#native[@]} -eq 0 ]] || row "native $version" "$2.native"
    [[ ${#native[@]} -eq 0 ]] || row "npm $version" "$2.twin"
    [[ -z $filamesh ]] || row filamesh "$2.filamesh"
    ratio 'ours / npm' "$2" "$2.peer"
    [[ ${#native[@]} -eq 0 ]] || ratio 'ours / native' "$2" "$2.native"
    [[ ${#native[@]} -eq 0 ]] || estimate "$2"
    [[ -z $filamesh ]] || ratio 'ours / filamesh' "$2" "$2.filamesh"
}

# turn KIND OUR_OPTIONS -- THEIR_OPTIONS: one run of each program.
turn() {
    local kind=$1 ours=()
    shift
    for (( ; $# > 0; )); do
        [[ $1 != -- ]] || break
        ours+=("$1")
        shift
    done
    shift
    measure "$kind" "$work/ours.$kind.cw2mesh" "$bake" "$scene" --textures none --quiet \
        -o "$work/ours.$kind.cw2mesh" "${ours[@]}"
    measure "$kind.peer" "$work/theirs.glb" "${gltfpack[@]}" -i "$scene" -o "$work/theirs.glb" -gt \
        -kv -tr "$@"
    if [[ ${#native[@]} -gt 0 ]]; then
        measure "$kind.native" "$work/theirs.glb" "${native[@]}" -i "$scene" \
            -o "$work/theirs.glb" -kv -tr "$@"
        measure "$kind.twin" "$work/theirs.glb" "${twin[@]}" -i "$scene" \
            -o "$work/theirs.glb" -kv -tr "$@"
    fi
    local packed=(-c)
    [[ $# -gt 0 ]] || packed=()
    [[ -z $filamesh ]] || measure "$kind.filamesh" "$work/theirs.filamesh" "$filamesh" "${packed[@]}" \
        "$scene" "$work/theirs.filamesh"
}

# frames BITS FORM: how far the frames of both are from MikkTSpace's. Theirs are read from a file
# that is not encoded: encoding rounds them no less.
frames() {
    [[ -x $bench_frames ]] || return 0
    "${gltfpack[@]}" -i "$scene" -o "$work/theirs.glb" -gt -kv -tr -vp 16 -vt 16 -vn "$1" >/dev/null
    printf '  frames, %s beside -vn %s: ' "$2" "$1"
    "$bench_frames" "$scene" "$work/ours.$2.cw2mesh" "$work/theirs.glb"
}

bench_frames=build/release/bin/bench_frames
scenes=("$@")
if [[ ${#scenes[@]} -eq 0 ]]; then
    echo "newmtl m" >"$work/meshes.mtl"
    for side in 227 719; do
        build/release/bin/make_meshes sheet $side >"$work/sheet$side.obj"
    done
    build/release/bin/make_meshes shuffled 719 >"$work/shuffled719.obj"
    scenes=(build/release/assets/demo/courtyard.obj "$work"/{sheet227,sheet719,shuffled719}.obj)
fi
for scene in "${scenes[@]}"; do
    echo "$scene: $(stat -c %s "$scene") bytes, $runs runs each"
    rm -f "$work"/*.runs
    for ((run = 0; run < runs; ++run)); do
        turn raw --
        turn quat48 --compress -- -cc -vp 16 -vt 16 -vn 16
        turn quat32 --compress --tangent-frame quat32 -- -cc -vp 16 -vt 16 -vn 10
    done
    compare 'raw' raw
    compare '-cc, vn 16' quat48
    compare '-cc, vn 10' quat32
    frames 16 quat48
    frames 10 quat32
    cp "$work/raw.runs" "$work/$(basename "$scene" .obj).raw"
done
if [[ $# -eq 0 ]]; then
    # 1,033,922 triangles beside 103,058.
    cp "$work/sheet227.raw" "$work/small.runs"
    cp "$work/sheet719.raw" "$work/large.runs"
    echo '10.03 times the triangles'
    ratio 'times' large small
fi
