#!/usr/bin/env bash
# Opens the editor in a virtual display, waits for its window, lets it work for some seconds, and checks that it is
# still there and shows a picture. Argument: where to keep the screenshot (a .png); by default it is thrown away.
set -euo pipefail
picture=${1:+$(realpath -m "$1")}
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" test

for tool in Xvfb xdotool; do
    command -v "$tool" >/dev/null && continue
    [[ -z ${CI:-} ]] || fail "$tool is missing"
    say "$tool is missing, so no window was tried"
    exit 0
done

cargo build --locked --quiet --bin nephoscope --example framebuffer

temporary_folder
folder=$made_folder
mkdir "$folder/screen" "$folder/home"

# The server picks a free display itself and says which.
Xvfb -displayfd 3 -screen 0 1280x720x24 -nolisten tcp -fbdir "$folder/screen" 3>"$folder/display" 2>"$folder/xvfb.log" &
ended_on_exit+=($!)
for _ in {1..100}; do
    [[ -s $folder/display ]] && break
    sleep 0.1
done
[[ -s $folder/display ]] || fail "Xvfb did not start: $(cat "$folder/xvfb.log")"
DISPLAY=:$(cat "$folder/display")
export DISPLAY

# A home of its own, so that neither settings nor a recovered document of the user's get in.
env -u WAYLAND_DISPLAY HOME="$folder/home" XDG_CONFIG_HOME="$folder/home/config" XDG_DATA_HOME="$folder/home/data" \
    XDG_STATE_HOME="$folder/home/state" XDG_CACHE_HOME="$folder/home/cache" NEPHOSCOPE_ADAPTER=cpu \
    "$program" >"$folder/out.log" 2>&1 &
editor=$!
# It has to go before the display does.
ended_on_exit=("$editor" "${ended_on_exit[@]}")

is_alive() { kill -0 "$editor" 2>/dev/null; }
start=$SECONDS
until xdotool search --onlyvisible --name Nephoscope >/dev/null 2>&1; do
    is_alive || fail "the editor ended before it showed a window: $(tail -n 20 "$folder/out.log")"
    ((SECONDS - start < 60)) || fail "no window after 60 s: $(tail -n 20 "$folder/out.log")"
    sleep 0.2
done
say "the window was there after $((SECONDS - start)) s"

shown=${CARGO_TARGET_DIR:-target}/debug/examples/framebuffer
wait_for_picture() {
    local when=$1 start=$SECONDS
    until "$shown" "$folder/screen/Xvfb_screen0" "$folder/window.png" 2>"$folder/shown.log"; do
        is_alive || fail "the editor ended $when: $(tail -n 20 "$folder/out.log")"
        ((SECONDS - start < 60)) || fail "the window shows no picture $when: $(cat "$folder/shown.log")"
        sleep 1
    done
}
wait_for_picture "at its start"

# A resize is what breaks surfaces; then it works on for a while.
window=$(xdotool search --onlyvisible --name Nephoscope | head -n 1)
xdotool windowsize "$window" 900 640
sleep 4
# So narrow it shows no gallery: what has many colours now is the sky.
wait_for_picture "after a resize"
! grep -q "panicked" "$folder/out.log" || fail "a thread panicked: $(cat "$folder/out.log")"
if [[ -n $picture ]]; then cp "$folder/window.png" "$picture"; fi
say "the window works"
