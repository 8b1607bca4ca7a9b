#!/usr/bin/env python3
"""tools/setup.sh on machines that are played by stand-ins of dpkg-query, apt-get, id and sudo."""

import os
import pathlib
import stat
import subprocess
import tempfile
import unittest

SETUP = pathlib.Path(__file__).resolve().parent / "setup.sh"


def machine(installed, uid=1000, sudo=False, apt=True):
    """Runs `setup.sh build` where only `installed` is; returns (exit code, output, apt-get's calls)."""
    with tempfile.TemporaryDirectory() as folder:
        calls = pathlib.Path(folder) / "calls"
        programs = {
            "dpkg-query": "\n".join(f"echo '{name}:amd64 installed'" for name in installed),
            "apt-get": f'echo "$*" >>{calls}',
            "id": f"echo {uid}",
            "sudo": 'shift; exec "$@"' if sudo else "exit 1",
        }
        for name, body in programs.items():
            if name == "apt-get" and not apt:
                continue
            program = pathlib.Path(folder) / name
            program.write_text(f"#!/bin/bash\n{body}\n", encoding="utf-8")
            program.chmod(program.stat().st_mode | stat.S_IXUSR)
        for name in ("awk", "bash", "dirname", "env", "grep", "sed", "true"):
            path = next(p for d in os.defpath.split(":") if (p := pathlib.Path(d) / name).exists())
            (pathlib.Path(folder) / name).symlink_to(path)
        done = subprocess.run(["/bin/bash", SETUP, "build"], env={"PATH": folder}, text=True,
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        return done.returncode, done.stdout, calls.read_text() if calls.exists() else ""


def packages():
    text = (SETUP.parent / "packages.txt").read_text(encoding="utf-8")
    build = text.split("[build]")[1].split("\n[")[0]
    return [line for line in build.split("\n") if line and not line.startswith("#")]


class Setup(unittest.TestCase):
    def test_does_nothing_when_all_is_there(self):
        code, output, calls = machine(packages())
        self.assertEqual((code, calls), (0, ""))
        self.assertIn("are installed", output)

    def test_root_installs_what_is_missing_and_no_more(self):
        code, _, calls = machine(packages()[1:], uid=0)
        self.assertEqual(code, 0)
        self.assertEqual(calls.splitlines()[-1],
                         f"install -y --no-install-recommends {packages()[0]}")

    def test_sudo_without_password_installs(self):
        code, _, calls = machine(packages()[:-1], sudo=True)
        self.assertEqual(code, 0)
        self.assertIn(f"install -y --no-install-recommends {packages()[-1]}", calls)

    def test_others_are_told_the_line_to_run(self):
        code, output, calls = machine([])
        self.assertEqual((code, calls), (1, ""))
        self.assertIn("sudo apt-get install -y --no-install-recommends " + " ".join(packages()), output)

    def test_other_systems_are_told_of_vcpkg(self):
        code, output, _ = machine([], apt=False)
        self.assertEqual(code, 1)
        self.assertIn("vcpkg.json", output)


if __name__ == "__main__":
    unittest.main()
