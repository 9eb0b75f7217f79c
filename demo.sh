#!/usr/bin/env bash
# Installs what is missing, builds Release, makes the demo scene, bakes it, renders the pictures
# below into build/demo and opens the window where there is a display.
set -euo pipefail
cd "$(dirname "$0")"

court='--camera-position 8.5,2.6,2.2 --camera-target -2,2.3,-1 --light-position 3,6,3'
lion='--camera-position 2.1,2.5,2.5 --camera-target 0,2.3,0 --fov 50 --light-position 3,4,3'
bright='--light-color 3.5,3.5,3.3'
# picture | what cw2 is told besides the scene
pictures="
overview       | --light-color 3,3,3
courtyard      | $court $bright
courtyard-5s   | $court $bright --time 5.4
lion           | $lion $bright --time 0.9
lion-5s        | $lion $bright --time 5.4
normal         | $court --view normal
"

model=build/release/assets/demo/courtyard.obj
scene=build/demo/courtyard.cw2mesh
bake=build/release/bin/cw2-bake
cw2=build/release/bin/cw2

# Runs a command, then prints the path it made and the seconds it took.
timed() {
    local path=$1 start=${EPOCHREALTIME/[.,]/} centiseconds
    shift
    "$@"
    centiseconds=$(((${EPOCHREALTIME/[.,]/} - start) / 10000))
    printf '%-36s %3d.%02d s\n' "$path" $((centiseconds / 100)) $((centiseconds % 100))
}

third_party/install_packages.sh
cmake --preset release >/dev/null
[[ -t 1 ]] && quiet=() || quiet=(-- --quiet)
cmake --build --preset release --target cw2 cw2-bake demo-scene "${quiet[@]}"

mkdir -p build/demo
if [[ ! $scene -nt $model || ! $scene -nt $bake ]]; then
    timed "$scene" "$bake" "$model" -o "$scene"
fi
while IFS='|' read -r name arguments; do
    [[ -n $name ]] || continue
    read -ra arguments <<<"$arguments"
    picture=build/demo/${name%% *}.png
    timed "$picture" "$cw2" "$scene" --output "$picture" "${arguments[@]}" </dev/null
done <<<"$pictures"

read -ra arguments <<<"$court $bright"
window=("$cw2" "$scene" "${arguments[@]}")
echo "To open the window: cd $PWD && ${window[*]}"
if [[ -t 1 && -n ${DISPLAY:-} ]]; then
    exec "${window[@]}"
fi
