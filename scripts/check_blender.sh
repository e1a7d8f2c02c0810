#!/usr/bin/env bash
# Loads a panorama into Blender as its users would, renders a white sphere in its light, and looks where it is brightest:
# that is where the sun must stand. Blender comes as the Python package bpy, some 400 MB, so this is no part of the tests.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" test

cargo build --locked --quiet --bin nephoscope
temporary_folder
folder=$made_folder
python=${NEPHOSCOPE_BPY_PYTHON:-}
if [[ -z $python ]]; then
    python3 -m venv "$folder/venv" || fail "python3-venv is missing"
    say "fetching Blender (bpy) into $folder"
    "$folder/venv/bin/pip" install --quiet bpy || fail "bpy cannot be had for this Python; set NEPHOSCOPE_BPY_PYTHON"
    python=$folder/venv/bin/python
fi

for place in "25 60" "40 200" "10 310"; do
    read -r elevation azimuth <<<"$place"
    sky=$folder/sky-$azimuth.exr
    target/debug/nephoscope pano clear_puffs -o "$sky" --size 1024x512 --quality draft --adapter cpu \
        --set sun.placement=Direction --set sun.elevation_deg="$elevation" --set sun.azimuth_deg="$azimuth" \
        --set weather.coverage=0 --set sunshafts.strength=0 --set camera.heading_deg=0 >&2
    "$python" scripts/check_blender.py "$sky" "$elevation" "$azimuth" "$folder/sphere.exr"
done
say "Blender sees the sun where it stands"
