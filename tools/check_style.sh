#!/bin/bash
# tools/check_style.sh [BUILD]
#
# Checks the layout of the sources (clang-format), what they include (tools/check_includes.py) and, with
# the folder of a finished build, clang-tidy's findings in all sources but tests. What clang-tidy found
# clean is remembered in .cache/clang-tidy until the file, a header or .clang-tidy changes.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
build="${1:-}"
folders=(include src techniques apps examples bench tests)

echo "clang-format"
find "${folders[@]}" -name '*.cpp' -o -name '*.h' | sort | xargs clang-format --dry-run -Werror

echo "includes"
python3 -B tools/check_includes.py

[ -n "$build" ] || exit 0
echo "clang-tidy"
mkdir -p .cache/clang-tidy
headers="$(find include src techniques apps -name '*.h' | sort | cat - <(echo .clang-tidy) |
           xargs cat | sha256sum)"
tidy() {
    local build="$1" headers="$2" file="$3" key found
    key="$(echo "$headers" "$file" | cat - "$file" | sha256sum | cut -c1-40)"
    [ ! -e ".cache/clang-tidy/$key" ] || return 0
    if ! found="$(clang-tidy --quiet --extra-arg=-Wno-unknown-warning-option -p "$build" "$file" 2>&1)"; then
        echo "$found"
        return 1
    fi
    touch ".cache/clang-tidy/$key"
}
export -f tidy
find src techniques apps -name '*.cpp' ! -name '*_test.cpp' | sort |
    xargs -n 1 -P "$(nproc)" bash -c 'tidy "$@"' tidy "$build" "$headers"
