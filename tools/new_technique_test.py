#!/usr/bin/env python3
"""new_technique.py, run on a copy of the repository: what it makes is laid out, layered and named as the
rest, configures and compiles."""

import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

import check_includes
import new_technique

ROOT = pathlib.Path(__file__).resolve().parent.parent
COPIED = ("CMakeLists.txt", ".clang-format", "cmake", "include", "src", "techniques", "apps", "tests", "tools")


class NewTechnique(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name) / "gnomon"
        self.root.mkdir()
        for name in COPIED:
            source = ROOT / name
            (shutil.copytree if source.is_dir() else shutil.copy)(source, self.root / name)

    def run_in_root(self, *command):
        done = subprocess.run(command, cwd=self.root, text=True, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, check=False)
        self.assertEqual(done.returncode, 0, f"{' '.join(command)}\n{done.stdout}")

    def test_result_configures_and_compiles(self):
        self.run_in_root("python3", "-B", "tools/new_technique.py", "penumbra_wedges")
        self.run_in_root("cmake", "-G", "Ninja", "-S", ".", "-B", "build",
                         "-DGNOMON_BENCH=OFF", "-DGNOMON_WEB=OFF", "-DGNOMON_WERROR=ON")
        objects = "techniques/penumbra_wedges/CMakeFiles"
        self.run_in_root("ninja", "-C", "build",
                         f"{objects}/gnomon_penumbra_wedges.dir/penumbra_wedges.cpp.o",
                         f"{objects}/penumbra_wedges_test.dir/penumbra_wedges_test.cpp.o")
        self.assertIn("penumbra_wedges_info()", (self.root / "build/registry.cpp").read_text())

    def test_result_keeps_the_rules(self):
        folder = new_technique.make(self.root, "penumbra_wedges")
        faults = [fault for fault in check_includes.check(self.root) if folder.name in fault]
        self.assertEqual(faults, [])
        lines = (self.root / "techniques/CMakeLists.txt").read_text().splitlines()
        names = [m.group(1) for line in lines if (m := re.match(r"gnomon_technique\((\w+)\)", line))]
        self.assertIn("penumbra_wedges", names)
        self.assertEqual(names, sorted(names))
        for file in folder.iterdir():
            self.assertNotIn("@", file.read_text(), file)
        if shutil.which("clang-format"):
            self.run_in_root("clang-format", "--dry-run", "-Werror",
                             *(str(file) for file in folder.glob("*.cpp")))

    def test_bad_names_make_nothing(self):
        before = (self.root / "techniques/CMakeLists.txt").read_text()
        for name in ("Wedges", "2wedges", "wed ges", "../wedges", "wedges_", "shadow_map", "scene"):
            with self.assertRaises(ValueError, msg=name):
                new_technique.make(self.root, name)
        self.assertEqual((self.root / "techniques/CMakeLists.txt").read_text(), before)


if __name__ == "__main__":
    unittest.main()
