#!/usr/bin/env bash
# Works with the editor as somebody would who has never seen it, in a virtual display: picks a sky, moves the sun, compares,
# undoes, saves, exports a panorama with its layers, makes a time-lapse, is killed, and recovers. Each step is checked by what
# it leaves on the disk, and its picture is kept. Argument: the folder for the pictures, docs/tour by default.
set -euo pipefail
pictures=$(realpath -m "${1:-"$(dirname "${BASH_SOURCE[0]}")/../docs/tour"}")
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" test

for tool in Xvfb xdotool; do command -v "$tool" >/dev/null || fail "$tool is missing"; done
cargo build --locked --quiet --bin nephoscope --example framebuffer
mkdir -p "$pictures"
temporary_folder
folder=$made_folder
mkdir "$folder/screen" "$folder/home" "$folder/work"

Xvfb -displayfd 3 -screen 0 1280x800x24 -nolisten tcp -noreset -fbdir "$folder/screen" 3>"$folder/display" 2>"$folder/xvfb.log" &
server=$!
ended_on_exit+=("$server")
for _ in {1..100}; do
    [[ -s $folder/display ]] && break
    sleep 0.1
done
[[ -s $folder/display ]] || fail "Xvfb did not start: $(cat "$folder/xvfb.log")"
DISPLAY=:$(cat "$folder/display")
export DISPLAY
program=$(realpath "$program")
shown=$(realpath "${CARGO_TARGET_DIR:-target}/debug/examples/framebuffer")

start() {
    # Documents and exports go into a folder of its own, as do settings and recovered work.
    (cd "$folder/work" && exec env -u WAYLAND_DISPLAY HOME="$folder/home" XDG_CONFIG_HOME="$folder/home/config" \
        XDG_DATA_HOME="$folder/home/data" XDG_STATE_HOME="$folder/home/state" XDG_CACHE_HOME="$folder/home/cache" \
        NEPHOSCOPE_ADAPTER=cpu "$program") >"$folder/out.log" 2>&1 &
    editor=$!
    ended_on_exit=("$editor" "$server")
    local waited=0
    until xdotool search --onlyvisible --name Nephoscope >/dev/null 2>&1; do
        kill -0 "$editor" 2>/dev/null || fail "the editor ended: $(tail -n 20 "$folder/out.log")"
        ((waited++ < 300)) || fail "no window: $(tail -n 20 "$folder/out.log")"
        sleep 0.2
    done
    window=$(xdotool search --onlyvisible --name Nephoscope | head -n 1)
    xdotool windowmove "$window" 0 0 windowsize "$window" 1280 800 windowfocus "$window"
    sleep 8
}
title() { xdotool getwindowname "$window"; }
titled() {
    local waited=0
    until [[ $(title) == "$1"* ]]; do
        ((waited++ < 100)) || fail "the window is called $(title) instead of $1"
        sleep 0.2
    done
}
shot() {
    sleep "${2:-1}"
    kill -0 "$editor" 2>/dev/null || fail "the editor ended before $1: $(tail -n 20 "$folder/out.log")"
    "$shown" "$folder/screen/Xvfb_screen0" "$pictures/$1.png"
    say "$1"
}
click() {
    xdotool mousemove "$1" "$2"
    sleep 0.4
    xdotool click 1
    sleep 0.6
}
keys() {
    xdotool key --delay 120 "$@"
    sleep 0.6
}
appears() {
    local waited=0
    until [[ -s $1 ]]; do
        ((waited++ < 600)) || fail "$1 was not written"
        sleep 0.5
    done
}

start
shot 01_start
click 396 78 # Got it
click 90 490 # Towering cumulus
titled "Towering cumulus"
shot 02_a_sky_from_the_list 12

keys F7
sleep 6
xdotool mousemove 560 330 keydown l
sleep 0.3
xdotool mousedown 1
for x in 540 510 480 450 420; do
    xdotool mousemove "$x" $((330 + (560 - x)))
    sleep 0.2
done
xdotool mouseup 1 keyup l
titled "Towering cumulus*"
shot 03_the_sun_moved 12

click 425 728 # the snapshot
click 263 732 # Wipe
shot 04_compared_with_the_snapshot 3
keys F8
shot 05_steps 1
keys ctrl+z
titled "Towering cumulus –"
keys ctrl+shift+z F8
titled "Towering cumulus*"

keys ctrl+s
keys Tab
xdotool key ctrl+a
xdotool type --delay 20 "$folder/work/evening.ron"
shot 06_save 1
keys Return
appears "$folder/work/evening.ron"
titled "Towering cumulus –"

keys ctrl+e
click 585 294 # EXR, layers of light
click 594 354 # Panorama
click 591 378 # 2K
click 600 445 # Draft
shot 07_export 1
click 437 538 # Export
shot 08_rendering 3
appears "$folder/work/towering-cumulus.exr"

keys h ctrl+t
sleep 5
click 471 578 # Time-lapse
shot 09_time_lapse 1
click 510 629 # Dawn to dusk in 20 s
titled "Towering cumulus*"
shot 10_playing 6
keys space
# The copy of unsaved work is at most half a minute old.
sleep 35
kill -9 "$editor"
wait "$editor" 2>/dev/null || true
start
shot 11_recovered 1
click 441 427 # Recover
titled "Towering cumulus*"
keys ctrl+q
shot 12_quit 1
click 508 427 # Discard
waited=0
while kill -0 "$editor" 2>/dev/null; do
    ((waited++ < 50)) || fail "the editor does not close"
    sleep 0.2
done
say "a sky was picked, changed, compared, saved, exported, filmed, lost and found again"
