#!/usr/bin/env python3
"""Installs the build into an empty prefix, builds examples/compare_two against it as a user would,
out of the source tree, and runs it on the built-in scene `cube`."""

import os
import pathlib
import re
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
BUILD = pathlib.Path(os.environ["GNOMON_BUILD"])


def run(*command):
    """Standard output of a command that must succeed."""
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    if done.returncode != 0:
        raise AssertionError(f"{' '.join(map(str, command))}\n{done.stdout}{done.stderr}")
    return done.stdout


def cached(name):
    """A variable of the library's build: its user needs the same compiler and flags."""
    cache = (BUILD / "CMakeCache.txt").read_text(encoding="utf-8")
    return re.search(rf"^{name}:\w+=(.*)$", cache, re.MULTILINE).group(1)


class Example(unittest.TestCase):
    def test_installed_library_serves_a_project_of_its_own(self):
        with tempfile.TemporaryDirectory() as folder:
            work = pathlib.Path(folder)
            run("cmake", "--install", BUILD, "--prefix", work / "prefix")
            shutil.copytree(ROOT / "examples" / "compare_two", work / "source")
            flags = [f"-D{name}={cached(name)}"
                     for name in ("CMAKE_CXX_COMPILER", "CMAKE_CXX_FLAGS", "CMAKE_BUILD_TYPE")]
            run("cmake", "-G", "Ninja", "-S", work / "source", "-B", work / "build",
                f"-DCMAKE_PREFIX_PATH={work / 'prefix'}", *flags)
            run("cmake", "--build", work / "build")
            lines = run(work / "build" / "compare_two", "cube").splitlines()

        rmse = {line.split()[0]: float(line.split()[2]) for line in lines}
        self.assertEqual(list(rmse), ["shadow_map", "local_illumination"])
        # The cube's shadow covers part of the picture: who leaves it out cannot be as near to the truth.
        self.assertLess(rmse["shadow_map"], rmse["local_illumination"])

    def test_installed_program_runs(self):
        with tempfile.TemporaryDirectory() as folder:
            run("cmake", "--install", BUILD, "--prefix", folder)
            self.assertIn("cube", run(pathlib.Path(folder) / "bin" / "gnomon", "scene", "--list"))


if __name__ == "__main__":
    unittest.main()
