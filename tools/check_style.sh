#!/bin/bash
# tools/check_style.sh [BUILD]
#
# Checks the layout of the sources (clang-format), what they include (tools/check_includes.py) and, with
# the folder of a finished build, clang-tidy's findings in all sources but tests (tools/clang_tidy.py).
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
python3 -B tools/clang_tidy.py "$build"
