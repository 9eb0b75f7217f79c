#!/usr/bin/env bash
# Fuzzes one target (obj, gltf, mesh, images) that the preset fuzz built: replays its seeds, then
# makes more of them for some seconds, or with -runs=N so many. Without a CORPUS they are the same
# ones every time; with one what is new stays there and is taken up the next time, and so many JOBS
# (1) work on it side by side. What breaks the target stays in BUILD/fuzz; as a seed it stays mended.
# Usage: run.sh BUILD TARGET SECONDS|-runs=N [CORPUS [JOBS]]
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
build=$1 target=$2 limit=$3
[[ $limit == -runs=* ]] || limit=-max_total_time=$limit
# In memory: a run of the target writes and reads some small files.
work=$(mktemp -d -p /dev/shm 2>/dev/null || mktemp -d)
trap 'rm -rf "$work"' EXIT
corpus=${4:-$work/corpus}
mkdir -p "$build/fuzz" "$corpus" "$work/scratch" "$work/seeds"

if [[ $target == mesh ]]; then
    # Baked anew: they would be of an old version soon.
    for seed in "$here"/seeds/obj/forms "$here"/seeds/gltf/everything.glb; do
        for form in quat48 quat32 half3 "f32 --positions f32" "quat48 --compress"; do
            name=$(basename "$seed")_${form// /_}
            tr -d '\0' <"$seed" >"$work/scratch/forms.obj" # an MTL's lines are none of an OBJ
            cp "$seed" "$work/scratch/everything.glb"
            input=$work/scratch/$(basename "$seed" | sed 's/^forms$/forms.obj/')
            # shellcheck disable=SC2086
            "$build/bin/cw2-bake" "$input" --quiet --tangent-frame $form -o "$work/seeds/$name.cw2mesh"
        done
    done
else
    cp "$here/seeds/$target"/* "$work/seeds"
fi
options=()
[[ -f $here/$target.dict ]] && options+=(-dict="$here/$target.dict")
# A test tries the same every time; a search goes on where nobody was.
[[ $# -ge 4 ]] || options+=(-seed=1)
[[ $# -lt 5 ]] || options+=(-fork="$5")
TMPDIR=$work/scratch "$build/bin/fuzz_$target" "${options[@]}" "$limit" \
    -entropic=0 -timeout=100 -rss_limit_mb=3000 -malloc_limit_mb=1500 -max_len=5000 -print_final_stats=1 \
    -artifact_prefix="$build/fuzz/$target-" "$corpus" "$work/seeds" >"$work/log" 2>&1 || {
    tail -n 60 "$work/log"
    exit 1
}
grep -E 'number_of_executed_units|DONE|^#[0-9]+: cov' "$work/log" | tail -n 1
