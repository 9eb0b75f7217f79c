# shellcheck shell=bash
# A display of its own, a window of cw2 in it, and a user; sourced by scripts whose $work is where
# everything is written, and $scene what cw2 shows. Nothing here waits for a time, only for what should happen.

window_process=
display_process=
trap stop_all EXIT
exec 4>&1

stop_all() {
    local process
    for process in $window_process $display_process; do kill "$process" 2>/dev/null || true; done
    wait
}

# Ends the test, also where a condition's output is thrown away; says which line asked for what.
fail() {
    {
        echo "FAILED: $*"
        local frame=0
        while caller $frame; do frame=$((frame + 1)); done
        [[ ! -s $work/err ]] || { echo "cw2 said:" && cat "$work/err"; }
    } >&4
    exit 1
}

# Waits until a command succeeds, as long as cw2 is running.
wait_until() {
    local deadline=$((SECONDS + 60))
    until "$@" >/dev/null 2>&1; do
        [[ -z $window_process ]] || kill -0 "$window_process" 2>/dev/null ||
            fail "cw2 ended while waiting for: $*"
        ((SECONDS < deadline)) || fail "waited a minute for: $*"
        sleep 0.05
    done
}

start_display() {
    local program
    for program in Xvfb xdotool; do
        command -v $program >/dev/null || fail "$program is not installed"
    done
    # The server chooses a free number and says it. It would start anew whenever its last client
    # leaves, just when cw2 comes.
    Xvfb -displayfd 3 -screen 0 "${screen:-800x600x24}" -nolisten tcp -noreset \
        3>"$work/display" >"$work/xvfb.log" 2>&1 &
    display_process=$!
    wait_until test -s "$work/display"
    DISPLAY=:$(<"$work/display")
    export DISPLAY
}

has_focus() {
    xdotool windowfocus "$window"
    [[ $(xdotool getwindowfocus) == "$window" ]]
}

find_window() {
    window=$(xdotool search --onlyvisible --name "${scene##*/}")
    [[ -n $window ]]
}

# Starts a command that opens a window, in an empty folder, and gives it the keyboard.
open_window() {
    rm -rf "$work/shots"
    mkdir "$work/shots"
    cd "$work/shots"
    "$@" --validation >"$work/out" 2>"$work/err" &
    window_process=$!
    wait_until find_window
    wait_until has_focus
    cd "$work"
}

# Presses Escape; cw2 must end with status 0 and must have had nothing to complain about but what
# the caller has taken out of $work/err.
close_window() {
    local status=0
    press Escape
    wait "$window_process" || status=$?
    window_process=
    [[ $status -eq 0 ]] || fail "cw2 ended with status $status"
    [[ ! -s $work/err ]] || fail "cw2 complained"
}

press() {
    xdotool key "$@"
}

has_lines() {
    [[ $(wc -l <"$1") -ge $2 ]]
}

# Presses a key on which cw2 prints a line; `line` is then that line.
press_for_line() {
    local count
    count=$(($(wc -l <"$work/out") + 1))
    press "$1"
    wait_until has_lines "$work/out" $count
    line=$(tail -n 1 "$work/out")
}

# The same with a key that saves a file; gives its path by the name $1.
press_for_file() {
    press_for_line "$2"
    local -n path=$1
    path=$work/shots/$line
    [[ -f $path ]] || fail "$path was announced and is not there"
}

# Presses F12, or another key; `picture` is then the path of what the window showed.
take_picture() {
    press_for_file picture "${1:-F12}"
}

# Presses and lets go a mouse button at X Y.
click() {
    xdotool mousemove --window "$window" "$1" "$2" mousedown "${3:-1}" mouseup "${3:-1}"
}

title_has() {
    [[ $(xdotool getwindowname "$window") == *"$1"* ]]
}

same() {
    cmp -s "$1" "$2"
}

# As far apart as no driver's rounding is.
different() {
    local status=0
    "$tools/compare_images" "$1" "$2" >/dev/null || status=$?
    [[ $status -eq 1 ]]
}

picture_differs_from() {
    take_picture
    different "$1" "$picture"
}

expect_same() {
    same "$1" "$2" || fail "$1 and $2 are not the same picture"
}

expect_different() {
    different "$1" "$2" || fail "$1 and $2 are alike"
}

# The picture must look like what headless cw2 draws with these options.
expect_headless() {
    "$cw2" "$scene" --output "$work/headless.png" "$@" || fail "headless cw2"
    "$tools/compare_images" --report "$work/report" "$work/headless.png" "$picture" ||
        fail "the window's picture is not the one of: $*"
}
