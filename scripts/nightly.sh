#!/usr/bin/env bash
# What takes too long for every change: all that the tests can draw, all checks of `verify`, and the accuracy of all
# built-in skies. Hours on two cores.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" run

NEPHOSCOPE_THOROUGH=1 cargo test --locked --test gpu
cargo build --locked --bin nephoscope
"$program" verify --full
"$program" verify --skies 2000 --kinds 50
scripts/swiftshader.sh 200
scripts/fuzz.sh all 100000
"$program" accuracy all --size 96x54 --rounds 5 --tolerance 0.01 --md
# Cameras and suns that nobody tuned.
"$program" accuracy fair_weather --views 20 --size 96x54 --rounds 1 --tolerance 0.01 --seeds 4 --md
