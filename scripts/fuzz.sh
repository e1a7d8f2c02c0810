#!/usr/bin/env bash
# Feeds broken input to everything that reads files and texts (examples/fuzz.rs), with at most 1 GB of memory.
# Arguments: a target or `all`, and how many executions of each; a million by default.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" run

cargo build --locked --quiet --example fuzz
ulimit -v 1000000
"${CARGO_TARGET_DIR:-target}/debug/examples/fuzz" "${1:-all}" "${2:-1000000}"
