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

# PNG keeps every grain, so the sheet is as large as 1 MB allows.
for width in 480 420 360 320 280; do
    "${CARGO_TARGET_DIR:-target}/debug/examples/contact_sheet" 3 "$width" "$folder/sheet.png" "${pictures[@]}"
    if (($(wc -c <"$folder/sheet.png") <= 1000000)); then
        mv "$folder/sheet.png" docs/gallery.png
        exit
    fi
done
fail "no size of the sheet stays below 1 MB"
