#!/usr/bin/env python3
"""The program `gnomon` as its users meet it: help, typing errors, exit codes, and files that appear whole
or not at all. GNOMON_CLI is the path of the program."""

import csv
import json
import os
import pathlib
import resource
import signal
import subprocess
import sys
import tempfile
import unittest

CLI = os.environ.get("GNOMON_CLI", "")
DONE, MACHINE, INPUT, INTERRUPTED = 0, 1, 2, 130
COMMANDS = ("info", "scene", "render", "compare", "bench", "bake", "sun", "web")
# Generous: lavapipe on a busy machine, perhaps under a sanitizer.
TIMEOUT_S = 240
SMALL = ("--size", "64x36")
NOBODY = 65534


def gnomon(*args, **options):
    """Runs the program and returns its exit code and output."""
    options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, **options}
    return subprocess.run([CLI, *map(str, args)], text=True, timeout=TIMEOUT_S, **options)


class CliTest(unittest.TestCase):
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

    def assert_works(self, *args, **options):
        result = gnomon(*args, **options)
        self.assertEqual(result.returncode, DONE, f"{args}: {result.stderr}")
        return result.stdout

    def files(self):
        """Everything below the test's folder, temporary files of the program included."""
        return sorted(str(path.relative_to(self.folder)) for path in self.folder.rglob("*"))


class Help(CliTest):
    def test_program_lists_commands(self):
        for args in ([], ["--help"], ["-h"], ["help"]):
            text = self.assert_works(*args)
            for command in COMMANDS:
                self.assertIn(f"\n  {command} ", text)

    def test_each_command_has_usage_and_examples(self):
        for command in COMMANDS:
            text = self.assert_works(command, "--help")
            self.assertIn(f"Usage: gnomon {command}", text)
            self.assertIn(f"Examples:\n  gnomon {command}", text)
            self.assertEqual(text, self.assert_works("help", command))

    def test_help_fits_a_terminal(self):
        for command in COMMANDS:
            for line in self.assert_works(command, "--help").splitlines():
                self.assertLessEqual(len(line), 100, line)

    def test_version(self):
        self.assertRegex(self.assert_works("--version"), r"^gnomon \d+\.\d+\.\d+\n$")


class Info(CliTest):
    def test_text_has_every_technique_and_parameter_of_the_json(self):
        text = self.assert_works("info")
        for technique in json.loads(self.assert_works("info", "--json"))["techniques"]:
            self.assertIn(f"\n  {technique['name']}  {technique['title']}\n", text)
            for parameter in technique["parameters"]:
                self.assertIn(f"--{technique['name']}.{parameter['name']} ", text)
                self.assertIn(parameter["meaning"], text)

    def test_techniques_are_told_without_a_vulkan_device(self):
        # The loader then sees no driver; a machine without a loader takes the same way.
        env = {**os.environ, "VK_ICD_FILENAMES": "/nonexistent.json",
               "VK_DRIVER_FILES": "/nonexistent.json"}
        found = json.loads(self.assert_works("info", "--json", env=env))
        self.assertEqual(found["devices"], [])
        self.assertNotEqual(found["device_fault"], "")
        self.assertIn("ray_traced", [technique["name"] for technique in found["techniques"]])

    def test_scene_facts(self):
        self.assertIn("triangles", self.assert_works("info", "--scene", "cube"))
        facts = json.loads(self.assert_works("info", "--scene", "cube", "--json"))
        self.assertGreater(facts["triangles"], 0)
        self.assertEqual(facts["warnings"], [])


class Typos(CliTest):
    def test_command(self):
        self.assert_fails(INPUT, ['"rendr"', 'did you mean "render"?'], "rendr", "cube")

    def test_flag(self):
        self.assert_fails(INPUT, ["--techniqe", 'did you mean "--technique"?'],
                          "render", "cube", "-o", self.folder / "x.png", "--techniqe", "ray_traced")
        self.assert_fails(INPUT, ["-x"], "info", "-x")

    def test_technique(self):
        self.assert_fails(INPUT, ['"ray_tracd"', '"ray_traced"'],
                          "compare", "cube", "-o", self.folder / "r", "--techniques", "ray_tracd")

    def test_technique_of_a_parameter(self):
        self.assert_fails(INPUT, ['"ray_tracd"', '"ray_traced"'],
                          "compare", "cube", "-o", self.folder / "r", "--ray_tracd.samples", "4")

    def test_parameter(self):
        self.assert_fails(INPUT, ["ray_traced", '"sampels"', '"samples"'],
                          "compare", "cube", "-o", self.folder / "r", "--ray_traced.sampels", "4")

    def test_parameter_out_of_range(self):
        for value in ("0", "-3", "nan", "many", "99999999999"):
            self.assert_fails(INPUT, ["ray_traced", "samples", value], "compare", "cube", "-o",
                              self.folder / "r", "--ray-traced.samples", value)

    def test_parameter_without_value(self):
        self.assert_fails(INPUT, ["--ray_traced.samples", "value is missing"],
                          "bench", "cube", "--ray_traced.samples")

    def test_parameter_of_a_technique_that_does_not_run(self):
        self.assert_fails(INPUT, ["--ray_traced.samples", "local_illumination"], "bench", "cube",
                          "--techniques", "local_illumination", "--ray_traced.samples", "4")
        self.assert_fails(INPUT, ["--ray_traced.samples", "info"], "info", "--ray_traced.samples=4")

    def test_scene(self):
        self.assert_fails(INPUT, ['"courtyrd"', '"courtyard"'], "scene", "courtyrd", "-o",
                          self.folder / "x.glb")

    def test_value_missing_or_twice(self):
        self.assert_fails(INPUT, ["--size", "missing"], "render", "cube", "--size")
        self.assert_fails(INPUT, ["--size", "more than once"], "render", "cube", "--size", "1x1",
                          "--size", "2x2")

    def test_missing_arguments(self):
        self.assert_fails(INPUT, ["SCENE"], "render", "-o", self.folder / "x.png")
        self.assert_fails(INPUT, ["-o"], "render", "cube")
        self.assert_fails(INPUT, ["-o"], "compare", "cube")
        self.assert_fails(INPUT, ["NAME"], "scene")
        self.assert_fails(INPUT, ['"extra"'], "bench", "cube", "extra")


class Values(CliTest):
    def fails(self, words, *flags):
        self.assert_fails(INPUT, words, "render", "cube", "-o", self.folder / "x.png", *flags)
        self.assertEqual(self.files(), [])

    def test_size(self):
        for size in ("0x0", "1x0", "99999999x1", "12", "axb", "-5x5", ""):
            self.fails(["--size", f'"{size}"', "1 to 16384"], "--size", size)

    def test_camera(self):
        self.fails(["--camera: eye", "nan"], "--camera", "eye=nan,0,0,target=0,0,0")
        self.fails(["--camera: target", "inf"], "--camera", "eye=1,0,0,target=0,inf,0")
        self.fails(["fov", "0.1 to 179"], "--camera", "eye=1,0,0,target=0,0,0,fov=180")
        self.fails(["target is missing"], "--camera", "eye=1,0,0")
        self.fails(['"fow"', '"fov"'], "--camera", "eye=1,0,0,target=0,0,0,fow=60")
        self.fails(["--camera", "99"], "--camera", "99")
        self.fails(["--camera", '"nobody"'], "--camera", "nobody")

    def test_light(self):
        self.fails(['"son"', '"sun"'], "--light", "son:elevation=1,azimuth=2")
        self.fails(["elevation", "nan"], "--light", "sun:elevation=nan,azimuth=2")
        self.fails(["azimuth is missing"], "--light", "sun:elevation=20")
        self.fails(["--lights", '"nobody"'], "--lights", "nobody")

    def test_numbers(self):
        for flag, value in (("--samples", "0"), ("--samples", "1.5"), ("--exposure", "nan"),
                            ("--ambient", "-1"), ("--threads", "-1"), ("--animation-time", "inf")):
            self.fails([flag, value], flag, value)
        self.fails(["--compose", '"aditive"', '"additive"'], "--compose", "aditive")

    def test_samples_are_the_truth_s(self):
        self.fails(["--samples"], "--samples", "4", "--technique", "ray_traced")


class Input(CliTest):
    def fails(self, words, scene, **options):
        self.assert_fails(INPUT, words, "info", "--scene", scene, **options)

    def test_missing_file(self):
        self.fails(["nowhere.glb"], self.folder / "nowhere.glb")

    def test_folder(self):
        self.fails([str(self.folder)], self.folder)

    def test_empty_file(self):
        for name in ("empty.glb", "empty.gltf"):
            (self.folder / name).touch()
            self.fails([name], self.folder / name)

    def test_no_permission(self):
        secret = self.folder / "secret.glb"
        secret.write_bytes(b"glTF")
        secret.chmod(0)
        self.folder.chmod(0o755)
        options = {}
        if os.geteuid() == 0:  # root may read everything
            options["user"] = NOBODY
            try:
                gnomon("--version", **options)
            except PermissionError:
                self.skipTest("runs as root, and nobody else may run the program")
        self.fails(["secret.glb"], secret, **options)


class Output(CliTest):
    """Wrong places are refused before the work starts; failed writing leaves nothing."""

    def test_missing_folder(self):
        self.assert_fails(INPUT, ["-o", "does not exist"], "scene", "cube", "-o",
                          self.folder / "no" / "x.glb")
        self.assert_fails(INPUT, ["-o", "does not exist"], "compare", "cube", "-o",
                          self.folder / "no" / "report")

    def test_output_is_a_folder(self):
        self.assert_fails(INPUT, ["-o", "folder"], "scene", "cube", "-o", self.folder)

    def test_other_extension(self):
        self.assert_fails(INPUT, [".png"], "render", "cube", "-o", self.folder / "x.jpg")

    def test_folder_with_other_things_is_not_replaced(self):
        (self.folder / "thesis.txt").write_text("years of work")
        self.assert_fails(INPUT, ["report"], "compare", "cube", "-o", self.folder)
        (self.folder / "file").touch()
        self.assert_fails(INPUT, ["file"], "compare", "cube", "-o", self.folder / "file")
        self.assertEqual(self.files(), ["file", "thesis.txt"])

    def test_full_standard_output(self):
        if not os.path.exists("/dev/full"):
            self.skipTest("this system has no /dev/full")
        with open("/dev/full", "w", encoding="utf-8") as full:
            result = gnomon("info", stdout=full)
        self.assertEqual(result.returncode, MACHINE)
        self.assertRegex(result.stderr, r"^error: standard output: .*\n$")

    def test_reader_that_leaves_ends_quietly(self):
        read_end, write_end = os.pipe()
        os.close(read_end)
        result = gnomon("info", stdout=write_end)
        os.close(write_end)
        self.assertEqual((result.returncode, result.stderr), (DONE, ""))

    def test_existing_file_is_replaced_whole(self):
        path = self.folder / "x.glb"
        path.write_bytes(b"old" * 1_000_000)
        self.assert_works("scene", "cube", "-o", path)
        first = path.read_bytes()
        self.assertEqual(first[:4], b"glTF")
        self.assertEqual(len(first), int.from_bytes(first[8:12], "little"), "its length field")
        self.assertEqual(self.files(), ["x.glb"])

    def test_no_room_leaves_the_old_file(self):
        # A limit on the size of files fails as a full disk does: in the middle of writing.
        path = self.folder / "x.glb"
        path.write_bytes(b"old")
        limit = 1024

        def limited():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)  # let the write fail, not kill
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

        self.assert_fails(MACHINE, ["x.glb"], "scene", "courtyard", "-o", path, preexec_fn=limited)
        self.assertEqual(path.read_bytes(), b"old")
        self.assertEqual(self.files(), ["x.glb"])


class Work(CliTest):
    def test_render(self):
        picture, visibility = self.folder / "x.png", self.folder / "v.exr"
        told = self.assert_works("render", "cube", "-o", picture, "--visibility", visibility,
                                 "--samples", 4, "--light", "sun:elevation=40,azimuth=150", *SMALL)
        self.assertEqual(picture.read_bytes()[:8], b"\x89PNG\r\n\x1a\n")
        self.assertEqual(visibility.read_bytes()[:4], b"\x76\x2f\x31\x01")
        self.assertEqual(told, f"picture: {picture}\nvisibility of sun: {visibility}\n")

    def test_several_lights_have_a_visibility_each(self):
        self.assert_works("render", "cube", "-o", self.folder / "x.png", "--visibility",
                          self.folder / "v.exr", "--light", "point:position=2,3,2",
                          "--light", "point:position=-2,3,2", *SMALL)
        self.assertEqual(self.files(), ["v.0.exr", "v.1.exr", "x.png"])

    def test_compare(self):
        report = self.folder / "report"
        told = self.assert_works("compare", "cube", "-o", report, "--techniques",
                                 "local_illumination,ray_traced", "--ray_traced.samples", 4,
                                 "--reference-samples", 4, "--frames", 1, *SMALL)
        self.assertEqual(told.splitlines()[-1], f"report: {report / 'index.html'}")
        self.assertIn("ray_traced", told)
        results = json.loads((report / "results.json").read_text(encoding="utf-8"))
        self.assertEqual([row["technique"] for row in results["results"]],
                         ["local_illumination", "ray_traced"])
        self.assertEqual(results["results"][1]["parameters"]["samples"], 4)
        self.assertIn("<html", (report / "index.html").read_text(encoding="utf-8"))

    def test_bench(self):
        times = self.folder / "times.json"
        told = self.assert_works("bench", "cube", "--techniques", "local_illumination", "--frames",
                                 3, "--json", times, *SMALL)
        self.assertIn("median", told)
        total = json.loads(times.read_text(encoding="utf-8"))["results"][0]["time_ms"]["total"]
        self.assertLessEqual(total["min"], total["median"])
        self.assertLessEqual(total["median"], total["max"])

    def test_no_such_device(self):
        self.assert_fails(INPUT, ["no such device"], "render", "cube", "-o", self.folder / "x.png",
                          "--device", "no such device", *SMALL)
        self.assertEqual(self.files(), [])


class Sun(CliTest):
    DAY = ("--place", "48.137,11.575", "--date", "2026-03-20")
    QUICK = ("--minutes", 30, *SMALL)

    def sun(self, *flags):
        return self.assert_works("sun", "cube", "-o", self.folder / "hours", *self.QUICK, *flags)

    def rows(self, name="hours.csv"):
        with open(self.folder / "hours" / name, encoding="utf-8") as file:
            return list(csv.DictReader(file))

    def fails(self, words, *flags):
        self.assert_fails(INPUT, words, "sun", "cube", "-o", self.folder / "hours", *flags)
        self.assertNotIn("hours", self.files())

    def test_surfaces(self):
        told = self.sun(*self.DAY, "--texel", 0.25, "--at-least", "2h", "--at-least", 6)
        self.assertEqual(self.files(), ["hours", "hours/hours.csv", "hours/hours.exr",
                                        "hours/top.png", "hours/view.png"])
        for word in ("sunrise 2026-03-20", "each change", ">=2 h", ">=6 h", "\nall ", "\nup "):
            self.assertIn(word, told)
        self.assertEqual(told.splitlines()[-1], str(self.folder / "hours" / "view.png"))
        rows = self.rows()
        self.assertEqual(list(rows[0]), "x,y,z,nx,ny,nz,area_m2,hours,longest".split(","))
        self.assertTrue(all(0 <= float(row["longest"]) <= float(row["hours"]) <= 12.2 for row in rows))

    def test_texel_size_is_told_when_it_is_chosen(self):
        self.assertRegex(self.sun(*self.DAY), r"--texel 0\.\d+ was chosen")

    def test_fronts_are_a_part_of_both_sides(self):
        def area(*flags):
            self.sun(*self.DAY, "--texel", 0.5, *flags)
            return sum(float(row["area_m2"]) for row in self.rows())
        self.assertLess(area("--fronts"), area())

    def test_sensors(self):
        points = self.folder / "points.csv"
        points.write_text("x,y,z,nx,ny,nz\n100,0,100,0,1,0\n100,0,100,0,-1,0\n100,0,100\n", encoding="utf-8")
        self.sun(*self.DAY, "--sensors", points)
        hours = [float(row["hours"]) for row in self.rows()]
        self.assertEqual(hours[0], hours[2])
        self.assertAlmostEqual(hours[0], 12.0, delta=0.1)  # an equinox, far from the cube
        self.assertEqual(hours[1], 0.0)

    def test_sensors_in_the_coordinates_of_a_file_with_z_up(self):
        wall = self.folder / "wall.obj"  # along the meridian, west of the point, with +Y north
        wall.write_text("v 0 -1000 0\nv 0 1000 0\nv 0 1000 1000\nv 0 -1000 1000\nf 1 2 3 4\n", encoding="utf-8")
        points = self.folder / "points.csv"
        points.write_text("1,0,0\n-1,0,0\n0.5,0,2000\n", encoding="utf-8")
        self.assert_works("sun", wall, "--up", "z", "-o", self.folder / "hours", *self.DAY, "--minutes", 2,
                          "--sensors", points, *SMALL)
        rows = self.rows()
        self.assertEqual([(row["x"], row["z"]) for row in rows],
                         [("1.0000", "0.0000"), ("-1.0000", "0.0000"), ("0.5000", "2000.0000")])
        self.assertEqual([row["nz"] for row in rows], ["1"] * 3)
        morning, evening, whole = (float(row["hours"]) for row in rows)
        self.assertAlmostEqual(morning, whole / 2, delta=0.05)  # noon is not quite the middle
        self.assertAlmostEqual(evening, whole / 2, delta=0.05)

    def test_grid_and_surfaces_together(self):
        told = self.sun(*self.DAY, "--grid", "1,0.5", "--texel", 0.5)
        self.assertIn("the grid's height is 0.5 m", told)
        self.assertIn("hours/grid_hours.csv", self.files())
        self.assertIn("hours/texels_hours.exr", self.files())

    def test_period(self):
        told = self.sun("--place", "48.137,11.575", "--from", "2026-03-01", "--to", "2026-03-31", "--step", 10,
                        "--texel", 0.5, "--at-least", 4)
        self.assertIn("4 of 31 days", told)
        self.assertIn("every day", told)
        for row in self.rows():
            self.assertLessEqual(float(row["hours_worst_day"]), float(row["hours_per_day"]) + 0.001)

    def test_year(self):
        told = self.assert_works("sun", "cube", "-o", self.folder / "hours", "--place", "48.137,11.575", "--year",
                                 2026, "--grid", 1, *SMALL)
        self.assertIn("all 365 days", told)

    def test_polar_night_is_an_answer(self):
        told = self.sun("--place", "69.65,18.96", "--date", "2026-12-21", "--texel", 0.5)
        self.assertIn("polar night", told)

    def test_what_is_missing_or_wrong(self):
        place, date = self.DAY[:2], self.DAY[2:]
        self.fails(["--place is missing"], *date)
        self.fails(["--date", "--from", "--year"], *place)
        self.fails(["--date", "--from", "--year"], *self.DAY, "--year", 2026)
        self.fails(["--date", "--from", "--year"], *place, "--from", "2026-01-01")
        self.fails(["--to", "before"], *place, "--from", "2026-02-01", "--to", "2026-01-01")
        self.fails(["--step"], *self.DAY, "--step", 3)
        self.fails(["--date", "2026-02-30", "does not exist"], *place, "--date", "2026-02-30")
        self.fails(["--place", "91"], "--place", "91,0", *date)
        self.fails(["--minutes", "1", "2 to 60"], *self.DAY, "--minutes", 1)
        self.fails(["--at-least", "25", "0 to 24"], *self.DAY, "--at-least", "25h")
        self.fails(["--grid", "1,2,3"], *self.DAY, "--grid", "1,2,3")
        self.fails(["grid", "1e-06"], *self.DAY, "--grid", "1e-6")
        self.fails(["nowhere.csv"], *self.DAY, "--sensors", self.folder / "nowhere.csv")
        points = self.folder / "points.csv"
        points.write_text("1,2,3\n1,2\n", encoding="utf-8")
        self.fails(["points.csv, line 2"], *self.DAY, "--sensors", points)
        self.assert_fails(INPUT, ["-o"], "sun", "cube", *self.DAY)
        self.assert_fails(INPUT, ["-o", "does not exist"], "sun", "cube", *self.DAY, "-o",
                          self.folder / "no" / "hours")

    def test_folder_keeps_what_else_it_holds(self):
        (self.folder / "hours").mkdir()
        (self.folder / "hours" / "plan.txt").write_text("mine", encoding="utf-8")
        self.sun(*self.DAY, "--texel", 0.5)
        self.assertEqual((self.folder / "hours" / "plan.txt").read_text(encoding="utf-8"), "mine")

    def test_pages_of_an_earlier_run_go(self):
        (self.folder / "hours").mkdir()
        mine = ["hours.old.exr", "hours.1.png", "north_hours.exr"]
        for name in [*mine, "hours.0.exr", "hours.12.exr"]:
            (self.folder / "hours" / name).write_text("earlier", encoding="utf-8")
        self.sun(*self.DAY, "--texel", 0.5)
        pages = [name for name in self.files() if name.endswith((".exr", "1.png"))]
        self.assertEqual(pages, sorted(f"hours/{name}" for name in [*mine, "hours.exr"]))
        self.sun(*self.DAY, "--grid", 1)  # has no pages
        self.assertNotIn("hours/hours.exr", self.files())


class Bake(CliTest):
    SUN = ("--sun", "place=48.137,11.575,date=2026-06-21,steps=40")
    SWEEP = {"kind": "direction", "keys": [{"time": 0, "value": [-1, 0.5, 0]}, {"time": 8, "value": [0, 1, 0]},
                                           {"time": 30, "value": [1, 1, 1]}]}

    def bake(self, *flags, **options):
        return self.assert_works("bake", "cube", "--texel", 0.25, *flags, "-o", self.folder / "day", **options)

    def content(self, name="day"):
        return {path.name: path.read_bytes() for path in (self.folder / name).iterdir()}

    def light(self, content):
        path = self.folder / "sweep.json"
        path.write_text(json.dumps(content), encoding="utf-8")
        return path

    def test_light_path(self):
        told = self.bake("--light", f"path={self.light(self.SWEEP)},diameter=2,steps=60", "--bits", 16)
        self.assertIn("light path of 3 keys", told)
        path = json.loads(self.content()["bake.json"])["path"]
        self.assertEqual((path["begin_s"], path["end_s"], path["place"]), (0, 30, ""))
        self.assertAlmostEqual(path["angular_diameter_rad"], 0.0349066, places=6)
        self.assertEqual(len(path["to_light_ws"]), 60)
        middle = path["to_light_ws"][16]  # of step 16: 8.25 s, just past the key overhead
        self.assertGreater(middle[1], 0.999)

    def test_what_is_missing_or_wrong(self):
        def fails(words, *flags):
            self.assert_fails(INPUT, words, "bake", "cube", *flags, "-o", self.folder / "day")
        light = f"path={self.light(self.SWEEP)}"
        fails(["--sun", "--light"])
        fails(["--sun and --light are both given"], *self.SUN, "--light", light)
        fails(["--light", "path"], "--light", "steps=4")
        fails(["--light", "steps", "300", "255"], "--light", f"{light},steps=300")
        fails(["diameter", "-1", "0 to 180"], "--light", f"{light},diameter=-1")
        fails(["nowhere.json"], "--light", "path=nowhere.json")
        lamp = {"kind": "position", "keys": self.SWEEP["keys"]}
        fails(["sweep.json", "positions"], "--light", f"path={self.light(lamp)}")
        fails(["sweep.json", "one key"], "--light",
              f"path={self.light({**self.SWEEP, 'keys': self.SWEEP['keys'][:1]})}")
        self.assertEqual(self.files(), ["sweep.json"])

    def test_full_disk_keeps_what_is_done(self):
        # A limit on the size of files fails as a full disk does. scene.glb has a megabyte, the times
        # of 8,000 texels a tenth of it.
        limit = 400_000

        def limited():
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

        def flags(name):
            return ("bake", "courtyard", "--texel", 1, *self.SUN, "-o", self.folder / name)
        self.assert_works(*flags("whole"))
        kept = self.folder / "day.unfinished"
        self.assert_fails(MACHINE, ["scene.glb", str(kept), "--resume"], *flags("day"), preexec_fn=limited)
        self.assertEqual([name for name in self.files() if "day" in name], ["day.unfinished"])
        self.assertGreater(kept.stat().st_size, 30_000)
        self.assert_works(*flags("day"), "--resume")
        self.assertEqual(self.content("day"), self.content("whole"))
        self.assertFalse(kept.exists())


class Interrupt(CliTest):
    COMPARE = ("compare", "courtyard", "--size", "1920x1080", "--reference-samples", "65536")
    SUN = ("sun", "courtyard", "--place", "48.137,11.575", "--year", "2026", "--minutes", "2", "--texel", "0.01")

    def interrupt(self, number, arguments=COMPARE):
        """Sends the signal to a long command once it tells its progress; its exit code and stderr."""
        def as_from_a_terminal():
            # A shell's background jobs, and so perhaps we, ignore Ctrl-C; the program would too.
            signal.signal(number, signal.SIG_DFL)

        command = [CLI, *arguments, "-o", str(self.folder / "report")]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                              preexec_fn=as_from_a_terminal) as process:
            try:
                for line in process.stderr:
                    if line.endswith("%\n") or line.endswith("left\n"):
                        break
                process.send_signal(number)
                stdout, stderr = process.communicate(timeout=TIMEOUT_S)
            except BaseException:
                process.kill()
                raise
        self.assertEqual(stdout, "")
        return process.returncode, stderr

    def test_ctrl_c_leaves_nothing(self):
        code, stderr = self.interrupt(signal.SIGINT)
        self.assertEqual(code, INTERRUPTED, stderr)
        self.assertRegex(stderr.splitlines()[-1], "^error: cancelled")
        self.assertEqual(self.files(), [])

    def test_ctrl_c_leaves_no_hours(self):
        code, stderr = self.interrupt(signal.SIGINT, self.SUN)
        self.assertEqual(code, INTERRUPTED, stderr)
        self.assertEqual(self.files(), [])

    def test_termination_leaves_nothing(self):
        code, stderr = self.interrupt(signal.SIGTERM)
        self.assertEqual(code, 128 + signal.SIGTERM, stderr)
        self.assertEqual(self.files(), [])


if __name__ == "__main__":
    if not CLI:
        sys.exit("GNOMON_CLI must be the path of the program gnomon")
    unittest.main()
