# Sourced by the other scripts: goes to the root of the project, installs what is missing from Debian's packages where
# that is possible, and gives the session a private runtime folder.
#
#   . scripts/setup.sh run     what the window and the software driver need
#   . scripts/setup.sh test    that, and the tools that check windows and files
#
# NEPHOSCOPE_NO_INSTALL=1 never installs anything.

cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 1

say() { printf '== %s\n' "$*" >&2; }
fail() {
    printf 'error: %s\n' "$*" >&2
    exit 1
}

# Processes and paths to end and remove on exit; scripts append to them.
ended_on_exit=()
removed_on_exit=()
clean_up() {
    local pid
    set +e
    # The bash of macOS takes an empty list for an unset one.
    ((${#ended_on_exit[@]} == 0)) || for pid in "${ended_on_exit[@]}"; do
        kill "$pid" 2>/dev/null && wait "$pid" 2>/dev/null
    done
    ((${#removed_on_exit[@]} == 0)) || rm -rf -- "${removed_on_exit[@]}"
}
trap clean_up EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

temporary_folder() {
    made_folder=$(mktemp -d "${TMPDIR:-/tmp}/nephoscope.XXXXXX") || fail "no temporary folder can be made"
    removed_on_exit+=("$made_folder")
}

run_packages=(mesa-vulkan-drivers libvulkan1 libxkbcommon-x11-0 libxcursor1 libxi6 libxrandr2)
test_packages=(xvfb xdotool openexr openimageio-tools python3-openvdb python3-numpy)

is_installed() { [[ $(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null) == installed ]]; }

install_missing() {
    local package missing=() root=
    command -v dpkg-query >/dev/null && command -v apt-get >/dev/null || return 0
    for package in "$@"; do is_installed "$package" || missing+=("$package"); done
    ((${#missing[@]})) || return 0
    if [[ -n ${NEPHOSCOPE_NO_INSTALL:-} ]]; then
        say "not installed, as NEPHOSCOPE_NO_INSTALL is set: ${missing[*]}"
        return 0
    fi
    if ((EUID != 0)); then
        if ! command -v sudo >/dev/null || ! sudo -n true 2>/dev/null && [[ ! -t 0 ]]; then
            say "these packages are missing and cannot be installed without root: ${missing[*]}"
            say "ask an administrator for: apt-get install ${missing[*]}"
            return 0
        fi
        root=sudo
    fi
    say "installing ${missing[*]}"
    $root apt-get update -qq >&2 || say "the package lists could not be refreshed; trying with the old ones"
    $root env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends \
        "${missing[@]}" >&2 </dev/null || say "not everything could be installed: ${missing[*]}"
}

case ${1:-run} in
    run) install_missing "${run_packages[@]}" ;;
    test) install_missing "${run_packages[@]}" "${test_packages[@]}" ;;
    *) fail "setup.sh takes run or test" ;;
esac

command -v cc >/dev/null || install_missing gcc libc6-dev
command -v cargo >/dev/null || [[ ! -f ${HOME:-}/.cargo/env ]] || . "$HOME/.cargo/env"
command -v cargo >/dev/null || fail "cargo is missing: install Rust $(sed -n 's/^rust-version = "\(.*\)"/\1/p' Cargo.toml) or later"

if [[ -z ${XDG_RUNTIME_DIR:-} || ! -d ${XDG_RUNTIME_DIR:-} ]]; then
    temporary_folder
    export XDG_RUNTIME_DIR=$made_folder
fi

# Everything is built in one profile, so that running, testing and checking share their work.
program=${CARGO_TARGET_DIR:-target}/debug/nephoscope
