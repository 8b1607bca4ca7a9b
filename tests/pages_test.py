#!/usr/bin/env python3
"""The pages of the techniques say what the program says. GNOMON_CLI is the path of the program."""

import os
import pathlib
import re
import sys
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / "tools"))
import technique_pages  # noqa: E402

TECHNIQUES = technique_pages.techniques(os.environ["GNOMON_CLI"])
KINDS = ["directional", "point", "spot", "sphere", "disc", "rect"]


def page(technique):
    return (ROOT / "techniques" / technique["name"] / "README.md").read_text(encoding="utf-8")


def fact(technique, name):
    """The cell beside `name` in the page's first table."""
    found = re.search(rf"^\| {name} \| (.*) \|$", page(technique), re.MULTILINE)
    return found.group(1) if found else ""


class Pages(unittest.TestCase):
    def test_tables_of_parameters_are_up_to_date(self):
        for technique in TECHNIQUES:
            with self.subTest(technique=technique["name"]):
                text = page(technique)
                self.assertEqual(text, technique_pages.filled(text, technique),
                                 "run tools/technique_pages.py")

    def test_pages_name_the_lights(self):
        for technique in TECHNIQUES:
            with self.subTest(technique=technique["name"]):
                told = re.findall(r"\b(?:" + "|".join(KINDS) + r")\b", fact(technique, "lights"))
                self.assertEqual(told, technique["lights"])

    def test_pages_name_penumbra_and_alpha_masks(self):
        for technique in TECHNIQUES:
            with self.subTest(technique=technique["name"]):
                self.assertEqual(fact(technique, "penumbra"), technique["penumbra"])
                self.assertEqual(fact(technique, "alpha masks"),
                                 "honoured" if technique["honors_alpha"] else "solid")

    def test_pages_cite_every_source(self):
        for technique in TECHNIQUES:
            with self.subTest(technique=technique["name"]):
                cited = re.findall(r"^- `(\w+)`: ", page(technique), re.MULTILINE)
                self.assertEqual(cited[:len(technique["source"].split(", "))],
                                 technique["source"].split(", "))


class Generator(unittest.TestCase):
    TECHNIQUE = {"name": "sundial", "parameters": [
        {"name": "hours", "type": "number", "default": 0.5, "min": 0.0, "max": 24.0, "unit": "h",
         "meaning": "how long"},
        {"name": "steps", "type": "integer", "default": 4, "min": 1.0, "max": 65536.0, "unit": "1",
         "meaning": "how many"},
        {"name": "noon", "type": "boolean", "default": True, "meaning": "at all"},
        {"name": "kind", "type": "choice", "default": "flat", "choices": ["flat", "round"],
         "meaning": "which"}]}

    def test_every_type_has_its_row(self):
        rows = technique_pages.table(self.TECHNIQUE).splitlines()[2:]
        self.assertEqual(rows, ["| `hours` | 0.5 | 0 to 24 h | how long |",
                                "| `steps` | 4 | 1 to 65536 | how many |",
                                "| `noon` | true | true, false | at all |",
                                "| `kind` | flat | flat, round | which |"])

    def test_only_what_is_between_the_markers_changes(self):
        begin, end = technique_pages.BEGIN, technique_pages.END
        new = technique_pages.filled(f"before {begin} old {end} after", self.TECHNIQUE)
        self.assertTrue(new.startswith(f"before {begin}\n| parameter"))
        self.assertTrue(new.endswith(f"| which |\n{end} after"))
        self.assertEqual(technique_pages.filled(new, self.TECHNIQUE), new)

    def test_a_page_without_markers_is_refused(self):
        with self.assertRaisesRegex(ValueError, "sundial"):
            technique_pages.filled("no table", self.TECHNIQUE)


if __name__ == "__main__":
    unittest.main()
