"""What the tests of the program `gnomon` share: running it, its exit codes, and a folder of their own."""

import os
import pathlib
import subprocess
import tempfile
import unittest

CLI = os.environ.get("GNOMON_CLI", "")
DONE, MACHINE, INPUT, INTERRUPTED = 0, 1, 2, 130
# Generous: lavapipe on a busy machine, perhaps under a sanitizer.
TIMEOUT_S = 240
SMALL = ("--size", "64x36")


def gnomon(*args, **options):
    """Runs the program and returns its exit code and output."""
    options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **options}
    return subprocess.run([CLI, *map(str, args)], text=True, timeout=TIMEOUT_S, **options)


NOBODY = 65534  # a user


class CliTest(unittest.TestCase):
    def unprivileged(self):
        """Options of gnomon() by which files' permissions count: root may do everything."""
        if os.geteuid() != 0:
            return {}
        options = {"user": NOBODY}
        try:
            gnomon("--version", **options)
        except PermissionError:
            self.skipTest("runs as root, and nobody else may run the program")
        return options

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)

    def assert_fails(self, code, words, *args, **options):
        """Exit `code`, and one `error:` line on stderr with all `words` in it; nothing on stdout."""
        result = gnomon(*args, **options)
        told = f"gnomon {' '.join(map(str, args))}: exit {result.returncode}, {result.stderr!r}"
        self.assertEqual(result.returncode, code, told)
        errors = [line for line in result.stderr.splitlines() if line.startswith("error: ")]
        self.assertEqual(len(errors), 1, told)
        others = [line for line in result.stderr.splitlines() if not line.startswith("error: ")]
        self.assertFalse([line for line in others if "error" in line.lower()], told)
        for word in words:
            self.assertIn(word, errors[0], told)
        self.assertFalse(result.stdout, told)
        return errors[0]

    def assert_works(self, *args, **options):
        result = gnomon(*args, **options)
        self.assertEqual(result.returncode, DONE, f"{args}: {result.stderr}")
        return result.stdout

    def files(self):
        """Everything below the test's folder, temporary files of the program included."""
        return sorted(str(path.relative_to(self.folder)) for path in self.folder.rglob("*"))
