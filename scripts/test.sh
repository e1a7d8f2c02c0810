#!/usr/bin/env bash
# Runs every check: formatting, lints, documentation, all tests, the window under Xvfb, exported files, a
# second driver.
# Ends with one line, "N passed, N failed, N skipped", and a status other than 0 if anything failed.
#
# Arguments go to the tests (scripts/test.sh plan::) and leave the other checks out.
set -euo pipefail
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" test

failed=()
check() {
    local what=$1 start=$SECONDS
    shift
    say "$what"
    "$@" || failed+=("$what")
    say "$what took $((SECONDS - start)) s"
}

temporary_folder
log=$made_folder/tests.log
run_tests() { cargo test --locked "$@" 2>&1 | tee "$log"; }
document() { RUSTDOCFLAGS="-D warnings" cargo doc --locked --no-deps; }

# Adds up the lines in which cargo's test runner says how many tests passed.
summary() {
    awk '/^test result:/ { for (i = 2; i <= NF; i++) { if ($i ~ /^passed/) p += $(i-1); if ($i ~ /^failed/) f += $(i-1);
         if ($i ~ /^ignored/) s += $(i-1) } } END { printf "%d passed, %d failed, %d skipped\n", p, f, s }' "$log"
}

if (($#)); then
    run_tests --no-fail-fast "$@"
    exit
fi

check "formatting" cargo fmt --check
check "lints" cargo clippy --locked --all-targets -- -D warnings
check "documentation" document
check "tests" run_tests --no-fail-fast
check "window" scripts/window_smoke.sh
check "exported files" scripts/check_exr.sh
check "second driver" scripts/swiftshader.sh

((${#failed[@]} == 0)) || for what in "${failed[@]}"; do say "FAILED: $what"; done
summary
grep -q '^test result: .*[1-9][0-9]* passed' "$log" || fail "no test ran"
((${#failed[@]} == 0))
