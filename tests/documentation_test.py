#!/usr/bin/env python3
"""What the documents say about the repository is there."""

import pathlib
import re
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md")),
         *sorted((ROOT / "techniques").glob("*/README.md"))]


def text(path):
    return path.read_text(encoding="utf-8")


def techniques():
    return re.findall(r"^gnomon_technique\((\w+)\)", text(ROOT / "techniques/CMakeLists.txt"), re.MULTILINE)


class Documentation(unittest.TestCase):
    def test_sources_of_techniques_are_in_the_bibliography(self):
        keys = set(re.findall(r"^@\w+\{(\w+),", text(ROOT / "docs/references.bib"), re.MULTILINE))
        for name in techniques():
            with self.subTest(technique=name):
                code = text(ROOT / "techniques" / name / f"{name}.cpp")
                literals = re.search(r'\.source =\s*((?:"[^"]*"\s*)+)', code).group(1)
                sources = "".join(re.findall(r'"([^"]*)"', literals))
                self.assertTrue(sources, "names no source")
                self.assertLessEqual(set(re.split(r",\s*", sources)), keys)

    def test_readme_lists_every_technique(self):
        rows = re.findall(r"^\| \[`(\w+)`\]", text(ROOT / "README.md"), re.MULTILINE)
        self.assertEqual(rows, techniques())

    def test_flags_of_bakes_are_on_their_page(self):
        flags = set()
        for command in ("bake", "web"):
            flags |= set(re.findall(r'"(?:-o,)?(--[a-z-]+)"', text(ROOT / f"apps/cli/{command}.cpp")))
        self.assertGreater(len(flags), 7)
        page = text(ROOT / "docs/bakes.md").replace("-o DIR", "--output")
        self.assertEqual([flag for flag in sorted(flags) if flag not in page], [])

    def test_links_lead_somewhere(self):
        for page in PAGES:
            for target in re.findall(r"\]\(([^)#]+)[^)]*\)", text(page)):
                if not target.startswith(("http:", "https:")):
                    with self.subTest(page=page.name, link=target):
                        self.assertTrue((page.parent / target).exists())


if __name__ == "__main__":
    unittest.main()
