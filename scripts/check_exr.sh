#!/usr/bin/env bash
# Checks EXR files with the tools of OpenEXR and OpenImageIO: valid by the letter, channels RGBA, no NaN, no infinity,
# the attributes that make the picture again. Arguments: the files; without any, some are exported first.
set -euo pipefail
files=()
for file in "$@"; do files+=("$(realpath "$file")"); done
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" test

for tool in exrinfo oiiotool; do
    command -v "$tool" >/dev/null && continue
    [[ -z ${CI:-} ]] || fail "$tool is missing"
    say "$tool is missing, so no file was checked"
    exit 0
done

temporary_folder
folder=$made_folder

check() {
    local file=$1 info=$folder/info attribute
    exrinfo -s "$file" >/dev/null || fail "$file: exrinfo finds it invalid"
    oiiotool --info -v --stats "$file" >"$info" || fail "$file: oiiotool cannot read it"
    grep -q 'channel list: R, G, B, A' "$info" || fail "$file: its channels are not R, G, B, A"
    grep -q 'Stats NanCount: 0 0 0 0 ' "$info" || fail "$file: holds NaN"
    grep -q 'Stats InfCount: 0 0 0 0 ' "$info" || fail "$file: holds infinity"
    for attribute in compression software worldToCamera colorInteropID nephoscope:preset nephoscope:presetVersion \
        nephoscope:quality nephoscope:candelaPerSquareMetrePerUnit nephoscope:timeSecs; do
        # A panorama has no camera matrix.
        [[ $attribute == worldToCamera && $file == *equirect* ]] && continue
        grep -q "^ *$attribute:" "$info" || fail "$file: lacks the attribute $attribute"
    done
}

# Name, then arguments for `render`, then what must be in the report of oiiotool.
export_and_check() {
    local file=$folder/$1.exr words=$2
    shift 2
    "$program" render "$@" -o "$file" --size 96x54 --quality draft --adapter cpu >&2
    check "$file"
    grep -q -- "$words" "$folder/info" || fail "$1: oiiotool does not report \"$words\""
    # The sky inside opens again.
    "$program" presets validate "$file" >&2 || fail "$1: the preset inside does not open"
}

if ((${#files[@]})); then
    for file in "${files[@]}"; do
        check "$file"
        say "$file is sound"
    done
    exit
fi

cargo build --locked --quiet --bin nephoscope
export_and_check perspective ', half openexr' fair_weather
export_and_check clouds ', half openexr' broken_sunset --clouds-only
export_and_check equirect ', half openexr' moonlit --projection equirect
export_and_check float ', float openexr' stratocumulus --depth float --compression piz
export_and_check lossy ', half openexr' clear_puffs --compression dwaa
export_and_check region ', half openexr' fair_weather --region 40x20+30+10
"$program" pano fair_weather -o "$folder/cube.exr" --projection cube --size 16x16 --quality draft --adapter cpu >&2
for face in px nx py ny pz nz; do check "$folder/cube.$face.exr"; done
# Layers have more channels than four.
"$program" render fair_weather -o "$folder/layers.exr" --layers --size 96x54 --quality draft --adapter cpu >&2
exrinfo -s "$folder/layers.exr" >/dev/null || fail "layers: exrinfo finds it invalid"
oiiotool --info -v --stats "$folder/layers.exr" >"$folder/info" || fail "layers: oiiotool cannot read it"
for channel in direct.R distance.X motion.u motion.v transmittance.A; do
    grep -q "$channel" "$folder/info" || fail "layers: lacks the channel $channel"
done
"$program" export fair_weather --what weather-map -o "$folder/map.exr" --adapter cpu >&2
exrinfo -s "$folder/map.exr" >/dev/null || fail "map: exrinfo finds it invalid"
"$program" pano fair_weather -o "$folder/sky.hdr" --size 64x32 --quality draft --adapter cpu >&2
oiiotool --info -v --stats "$folder/sky.hdr" | grep -q 'Stats NanCount: 0 0 0' || fail "sky.hdr: oiiotool finds it broken"
"$program" render fair_weather -o "$folder/deep.png" --depth 16 --size 64x36 --quality draft --adapter cpu >&2
oiiotool --info "$folder/deep.png" | grep -q 'uint16' || fail "deep.png: oiiotool finds no 16 bits"
say "16 exported files are sound"
