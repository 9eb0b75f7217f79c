#!/usr/bin/env bash
# Compressed geometry of meshes of several kinds: bytes beside npm's gltfpack (1.3.0), and how long it takes
# to decode. Prints for each: bytes with quat48, theirs with -vn 16, ratio; the same with quat32 and -vn 10;
# then what bench_decode prints of both forms.
# Usage: tests/bench/bench_geometry.sh [OBJ...]     more meshes than the five that make_meshes makes
# Wants the targets cw2-bake, make_meshes and bench_decode, node and npm. A benchmark, no test.
set -euo pipefail
cd "$(dirname "$0")/../.."

work=build/bench
bin=build/release/bin
mkdir -p "$work"
if [[ ! -d $work/node_modules/gltfpack ]]; then
    npm install --silent --prefix "$work" gltfpack@1.3.0
fi

echo "newmtl m" >"$work/meshes.mtl"
for kind in "sheet 719" "noise 719" "scan 500" "cad 100000" "cards 60000" "$@"; do
    model=$kind
    if [[ ! -f $kind ]]; then
        model=$work/${kind% *}.obj
        [[ -f $model ]] || "$bin/make_meshes" ${kind% *} ${kind#* } >"$model"
    fi
    name=$(basename "$model" .obj)
    row="$name:"
    times=
    for form in "quat48 16" "quat32 10"; do
        ours=$work/$name.${form% *}.cw2mesh
        theirs=$work/$name.vn${form#* }.glb
        "$bin/cw2-bake" "$model" -o "$ours" --textures none --compress --tangent-frame ${form% *} --quiet 2>/dev/null
        [[ -f $theirs ]] || node "$work/node_modules/gltfpack/cli.js" -i "$model" -o "$theirs" \
            -gt -kv -tr -cc -vp 16 -vt 16 -vn ${form#* }
        row+=$(stat -c %s "$ours" "$theirs" | paste -s | awk '{ printf " %d %d %.2f;", $1, $2, $1 / $2 }')
        times+=" $("$bin/bench_decode" "$ours" | sed 's/.*: //');"
    done
    echo "$row$times"
done
