#!/usr/bin/env bash
# Renders every built-in sky at 480x270 with the program as a user calls it, and makes docs/gallery.png of them, in the
# order of `nephoscope presets list`, row by row, and the small pictures that the editor shows of them. Argument: a folder in which to keep the single pictures.
set -euo pipefail
folder=${1:+$(realpath -m "$1")}
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" run

cargo build --locked --bin nephoscope --example contact_sheet
if [[ -z $folder ]]; then
    temporary_folder
    folder=$made_folder
fi
mkdir -p "$folder"

pictures=()
while read -r name; do
    "$program" render "$name" -o "$folder/$name.png" --size 480x270
    pictures+=("$folder/$name.png")
    "$program" render "$name" -o "thumbnails/$name.png" --size 224x126 --quality preview
done < <("$program" presets list | sed 's/ .*//')

# sheet FILE COLUMNS PICTURES...: PNG keeps every grain, so the sheet is as large as 1 MB allows.
sheet() {
    local file=$1 columns=$2 width
    shift 2
    for width in 480 420 360 320 300 280 260 240 220 200; do
        "${CARGO_TARGET_DIR:-target}/debug/examples/contact_sheet" "$columns" "$width" "$folder/sheet.png" "$@"
        if (($(wc -c <"$folder/sheet.png") <= 1000000)); then
            mv "$folder/sheet.png" "$file"
            return
        fi
    done
    fail "no size of $file stays below 1 MB"
}
sheet docs/gallery.png 5 "${pictures[@]}"
# The genera in the order of docs/genera.md, and Thomann's scenes.
genera=()
while read -r name; do
    genera+=("$folder/$name.png")
done < <(sed -n 's/^| [A-Z][a-z ]* | `\([a-z_]*\)` .*/\1/p' docs/genera.md)
sheet docs/genera.png 4 "${genera[@]}"
sheet docs/box.png 4 "$folder"/box_*.png
