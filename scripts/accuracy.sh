#!/usr/bin/env bash
# Measures settings round the default quality of built-in skies against the converged truth, and writes
# docs/measurements/accuracy.md and a plot of each sky's front.
# Arguments: names of skies; all of them by default, which take some two hours on two cores: a low sun has a long way
# through the clouds, and thick clouds have fine steps.
set -euo pipefail
skies=("${@:-all}")
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" run

cargo build --locked --bin nephoscope
temporary_folder
mkdir "$made_folder/fronts"
{
    printf '# Quality against the converged truth\n\n'
    printf 'What these tables show is said in [README.md](README.md), how they are read in [accuracy.md](../accuracy.md).\n\n'
    "$program" accuracy "${skies[@]}" --size 96x54 --rounds 15 --tolerance 0.01 --md --plot "$made_folder/fronts/front.svg" \
        --axis quality.light_steps=12,18,27 --axis quality.step_m=30,45,75 --max-error 0.1
} >"$made_folder/accuracy.md"
mkdir -p docs/measurements/fronts
mv "$made_folder/accuracy.md" docs/measurements/accuracy.md
mv "$made_folder"/fronts/*.svg docs/measurements/fronts/
