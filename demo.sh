#!/usr/bin/env bash
# Installs what is missing, builds Release, makes the demo scene, bakes it, renders the pictures
# below into build/demo and opens the window where there is a display.
# With the argument `figures` it draws the pictures of docs/figures.md instead.
set -euo pipefail
cd "$(dirname "$0")"

if [[ $# -gt 1 || ${1:-figures} != figures ]]; then
    echo "usage: ./demo.sh [figures]" >&2
    exit 2
fi

court='--camera-position 7.8,2.5,2.3 --camera-target -1.5,2.15,-0.3
       --light-position 4,7,5'
lion='--camera-position 2.6,2.6,3 --camera-target 1.15,2.35,1.15
      --light-position 5,4.5,2.5'
plants='--camera-position 9.35,1.5,0.35 --camera-target 5.9,1.15,-2.9
        --light-position 8,5,3'
# picture | what cw2 is told besides the scene
pictures="
overview       |
courtyard      | ${court//$'\n'/}
courtyard-5s   | ${court//$'\n'/} --time 5.4
lion           | ${lion//$'\n'/}
lion-5s        | ${lion//$'\n'/} --time 5.4
plants         | ${plants//$'\n'/}
normal         | ${court//$'\n'/} --view normal
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

third_party/install_packages.sh --needed
# On a terminal one sees what is done.
if [[ -t 1 ]]; then
    quiet=()
    cmake --preset release
else
    quiet=(-- --quiet)
    cmake --preset release >/dev/null
fi
if [[ $# -eq 1 ]]; then
    cmake --build --preset release --target figures "${quiet[@]}"
    echo "See docs/figures.md and docs/figures/."
    exit
fi
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

read -ra arguments <<<"${court//$'\n'/}"
window=("$cw2" "$scene" "${arguments[@]}")
echo "To open the window: cd $PWD && ${window[*]}"
if [[ -t 1 && -n ${DISPLAY:-} ]]; then
    exec "${window[@]}"
fi
