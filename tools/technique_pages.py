#!/usr/bin/env python3
"""Writes the tables of parameters in techniques/<name>/README.md, between the lines <!-- parameters --> and
<!-- /parameters -->, from what the program says of itself (`gnomon info --json`).

    tools/technique_pages.py [GNOMON]     the built program; else $GNOMON_CLI, else build/release/apps/cli/gnomon
"""

import json
import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
BEGIN, END = "<!-- parameters -->", "<!-- /parameters -->"


def techniques(cli):
    """What the program `cli` says of its techniques."""
    done = subprocess.run([str(cli), "info", "--json"], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise ValueError(f"{cli} info --json failed: {done.stderr.strip()}")
    return json.loads(done.stdout)["techniques"]


def word(value):
    """A value as one types it."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return f"{value:.15g}" if isinstance(value, float) else str(value)


def allowed(parameter):
    if parameter["type"] == "boolean":
        return "true, false"
    if parameter["type"] == "choice":
        return ", ".join(parameter["choices"])
    unit = parameter["unit"] if parameter["unit"] != "1" else ""
    return f"{word(parameter['min'])} to {word(parameter['max'])} {unit}".rstrip()


def table(technique):
    """The Markdown between the markers."""
    if not technique["parameters"]:
        return "None."
    rows = ["| parameter | default | allowed | meaning |", "|---|---|---|---|"]
    for parameter in technique["parameters"]:
        rows.append(f"| `{parameter['name']}` | {word(parameter['default'])} | {allowed(parameter)} "
                    f"| {parameter['meaning']} |")
    return "\n".join(rows)


def filled(page, technique):
    """The page with its technique's table. Raises ValueError unless it has one pair of markers."""
    parts = re.split(f"{re.escape(BEGIN)}.*?{re.escape(END)}", page, flags=re.DOTALL)
    if len(parts) != 2:
        raise ValueError(f"the page of {technique['name']} has {len(parts) - 1} tables of parameters; "
                         f"one is wanted, between {BEGIN} and {END}")
    return f"{parts[0]}{BEGIN}\n{table(technique)}\n{END}{parts[1]}"


def main():
    default = os.environ.get("GNOMON_CLI") or ROOT / "build/release/apps/cli/gnomon"
    try:
        for technique in techniques(sys.argv[1] if len(sys.argv) > 1 else default):
            path = ROOT / "techniques" / technique["name"] / "README.md"
            page = path.read_text(encoding="utf-8")
            new = filled(page, technique)
            if new != page:
                path.write_text(new, encoding="utf-8")
                print(f"wrote {path.relative_to(ROOT)}")
    except (OSError, ValueError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
