#!/usr/bin/env bash
# Measures the default quality of built-in skies against the converged truth and writes docs/measurements/accuracy.md.
# Arguments: names of skies; by default four by day, which take half a minute. `all` takes a quarter of an hour and more on
# two cores: a low sun has a long way through the clouds.
set -euo pipefail
skies=("${@:-fair_weather,clear_puffs,towering,stratocumulus}")
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" run

cargo build --locked --bin nephoscope
temporary_folder
{
    printf '# The default quality against the converged truth\n\n'
    "$program" accuracy "${skies[@]}" --size 96x54 --rounds 5 --tolerance 0.01 --md
} >"$made_folder/accuracy.md"
mkdir -p docs/measurements
mv "$made_folder/accuracy.md" docs/measurements/accuracy.md
