#!/usr/bin/env bash
# Runs checks of `verify` on SwiftShader, a second software driver, which is unpacked from a package of Debian's and chosen
# for these commands alone. Where the package cannot be had nothing is checked, and said so.
# Argument: how many skies that nobody made are compared with llvmpipe's.
set -euo pipefail
skies=${1:-32}
. "$(dirname "${BASH_SOURCE[0]}")/setup.sh" test

cargo build --locked --quiet --bin nephoscope
temporary_folder
folder=$made_folder
fetch() { (cd "$folder" && apt-get download -qq chromium-common >/dev/null 2>&1); }
unpack() { dpkg-deb --fsys-tarfile "$folder"/chromium-common_*.deb | tar -x -C "$folder" --wildcards '*swiftshader*'; }
# The package lists of a fresh machine may be empty.
if ! { fetch || { ((EUID == 0)) && apt-get update -qq >&2 && fetch; }; } || ! unpack; then
    say "NOT CHECKED on SwiftShader: Debian's package chromium-common could not be had"
    exit 0
fi
driver=$(find "$folder" -name 'vk_swiftshader_icd.json')
version=$(dpkg-deb --field "$folder"/chromium-common_*.deb Version)
say "SwiftShader of chromium-common $version"

export NEPHOSCOPE_ADAPTER=cpu
"$program" verify --skies "$skies" --kinds 4 --save "$folder/skies.bin" --adapter llvmpipe
VK_DRIVER_FILES=$driver "$program" verify --hard
VK_DRIVER_FILES=$driver "$program" verify --skies "$skies" --kinds 4 --against "$folder/skies.bin"
