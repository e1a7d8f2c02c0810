#!/usr/bin/env bash
# Builds the program and runs it: without arguments the editor, with arguments what they ask for.
# Example: scripts/run.sh render stormy -o stormy.exr
set -euo pipefail
here=$PWD
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" run

cargo build --locked --bin nephoscope
program=$(realpath "$program")
# Paths in arguments are relative to where the script was called from.
cd "$here"
"$program" "$@"
