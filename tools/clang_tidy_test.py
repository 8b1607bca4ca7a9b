#!/usr/bin/env python3
"""Which sources clang_tidy.py checks together, and that none changes what another means."""

import pathlib
import tempfile
import unittest

import clang_tidy


class ClangTidy(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def source(self, name, text, flags="-O3"):
        path = pathlib.Path(self.folder.name) / name
        path.write_text(text, encoding="utf-8")
        command = f"c++ -I{self.folder.name} {flags} -o a.o -c {path}"
        return clang_tidy.Source({"file": str(path), "directory": self.folder.name, "command": command})

    def assert_units(self, texts, *expected):
        sources = [self.source(f"{i}.cpp", text) for i, text in enumerate(texts)]
        units = [[int(source.path.stem) for source in unit] for unit in clang_tidy.units_of(sources)]
        self.assertEqual(sorted(units), sorted(expected))

    def test_local_names_are_those_of_unnamed_namespaces_statics_and_usings(self):
        text = ("using far::Word;\nint shared(int a);\nnamespace {\nstruct Push {\n    int member;\n};\n"
                "constexpr int kSide_px = 3;\nvoid fill(int width,\n          int height) {\n    call();\n}\n"
                "alignas(64) int table[3];\n}  // namespace\nint also_shared() {\n}\n")
        self.assertEqual(clang_tidy.local_names(text), {"Word", "Push", "kSide_px", "fill", "table"})

    def test_what_is_local_is_numbered(self):
        source = self.source("a.cpp", "namespace {\nint side() {\n}\n}  // namespace\nint both() {\n    return side() + sides;\n}\n")
        self.assertIn("    return side7() + sides;\n", source.text_for_unit(7))
        self.assertIn("int both() {\n", source.text_for_unit(7))

    def test_what_is_a_member_too_keeps_its_name_and_its_source_apart(self):
        local = "namespace {\nint side() {\n}\n}  // namespace\nint f() {\n    return a.side;\n}\n"
        self.assert_units([local, "int g() {\n    return side;\n}\n", "int other;\n"], [0, 2], [1])

    def test_macros_and_using_namespace_stay_alone(self):
        self.assert_units(["#define A 1\n", "int a;\n", "using namespace std;\n", "int b;\n"], [0], [1, 3], [2])

    def test_flags_are_alike_but_for_folders_and_macros_of_no_concern(self):
        plain, other = self.source("a.cpp", "int a;\n"), self.source("b.cpp", "int b;\n", "-O0")
        self.assertFalse(plain.joins(other))
        macro = self.source("c.cpp", "int c = A;\n", "-DA=1 -O3")
        self.assertTrue(macro.joins(plain) and plain.joins(macro))
        self.assertFalse(macro.joins(self.source("d.cpp", "int d;\n", "-DA=2 -O3")))
        self.assertFalse(macro.joins(self.source("e.cpp", "int A;\n")))

    def test_quoted_includes_are_whole_paths(self):
        header = pathlib.Path(self.folder.name) / "side.h"
        header.write_text("", encoding="utf-8")
        source = self.source("a.cpp", '#include "side.h"\n#include <vector>\n')
        self.assertEqual(source.text_for_unit(1), f'#include "{header}"\n#include <vector>\n')


if __name__ == "__main__":
    unittest.main()
