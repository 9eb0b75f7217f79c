#!/usr/bin/env bash
# Draws docs/panel.png: the window with its panel over the demo scene, in a display of its own.
# Usage: docs/panel_picture.sh BUILD_DIRECTORY    (the target `panel-picture` calls it)
set -euo pipefail
build=$(realpath "$1")
cd "$(dirname "$0")"
docs=$PWD cw2=$build/bin/cw2 scene=$build/figures/courtyard.cw2mesh work=$build/figures/panel
# shellcheck disable=SC2034 # for session.sh
screen=1280x800x24
rm -rf "$work"
mkdir -p "$work"
# shellcheck source-path=SCRIPTDIR/../tests/window
source ../tests/window/session.sh

"$build/bin/cw2-bake" "$build/assets/demo/courtyard.obj" -o "$scene" --quiet
start_display
open_window "$cw2" "$scene" --size 1200x760 --samples 4 --light-position 4,7,5 \
    --camera-position 7.8,2.5,2.3 --camera-target=-1.5,2.15,-0.3 \
    --split normal,shaded --divider 0.44
press Tab
take_picture shift+F12
# On the lion's mane, where the light falls.
click 580 310
wait_until has_lines "$work/out" 2
take_picture shift+F12
cp "$picture" "$docs/panel.png"
close_window
