#!/usr/bin/env python3
"""Lists the tests that were skipped, with their reasons, and counts them.

    tools/skipped_tests.py LastTest.log

Reads ctest's log: GoogleTest programs pass with single cases skipped, which ctest does not show.
"""

import pathlib
import re
import sys

CASE = re.compile(r"^\[  SKIPPED \] (\S+) \(\d+ ms\)$")  # closes the case; the reason stands above
START = re.compile(r"^\[ RUN      \] ")
PLACE = re.compile(r"^\S+:\d+: Skipped$")
SCRIPT = re.compile(r"(.*?)(?: \(\S+\))? \.\.\. skipped ['\"](.*)['\"]$")  # unittest -v


def skipped(log):
    """(name, reason) of each skipped case of ctest's log."""
    test, case_lines = "", []
    for line in log.splitlines():
        if match := re.match(r"^\d+/\d+ Test: (\S+)$", line):
            test, case_lines = match.group(1), []
        elif START.match(line):
            case_lines = []
        elif match := CASE.match(line):
            reason = " ".join(text.strip() for text in case_lines if text and not PLACE.match(text))
            yield match.group(1), reason
            case_lines = []
        elif match := SCRIPT.match(line):
            yield f"{test}.{match.group(1)}", match.group(2)
        else:
            case_lines.append(line)


def main():
    log = pathlib.Path(sys.argv[1])
    cases = list(skipped(log.read_text(encoding="utf-8", errors="replace"))) if log.exists() else []
    print(f"\nskipped: {len(cases)}")
    for name, reason in cases:
        print(f"    {name}: {reason or 'no reason given'}")
    print()


if __name__ == "__main__":
    main()
