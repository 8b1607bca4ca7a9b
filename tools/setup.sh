#!/bin/bash
# tools/setup.sh GROUP...
#
# Installs what the groups of tools/packages.txt name and this machine lacks, with apt-get: as root,
# or by sudo where that asks for no password. Otherwise prints the line to run and exits with 1.
set -euo pipefail
list="$(dirname "${BASH_SOURCE[0]}")/packages.txt"

if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    echo "setup: this system has no apt-get, so nothing was installed; vcpkg.json names the same" \
         "libraries for vcpkg. Build with: cmake --preset release && cmake --build --preset release" >&2
    exit 1
fi

wanted=()
for group in "$@"; do
    mapfile -t names < <(awk -v group="[$group]" \
        '/^\[/ { inside = ($0 == group); next } inside && NF && !/^#/ { print $1 }' "$list")
    if [ ${#names[@]} -eq 0 ]; then
        echo "setup: $list has no group [$group]" >&2
        exit 1
    fi
    wanted+=("${names[@]}")
done

# dpkg-query exits with 1 when it does not know one of them: that one is missing.
present="$(dpkg-query -W -f '${binary:Package} ${db:Status-Status}\n' "${wanted[@]}" 2>/dev/null |
           sed -n 's/\(:[a-z0-9]*\)\? installed$//p' || true)"
missing=()
for name in "${wanted[@]}"; do
    grep -qxF -- "$name" <<<"$present" || missing+=("$name")
done
if [ ${#missing[@]} -eq 0 ]; then
    echo "setup: all ${#wanted[@]} packages are installed"
    exit 0
fi

install="apt-get install -y --no-install-recommends ${missing[*]}"
if [ "$(id -u)" -eq 0 ]; then
    as_root=()
elif sudo -n true 2>/dev/null; then
    as_root=(sudo -n)
else
    echo "setup: ${#missing[@]} packages are missing. Run this, then try again:" >&2
    echo "    sudo apt-get update && sudo $install" >&2
    exit 1
fi
echo "setup: installing ${missing[*]}"
"${as_root[@]}" apt-get update -q
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive $install
