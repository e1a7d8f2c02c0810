#!/usr/bin/env bash
# Renders every built-in sky at 960x540 with the program as a user calls it, and makes docs/gallery.png of them, in the
# order of `nephoscope presets list`, row by row. Argument: a folder in which to keep the single pictures.
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
    "$program" render "$name" -o "$folder/$name.png" --size 960x540
    pictures+=("$folder/$name.png")
done < <("$program" presets list | sed 's/ .*//')

# PNG keeps every grain, so the size of the single pictures is what keeps the sheet below 1 MB.
"${CARGO_TARGET_DIR:-target}/debug/examples/contact_sheet" 3 320 docs/gallery.png "${pictures[@]}"
bytes=$(wc -c <docs/gallery.png)
((bytes <= 1000000)) || fail "docs/gallery.png has $bytes bytes, more than 1 MB"
