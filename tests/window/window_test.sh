#!/usr/bin/env bash
# What a user does with the window, and what must come of it.
# Usage: window_test.sh CHECK CW2 TOOLS SOURCES SCENE WORK; TOOLS is the folder of the tests'
# programs, SOURCES the repository's root, WORK a folder for what the test writes.
set -euo pipefail

check=$1 cw2=$2 tools=$3 sources=$4 scene=$5 work=$6
scene_given=$scene
# shellcheck disable=SC2034 # for session.sh
screen=1200x800x24
rm -rf "$work"
mkdir -p "$work"
# shellcheck source-path=SCRIPTDIR
source "${0%/*}/session.sh"

# What the render tests see the stage with.
camera=(--camera-position 0.3,1.6,4.3 --camera-target 0,0.75,0 --fov 42 --light-position 2.5,3.5,3)
options=(--size 256x144 --samples 1 "${camera[@]}")
large=(--size 780x480 --samples 1 "${camera[@]}")

check_shows_the_headless_picture() {
    open_window "$cw2" "$scene" "${options[@]}"
    take_picture
    expect_headless "${options[@]}"
    title_has "stage.cw2mesh - shaded" || fail "title"
    wait_until title_has " ms"
    close_window

    # What is not given is the same, too.
    open_window "$cw2" "$scene" --size 160x120 --time 1.2 --view normal
    take_picture
    expect_headless --size 160x120 --time 1.2 --view normal
    close_window

    open_window "$cw2" "$scene" --size 160x120 --samples 4 --no-normal-map --no-alpha-mask
    take_picture
    expect_headless --size 160x120 --no-normal-map --no-alpha-mask
    local first=$picture
    # All that the window shows, too, is the mean.
    take_window_picture
    expect_same "$first" "$picture"
    take_picture
    [[ $picture != "$first" ]] || fail "a screenshot took the place of another"
    expect_same "$first" "$picture"
    close_window
}

check_space_moves_and_stops_the_light() {
    open_window "$cw2" "$scene" "${options[@]}"
    take_picture
    local start=$picture
    take_picture
    expect_same "$start" "$picture"
    press space
    wait_until picture_differs_from "$start"
    local early=$picture
    wait_until picture_differs_from "$early"
    press space
    take_picture
    local stopped=$picture
    take_picture
    expect_same "$stopped" "$picture"
    expect_different "$start" "$picture"
    press r
    take_picture
    expect_same "$start" "$picture"
    close_window
}

check_switches_normal_map_and_alpha_mask() {
    open_window "$cw2" "$scene" "${options[@]}"
    take_picture
    local start=$picture
    press n
    take_picture
    expect_different "$start" "$picture"
    expect_headless "${options[@]}" --no-normal-map
    press n
    take_picture
    expect_same "$start" "$picture"
    press m
    take_picture
    expect_different "$start" "$picture"
    expect_headless "${options[@]}" --no-alpha-mask
    press m
    take_picture
    expect_same "$start" "$picture"
    close_window
}

check_switches_views() {
    open_window "$cw2" "$scene" "${options[@]}"
    take_picture
    local start=$picture
    press 9
    wait_until title_has "stage.cw2mesh - masking"
    take_picture
    expect_headless "${options[@]}" --view masking
    press v
    wait_until title_has " - fresnel"
    take_picture
    expect_headless "${options[@]}" --view fresnel
    press 1
    wait_until title_has " - shaded"
    press shift+v
    wait_until title_has " - $("$cw2" --list-views | tail -n 1 | cut -d " " -f 1)"
    # Shift and a digit is one of the next nine.
    press shift+2
    wait_until title_has " - base-color"
    press shift+v
    wait_until title_has " - fresnel"
    press 1
    wait_until title_has " - shaded"
    press v
    wait_until title_has " - normal"
    press shift+v
    wait_until title_has " - shaded"
    # With control these are no commands.
    press ctrl+n ctrl+m ctrl+v ctrl+2
    take_picture
    expect_same "$start" "$picture"
    close_window
}

check_moves_the_camera() {
    open_window "$cw2" "$scene" "${options[@]}"
    take_picture
    local start=$picture key
    for key in w s a d e q; do
        xdotool keydown $key
        wait_until picture_differs_from "$start"
        xdotool keyup $key
        press r
        take_picture
        expect_same "$start" "$picture"
    done

    close_window
}

# `line` is then the camera as options.
read_camera() {
    press_for_line ctrl+c
    [[ $line == --camera-position* ]] || fail "no camera: $line"
}

# The camera's target, as options print it.
target_of() {
    sed 's/.*--camera-target \([^ ]*\) .*/\1/' <<<"$1"
}

# How far apart two points X,Y,Z are.
distance() {
    awk -v a="$1" -v b="$2" 'BEGIN {
        split(a, p, ","); split(b, q, ",")
        print sqrt((p[1]-q[1])^2 + (p[2]-q[2])^2 + (p[3]-q[3])^2) }'
}

position_of() {
    sed 's/--camera-position \([^ ]*\) .*/\1/' <<<"$1"
}

less() {
    awk -v a="$1" -v b="$2" 'BEGIN { exit !(a < b) }'
}

# Drags from X Y by DX DY with a button.
drag() {
    xdotool mousemove --window "$window" "$1" "$2" mousedown "${5:-1}" \
        mousemove_relative -- "$(($3 / 2))" "$(($4 / 2))" mousemove_relative -- "$(($3 - $3 / 2))" \
        "$(($4 - $4 / 2))" mouseup "${5:-1}"
}

check_orbits_pans_and_looks() {
    open_window "$cw2" "$scene" "${options[@]}"
    take_picture
    local start=$picture at_start
    read_camera
    at_start=$line

    # The target and its distance stay; the light, too.
    drag 100 70 60 20
    read_camera
    [[ $(target_of "$line") == $(target_of "$at_start") ]] || fail "the target: $line"
    local far moved
    moved=$(distance "$(position_of "$line")" "$(position_of "$at_start")")
    less 0.5 "$moved" || fail "orbited by $moved"
    far=$(distance "$(position_of "$line")" 0,0.75,0)
    less 4.38 "$far" && less "$far" 4.40 || fail "distance $far"
    local flags=$line
    take_picture
    # shellcheck disable=SC2086 # several words
    expect_headless "${options[@]:0:4}" $flags
    press r

    # Both are moved by the same way, by either button: 144 pixels are 2 * 4.38 * tan(21).
    local button
    for button in 2 shift; do
        if [[ $button == shift ]]; then
            xdotool keydown shift
            drag 100 70 0 72
            xdotool keyup shift
        else
            drag 100 70 0 72 2
        fi
        read_camera
        moved=$(distance "$(target_of "$line")" 0,0.75,0)
        less 1.67 "$moved" && less "$moved" 1.70 || fail "panned by $moved"
        less 0.75 "$(target_of "$line" | cut -d, -f2)" || fail "panned the wrong way: $line"
        moved=$(distance "$(position_of "$line")" "$(position_of "$at_start")")
        less 1.67 "$moved" && less "$moved" 1.70 || fail "panned by $moved"
        press r
        take_picture
        expect_same "$start" "$picture"
    done

    xdotool mousemove --window "$window" 100 70 mousedown 3
    drag_changes() {
        xdotool mousemove_relative 30 10
        picture_differs_from "$start"
    }
    wait_until drag_changes
    xdotool mouseup 3
    take_picture
    local turned=$picture
    read_camera
    [[ $(position_of "$line") == $(position_of "$at_start") ]] || fail "looking moves: $line"
    xdotool mousemove_relative 30 10
    take_picture
    expect_same "$turned" "$picture"
    press r
    take_picture
    expect_same "$start" "$picture"
    close_window
}

check_goes_towards_what_is_under_the_cursor() {
    open_window "$cw2" "$scene" "${large[@]}"
    local before after point
    read_camera
    before=$(position_of "$line")
    # What the pixel shows, and where the camera goes: straight to it, three notches of 0.85 each.
    click 420 400
    wait_until grep -q '^pixel 420,400' "$work/out"
    point=$(sed -n 's/^pixel 420,400:.* position \([^;]*\);.*/\1/p' "$work/out")
    xdotool click --repeat 3 --delay 20 4
    camera_is_nearer() {
        read_camera
        awk -v a="$(distance "$(position_of "$line")" "$point")" \
            -v b="$(distance "$before" "$point")" \
            'BEGIN { f = a / b / (0.85 ^ 3); exit !(f > 0.999 && f < 1.001) }'
    }
    wait_until camera_is_nearer
    # The point is still there. A click elsewhere comes first, so that two make no double click.
    click 400 440
    wait_until grep -q '^pixel 400,440' "$work/out"
    click 420 400
    was_read_twice() {
        [[ $(grep -c '^pixel 420,400' "$work/out") -eq 2 ]]
    }
    wait_until was_read_twice
    after=$(sed -n 's/^pixel 420,400:.* position \([^;]*\);.*/\1/p' "$work/out" | tail -n 1)
    less "$(distance "$after" "$point")" 0.02 || fail "$point has become $after"
    xdotool mousemove --window "$window" 420 400 click --repeat 3 --delay 20 5
    camera_is_back() {
        read_camera
        less "$(distance "$(position_of "$line")" "$before")" 0.001
    }
    wait_until camera_is_back
    # A double click makes what is there the target, and leaves the camera where it is.
    xdotool mousemove --window "$window" 420 400 click --repeat 2 --delay 50 1
    target_is_there() {
        read_camera
        less "$(distance "$(target_of "$line")" "$point")" 0.001
    }
    wait_until target_is_there
    less "$(distance "$(position_of "$line")" "$before")" 0.001 || fail "the camera moved: $line"
    close_window
}

check_frames_what_is_asked_for() {
    open_window "$cw2" "$scene" --size 256x144 --samples 1
    take_picture
    local start=$picture key
    # It begins with everything in view; both keys come back to that from the same direction.
    for key in f Home; do
        drag 128 72 0 40 2
        picture_differs_from "$start" || fail "nothing was panned"
        press $key
        take_picture
        different "$start" "$picture" && fail "$key does not bring everything into view"
    done
    # A material that was clicked is nearer then.
    read_camera
    local far=$line
    press shift+f
    read_camera
    [[ $line == "$far" ]] || fail "framed what nobody clicked: $line"
    click 128 85
    wait_until grep -q '^pixel 128,85' "$work/out"
    press shift+f
    read_camera
    less "$(distance "$(position_of "$line")" "$(target_of "$line")")" \
        "$(distance "$(position_of "$far")" "$(target_of "$far")")" || fail "not nearer: $line"
    close_window
}

check_drags_the_light() {
    open_window "$cw2" "$scene" "${options[@]}" --time 1 --orbit-axis x
    take_picture
    local start=$picture at_start
    read_camera
    at_start=$line
    xdotool keydown l
    drag 100 70 60 20
    xdotool keyup l
    take_picture
    expect_different "$start" "$picture"
    read_camera
    [[ ${line%% --light*} == "${at_start%% --light*}" ]] || fail "the camera moved: $line"
    save_settings F2
    expect_headless --config "$saved"
    press r
    take_picture
    expect_same "$start" "$picture"
    close_window
}

check_turns_back_faces() {
    # From behind the leaves, and below the floor.
    local behind=(--size 256x144 --samples 1 --camera-position -1,-2,-4 --camera-target 0,0.75,0)
    open_window "$cw2" "$scene" "${behind[@]}"
    take_picture
    local start=$picture
    press t
    take_picture
    expect_different "$start" "$picture"
    expect_headless "${behind[@]}" --two-sided
    press t
    take_picture
    expect_same "$start" "$picture"
    close_window
}

check_explains_itself() {
    open_window "$cw2" "$scene" "${large[@]}"
    # Before any key a line lies over the picture; the screenshot is without it.
    take_window_picture
    local start=$picture key
    for key in h question F1; do
        press $key
        take_window_picture
        expect_different "$start" "$picture"
        press Escape
        take_window_picture
        expect_same "$start" "$picture"
    done
    # Every key and what the mouse does is in --help, too.
    "$cw2" --help | grep -q "Shift+F12  *saves the whole window" || fail "--help has no keys"
    close_window
}

# OBJs are baked into the cache, at the start, when opened and when a source has changed.
check_bakes_what_it_opens() {
    export XDG_CACHE_HOME=$work/cache
    local name square='v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nusemtl a\nf 1 2 3 4\n'
    mkdir "$work/obj"
    for name in first second; do
        printf "mtllib $name.mtl\n$square" >"$work/obj/$name.obj"
        printf 'newmtl a\nKd 1 0 0\n' >"$work/obj/$name.mtl"
    done
    local scene=$work/obj/first.obj
    open_window "$cw2" "$scene" "$work/obj/second.obj" --size 256x144 --samples 1
    wait_until title_has "first.obj (1 of 2)"
    take_picture
    local red=$picture
    expect_headless --size 256x144 --samples 1
    scene=$work/obj/second.obj
    press Next
    wait_until title_has "second.obj (2 of 2)"
    take_picture
    expect_same "$red" "$picture"
    printf 'newmtl a\nKd 0 1 0\n' >"$work/obj/second.mtl"
    wait_until picture_differs_from "$red"
    expect_headless --size 256x144 --samples 1
    close_window
}

check_notices_what_is_saved_while_it_bakes() {
    export XDG_CACHE_HOME=$work/cache
    mkdir "$work/bin" "$work/obj"
    cp "$cw2" "$work/bin/cw2"
    # It has read everything, and ends only once that has changed.
    printf '#!/bin/sh\n"%s" "$@"\nstatus=$?\ntouch "%s"\nuntil [ -e "%s" ]; do sleep 0.02; done\nexit $status\n' \
        "${cw2%/*}/cw2-bake" "$work/baked" "$work/edited" >"$work/bin/cw2-bake"
    chmod +x "$work/bin/cw2-bake"
    local scene=$work/obj/a.obj
    printf 'mtllib a.mtl\nv -1 -1 0\nv 1 -1 0\nv 1 1 0\nusemtl a\nf 1 2 3\n' >"$scene"
    printf 'newmtl a\nKd 1 0 0\n' >"$work/obj/a.mtl"
    (
        until [[ -e $work/baked ]]; do sleep 0.02; done
        printf 'newmtl a\nKd 0 1 0\n' >"$work/obj/a.mtl"
        touch "$work/edited"
    ) &
    open_window "$work/bin/cw2" "$scene" --size 256x144 --samples 1
    "$cw2" "$scene" --output "$work/green.png" --size 256x144 --samples 1
    shows_green() {
        take_picture
        "$tools/compare_images" "$work/green.png" "$picture"
    }
    wait_until shows_green
    close_window
}

check_opens_other_files() {
    local other=$work/other.cw2mesh broken=$work/broken.cw2mesh
    "${cw2%/*}/cw2-bake" "${scene%/*}/plate.obj" -o "$other" --quiet --textures none
    echo nonsense >"$broken"
    open_window "$cw2" "$scene" "$other" "$broken" --size 256x144 --samples 1
    take_picture
    local start=$picture
    wait_until title_has "stage.cw2mesh (1 of 3) - shaded"
    press Next
    wait_until title_has "other.cw2mesh (2 of 3) - shaded"
    take_picture
    local second=$picture
    local scene=$other
    expect_headless --size 256x144 --samples 1
    # What cannot be opened leaves the picture and says why.
    press Next
    wait_until test -s "$work/err"
    [[ $(<"$work/err") == "cw2: $broken: "* ]] || fail "no error with the file"
    take_picture
    expect_same "$second" "$picture"
    : >"$work/err"
    press Next
    wait_until title_has "stage.cw2mesh (1 of 3)"
    take_picture
    expect_same "$start" "$picture"

    "$tools/drop" "$window" "$other" || fail "not taken"
    wait_until title_has "other.cw2mesh (2 of 4)"
    take_picture
    expect_same "$second" "$picture"
    # The file that is watched is the one that is shown.
    cp "$broken" "$other"
    wait_until test -s "$work/err"
    grep -aq "cw2: $other: " "$work/err" || fail "no error with the file"
    : >"$work/err"

    # Typed, and completed.
    cp "$scene_given" "$work/stage.cw2mesh"
    take_window_picture
    press ctrl+o
    wait_until window_picture_differs_from "$picture"
    xdotool type "$work/stag"
    press Tab
    press Return
    wait_until title_has "stage.cw2mesh (3 of 5)"
    take_picture
    expect_same "$start" "$picture"
    take_window_picture
    press ctrl+o
    wait_until window_picture_differs_from "$picture"
    xdotool type "nonsense"
    press Escape
    take_picture
    expect_same "$start" "$picture"
    close_window
}

# Presses Shift+F12; `picture` is then the path of all that the window showed.
take_window_picture() {
    take_picture shift+F12
}

window_picture_differs_from() {
    take_window_picture
    different "$1" "$picture"
}

check_shows_and_hides_the_panel() {
    open_window "$cw2" "$scene" "${large[@]}"
    take_picture
    local start=$picture
    take_window_picture
    expect_same "$start" "$picture"
    press Tab
    take_window_picture
    expect_different "$start" "$picture"
    # The panel is no part of the picture.
    take_picture
    expect_same "$start" "$picture"
    expect_headless "${large[@]}"
    press Tab
    take_window_picture
    expect_same "$start" "$picture"
    close_window
}

check_drags_the_divider() {
    open_window "$cw2" "$scene" "${options[@]}" --split normal,shaded --divider 0.25
    wait_until title_has "stage.cw2mesh - normal | shaded"
    take_picture
    local start=$picture
    # Beside it something else is taken hold of.
    drag 90 70 60 0
    press r
    take_picture
    expect_same "$start" "$picture"
    xdotool mousemove --window "$window" 64 70 mousedown 1 mousemove_relative 40 10
    wait_until picture_differs_from "$start"
    xdotool mousemove --window "$window" 192 30 mouseup 1
    xdotool mousemove_relative 20 0
    picture_is_headless() {
        take_picture
        "$cw2" "$scene" --output "$work/dragged.png" "${options[@]}" --split normal,shaded \
            --divider 0.75
        ! different "$work/dragged.png" "$picture"
    }
    wait_until picture_is_headless
    save_settings F2
    grep -qx 'divider = 0.75' "$saved" || fail "the divider is not where it was let go"
    close_window
}

check_shows_legends() {
    open_window "$cw2" "$scene" --size 480x270 --samples 1 "${camera[@]}" --false-color auto \
        --view distribution
    take_picture
    expect_headless --size 480x270 --samples 1 "${camera[@]}" --false-color auto --view distribution
    local picture_of_file=$picture
    take_window_picture
    expect_same "$picture_of_file" "$picture"
    close_window
    open_window "$cw2" "$scene" "${options[@]}" --exposure 2.5
    take_picture
    expect_headless "${options[@]}" --exposure 2.5
    close_window
}

# Presses a key; `saved` is then the path of the config file that was written.
save_settings() {
    press_for_file saved "$1"
    [[ $saved == *.toml ]] || fail "$saved is no file of settings"
}

check_saves_what_it_shows() {
    open_window "$cw2" "$scene" "${options[@]}" --roughness 0.4 --background 0.2,0,0.1
    take_picture
    local start=$picture
    press space
    xdotool keydown w
    wait_until picture_differs_from "$start"
    xdotool keyup w
    press space n 7
    xdotool windowsize "$window" 300 200
    wait_until picture_differs_from "$picture"
    save_settings F2
    take_picture
    expect_different "$start" "$picture"
    expect_headless --config "$saved"
    local first=$saved
    save_settings F2
    [[ $saved != "$first" ]] || fail "a file of settings took the place of another"
    same "$first" "$saved" || fail "the same state made two files"
    close_window
    # A window begins where the other was left.
    mv "$saved" "$work/saved.toml"
    open_window "$cw2" --config "$work/saved.toml"
    take_picture
    expect_headless --config "$work/saved.toml"
    close_window
}

check_gives_keys_to_the_panel_while_it_has_the_focus() {
    open_window "$cw2" "$scene" "${large[@]}"
    take_picture
    local start=$picture
    press Tab
    take_window_picture
    save_settings s
    xdotool keydown w
    # The key is held while each of these is drawn.
    take_picture
    take_picture
    xdotool keyup w
    expect_same "$start" "$picture"
    # Between the panel's parts, which gives the keys back.
    xdotool mousemove --window "$window" 420 50 click 1
    xdotool keydown w
    wait_until picture_differs_from "$start"
    xdotool keyup w
    close_window
}

check_reloads_the_scene() {
    local scene_before=$scene
    scene=$work/stage.cw2mesh
    cp "$scene_before" "$scene"
    open_window "$cw2" "$scene" "${large[@]}"
    xdotool keydown w
    take_picture
    local start=$picture
    wait_until picture_differs_from "$start"
    xdotool keyup w
    # With a pixel whose numbers are shown, also of the next scene.
    press Tab
    click 420 400
    wait_until grep -q '^pixel 420,400' "$work/out"
    press v
    take_picture
    start=$picture

    # Half of it, and then something else: a line each, and the picture stays.
    head -c 2000 "$scene_before" >"$scene"
    wait_until test -s "$work/err"
    [[ $(<"$work/err") == "cw2: $scene: "* ]] || fail "no error with the file"
    wait_until title_has "stage.cw2mesh: "
    take_picture
    expect_same "$start" "$picture"
    : >"$work/err"
    rm "$scene"
    "${cw2%/*}/cw2-bake" "${scene_before%/*}/stage_z_up.obj" -o "$scene" --quiet --textures lossless
    wait_until picture_differs_from "$start"
    title_has "stage.cw2mesh: " && fail "the error is still in the title"
    [[ ! -s $work/err ]] || fail "a scene that is gone for a moment is no error"
    save_settings F2
    take_picture
    expect_headless --config "$saved"

    cp "$scene_before" "$scene.new"
    mv "$scene.new" "$scene"
    picture_is_as_before() {
        take_picture
        same "$start" "$picture"
    }
    wait_until picture_is_as_before
    close_window
}

check_survives_what_takes_the_place_of_the_scene() {
    local scene_before=$scene what
    scene=$work/stage.cw2mesh
    cp "$scene_before" "$scene"
    open_window "$cw2" "$scene" "${options[@]}"
    take_picture
    local start=$picture
    for what in "mkdir" "mkfifo" "truncate -s 1T" "head -c 100000 /dev/urandom >" "touch" \
        "mknod -m 0 unreadable c 1 5; ln -s unreadable" "ln -s ."; do
        rm -rf "$scene"
        (cd "$work" && eval "$what stage.cw2mesh") || continue # only root makes devices
        wait_until test -s "$work/err"
        [[ $(tr -d '\0' <"$work/err") == "cw2: $scene: "* ]] || fail "no error with the file"
        take_picture
        expect_same "$start" "$picture"
        : >"$work/err"
    done
    rm -rf "$scene"
    cp "$scene_before" "$scene"
    wait_until eval '! title_has "stage.cw2mesh: "'
    take_picture
    expect_same "$start" "$picture"
    close_window
}

# The panel looks as it was found right; CW2_UPDATE_GOLDENS takes what it looks like now. After a
# click at $2 $3 the numbers of the pixel are there; $4 $5 is where the cursor lights up nothing.
compare_panel() {
    local golden=$sources/tests/window/$1
    local shown=$picture
    click "$2" "$3"
    wait_until grep -q "^pixel $2,$3" "$work/out"
    wait_until window_picture_differs_from "$shown"
    xdotool mousemove --window "$window" "$4" "$5"
    # The words under the buttons stay the same.
    press ctrl+c
    wait_until grep -q -- --camera-position "$work/out"
    take_window_picture
    if [[ -n ${CW2_UPDATE_GOLDENS:-} ]]; then
        cp "$picture" "$golden"
    else
        # Another version of Dear ImGui rounds corners and ends lines a little otherwise.
        "$tools/compare_images" --report "$work/report" "$golden" "$picture" ||
            "$tools/compare_images" "${golden%.png}.imgui190.png" "$picture" || fail "the panel"
    fi
    close_window
}

panel_scene=(--size 1180x700 --samples 1 "${camera[@]}" --split base-color,shaded
    --false-color 0,1 --roughness 0.25 --view normal)

check_draws_the_panel() {
    open_window "$cw2" "$scene" "${panel_scene[@]}"
    press Tab
    take_window_picture
    local shown=$picture
    # The readings of the frame tell times: they are closed.
    click 900 43
    # Waits for the click to be handled: the shift of what follows would make it another one.
    take_picture
    wait_until window_picture_differs_from "$shown"
    compare_panel panel.png 600 420 620 560
}

check_draws_the_panel_at_192_dpi() {
    "$tools/set_dpi" 192
    open_window "$cw2" "$scene" "${panel_scene[@]}"
    press Tab
    take_window_picture
    compare_panel panel_192_dpi.png 900 420 920 560
}

check_reads_the_numbers_of_a_pixel() {
    open_window "$cw2" "$scene" "${large[@]}"
    take_picture
    # Without the panel a click tells the same on standard output, and the most of it in a line.
    click 420 400
    wait_until has_lines "$work/out" 2
    local told
    told=$(tail -n 1 "$work/out")
    [[ $told == "pixel 420,400: material floor; position "*"; D "*"; shaded "* ]] || fail "read: $told"
    press Tab
    take_window_picture
    local panel=$picture
    click 405 405
    wait_until has_lines "$work/out" 4
    [[ $(tail -n 1 "$work/out") == "pixel 405,405: material floor; "* ]] ||
        fail "read: $(tail -n 1 "$work/out")"
    wait_until window_picture_differs_from "$panel"
    # Not on the panel, nor with another button, nor where nothing is. The right one is last: when
    # it is let go the cursor is put back.
    click 20 300
    click 420 400 2
    click 420 12
    click 420 400 3
    take_picture
    [[ $(tail -n 2 "$work/out" | head -n 1) == *.png ]] || fail "read: $(tail -n 2 "$work/out")"
    close_window
}

# While cw2 is busy a user goes on; what was clicked is where the cursor was then.
check_slow_frames_move_no_click() {
    # Wide enough that the numbers have a window of their own, and move nothing.
    open_window "$cw2" "$scene" --size 1180x480 --samples 1 "${camera[@]}" --split base-color,shaded
    press Tab
    take_window_picture
    # On the panel, and away from it.
    kill -STOP "$window_process"
    click 20 300
    xdotool mousemove --window "$window" 420 400
    kill -CONT "$window_process"
    take_picture
    has_lines "$work/out" 3 && fail "read: $(tail -n 2 "$work/out" | head -n 1)"
    # In the picture, the panel's box "split", and away from it.
    title_has " - base-color | shaded" || fail "no split"
    kill -STOP "$window_process"
    click 420 400
    click 113 65
    xdotool mousemove --window "$window" 420 12
    kill -CONT "$window_process"
    wait_until grep -q '^pixel 420,400: ' "$work/out"
    shows_one_view() {
        title_has " - base-color" && ! title_has "|"
    }
    wait_until shows_one_view
    close_window
}

# The window with its panel; the message in it is the same each time.
take_panel_picture() {
    press_for_line ctrl+c
    take_window_picture
}

check_reads_what_has_changed_while_the_panel_was_hidden() {
    open_window "$cw2" "$scene" "${large[@]}"
    take_picture
    local start=$picture
    press Tab
    click 420 400
    wait_until grep -q '^pixel 420,400' "$work/out"
    press Tab
    xdotool keydown w
    wait_until picture_differs_from "$start"
    xdotool keyup w
    take_picture
    press Tab
    take_panel_picture
    local back=$picture
    # Something changes, and is as it was.
    press n n
    take_panel_picture
    expect_same "$back" "$picture"
    close_window
}

# A copy of the sources, and in `edited` the path of a shader in it.
copy_sources() {
    mkdir "$work/sources"
    cp -r "$sources/shaders" "$sources/mesh-format" "$sources/common" "$work/sources/"
    edited=$work/sources/shaders/opaque.frag
}

check_reloads_shaders() {
    copy_sources
    open_window "$tools/cw2_with_sources" "$work/sources" "$scene" "${options[@]}"
    take_picture
    local start=$picture
    # Somewhere that a reset would leave.
    xdotool keydown w
    wait_until picture_differs_from "$start"
    xdotool keyup w
    take_picture
    start=$picture
    press F5
    take_picture
    expect_same "$start" "$picture"

    sed -i 's/view_color(1\.0, vec3(0\.0))/1.0 - &/' "$edited"
    press F5
    take_picture
    expect_different "$start" "$picture"
    local negative=$picture

    printf '#version 460\nvoid main() {\n    nonsense = 1;\n}\n' >"$edited"
    press F5
    wait_until title_has "shaders/opaque.frag:3: "
    take_picture
    expect_same "$negative" "$picture"
    [[ $(<"$work/err") == "cw2: $edited:3: "*nonsense* ]] || fail "no error with file and line"
    has_lines "$work/err" 2 && fail "more than one line"
    : >"$work/err"

    cp "$sources/shaders/opaque.frag" "$edited"
    press ctrl+r
    wait_until title_has "stage.cw2mesh - shaded"
    take_picture
    expect_same "$start" "$picture"
    title_has "opaque.frag" && fail "the error is still in the title"
    close_window
}

check_ends_with_1_after_a_validation_message() {
    copy_sources
    open_window "$tools/cw2_with_sources" "$work/sources" "$scene" "${options[@]}"
    # The layers warn of a vertex shader whose outputs nobody reads.
    printf '#version 460\nlayout(location = 0) out vec4 color;\nvoid main() { color = vec4(1); }\n' \
        >"$edited"
    press F5
    take_picture
    press Escape
    local status=0
    wait "$window_process" || status=$?
    window_process=
    [[ $status -eq 1 && $(<"$work/err") == "cw2: validation: "* ]] || fail "status $status"
}

# Width and height in the header of a PNG.
size_of() {
    echo $((16#$(od -An -tx1 -j16 -N4 "$1" | tr -d ' ')))x$((16#$(od -An -tx1 -j20 -N4 "$1" | tr -d ' ')))
}

check_survives_resizing_and_minimising() {
    open_window "$cw2" "$scene" "${options[@]}"
    picture_has_size() {
        take_picture
        [[ $(size_of "$picture") == "$1" ]]
    }
    local size
    for size in 300x200 1x1 120x250; do
        xdotool windowsize "$window" "${size%x*}" "${size#*x}"
        wait_until picture_has_size $size
    done
    expect_headless --size 120x250 --samples 1 "${camera[@]}"
    # While the light moves, so that every size is drawn.
    press space
    for size in 200 190 180 170 160 150; do xdotool windowsize "$window" $size $size; done
    wait_until picture_has_size 150x150
    press space r
    take_picture
    local start=$picture

    "$tools/minimise" "$window" yes
    "$tools/minimise" "$window" no
    wait_until has_focus
    take_picture
    expect_same "$start" "$picture"
    press space
    "$tools/minimise" "$window" yes
    "$tools/minimise" "$window" no
    wait_until has_focus
    wait_until picture_differs_from "$start"
    close_window
}

# cw2 must end with a status of 1 and one line that has the words.
expect_complaint() {
    local words=$1 status=0
    shift
    "$@" >"$work/out" 2>"$work/err" || status=$?
    [[ $status -eq 1 ]] || fail "status $status of: $*"
    [[ $(wc -l <"$work/err") -eq 1 && $(<"$work/err") == "cw2: "*"$words"* ]] ||
        fail "not one line with '$words'"
}

check_says_what_it_cannot_do() {
    expect_complaint "nothing_there.cw2mesh" "$cw2" "$work/nothing_there.cw2mesh"
    expect_complaint "--size" "$cw2" "$scene" --size 40000x20
    expect_complaint "no such device" "$cw2" "$scene" --device "no such device"
    expect_complaint "--output" env -u DISPLAY -u WAYLAND_DISPLAY "$cw2" "$scene"
}

start_display
"check_$check"
