#!/usr/bin/env bash
# Measures the default quality of every built-in sky against the converged truth and writes docs/measurements/accuracy.md.
# Further arguments go to `nephoscope accuracy`.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" run

cargo build --locked --bin nephoscope
temporary_folder
{
    printf '# The default quality against the converged truth\n\n'
    "$program" accuracy all --size 128x72 --rounds 5 --tolerance 0.01 --md "$@"
} >"$made_folder/accuracy.md"
mkdir -p docs/measurements
mv "$made_folder/accuracy.md" docs/measurements/accuracy.md
