#!/usr/bin/env python3
"""The commands of `gnomon` that work for long, as their users meet them: hours of sun, bakes, and what is
left of them and of comparisons when they are interrupted. GNOMON_CLI is the path of the program."""

import csv
import json
import math
import re
import resource
import signal
import subprocess
import sys
import unittest

from cli_case import CLI, DONE, INPUT, INTERRUPTED, MACHINE, SMALL, TIMEOUT_S, CliTest, gnomon


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
        points.write_text("100,0,100,0,1,0\n100,0,100,0,-1,0\n100,0,100\n", encoding="utf-8")
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

    def test_grids_on_planes(self):
        planes = self.folder / "facades.csv"
        # South and north of the cube and before it, and through the cube.
        planes.write_text("x,y,z,ux,uy,uz,vx,vy,vz\n-0.5,0,0.51,1,0,0,0,1,0\n0.5,0,-0.51,-1,0,0,0,1,0\n"
                          "-0.25,0.25,0,0.5,0,0,0,0.5,0\n", encoding="utf-8")
        told = self.sun(*self.DAY, "--grid", f"0.25,{planes}")
        self.assertIn(" points on 3 planes, 0.25 m apart; 4 inside", told)
        south, north, inside = ([row for row in self.rows() if row["plane"] == plane] for plane in "123")
        self.assertEqual({(row["nx"], row["ny"], row["nz"]) for row in south}, {("0", "0", "1")})
        self.assertEqual({row["weight"] for row in south + north}, {"1"})
        self.assertEqual({row["weight"] for row in inside}, {"0"})
        self.assertGreater(min(float(row["hours"]) for row in south), 8)
        self.assertLess(max(float(row["hours"]) for row in north), 1)
        # In coordinates of a file with Z up: a wall that faces -Y, as those that face south do.
        wall = self.folder / "wall.obj"
        wall.write_text("v 0 1 0\nv 4 1 0\nv 4 1 3\nv 0 1 3\nf 1 2 3 4\n", encoding="utf-8")
        planes.write_text("0,0.9,0,4,0,0,0,0,3\n", encoding="utf-8")
        self.assert_works("sun", wall, "--up", "z", "-o", self.folder / "hours", *self.DAY, *self.QUICK, "--grid",
                          f"1,{planes}")
        rows = self.rows()
        self.assertEqual({(row["y"], row["nx"], row["ny"], row["nz"]) for row in rows}, {("0.9000", "0", "-1", "0")})
        self.assertEqual(sorted({row["z"] for row in rows}), ["0.5000", "1.5000", "2.5000"])

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

    def test_a_zone_has_summer_time(self):
        for date, offset in (("2026-03-28", "+01:00"), ("2026-03-29", "+02:00")):
            told = self.sun(*self.DAY[:2], "--date", date, "--utc-offset", "Europe/Berlin", "--texel", 0.5)
            self.assertIn(f"{date}T", told)
            self.assertEqual(set(re.findall(r"T[0-9:]{8}([+-][0-9:]{5})", told)), {offset})

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
        self.fails(["--utc-offset", "+25", "-18:00 to +18:00"], *self.DAY, "--utc-offset", "+25")
        self.fails(["--utc-offset", "Berlin", "Europe/Berlin\"?"], *self.DAY, "--utc-offset", "Berlin")
        self.fails(["--minutes", "1", "2 to 60"], *self.DAY, "--minutes", 1)
        self.fails(["--at-least", "25", "0 to 24"], *self.DAY, "--at-least", "25h")
        self.fails(["--grid", "1,2,3"], *self.DAY, "--grid", "1,2,3")
        self.fails(["grid", "1e-06"], *self.DAY, "--grid", "1e-6")
        self.fails(["nowhere.csv"], *self.DAY, "--grid", f"1,{self.folder / 'nowhere.csv'}")
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

    def test_full_disk_leaves_what_was_there(self):
        # A limit on the size of files fails as a full disk does: hours.csv and hours.exr fit, top.png does not.
        limit = 4096

        def limited():
            signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
            resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit))

        flags = ("sun", "cube", "-o", self.folder / "hours", *self.DAY, "--grid", 4, "--minutes", 60)
        self.assert_fails(MACHINE, ["top.png"], *flags, preexec_fn=limited)
        self.assertEqual(self.files(), [])
        (self.folder / "hours").mkdir()
        (self.folder / "hours" / "hours.csv").write_text("earlier", encoding="utf-8")
        self.assert_fails(MACHINE, ["top.png"], *flags, preexec_fn=limited)
        self.assertEqual(self.files(), ["hours", "hours/hours.csv"])
        # Nor does it do half of its work where a file cannot be replaced.
        (self.folder / "hours" / "view.png" / "mine").mkdir(parents=True)
        self.assert_fails(MACHINE, ["view.png"], *flags)
        self.assertEqual(self.files(), ["hours", "hours/hours.csv", "hours/view.png", "hours/view.png/mine"])
        self.assertEqual((self.folder / "hours" / "hours.csv").read_text(encoding="utf-8"), "earlier")

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

    def test_help_has_the_defaults(self):
        told = " ".join(self.assert_works("bake", "--help").split())
        for words in ("metres (default 0.1)", "16 (default 8)", "each (default 4)"):
            self.assertIn(words, told)

    def test_the_clock_is_told(self):
        told = self.bake(*self.SUN)
        self.assertIn("clocks at UTC+01:00, the sun's own nearest hour (utc=)\n", told)
        self.assertEqual(json.loads(self.content()["bake.json"])["path"]["utc_offset"], "+01:00")
        told = self.bake("--sun", f"{self.SUN[1]},utc=+02:00")
        self.assertNotIn("clocks", told)
        self.assertEqual(json.loads(self.content()["bake.json"])["path"]["utc_offset"], "+02:00")

    def test_the_clock_of_a_zone_has_summer_time(self):
        told = self.bake("--sun", f"{self.SUN[1]},utc=Europe/Berlin")
        self.assertIn("clocks at UTC+02:00, of Europe/Berlin on that day\n", told)
        summer = json.loads(self.content()["bake.json"])["path"]
        self.bake("--sun", f"{self.SUN[1]},utc=+02:00")
        self.assertEqual(json.loads(self.content()["bake.json"])["path"], summer)
        told = self.bake("--sun", "place=48.137,11.575,date=2026-12-21,steps=40,utc=Europe/Berlin")
        self.assertIn("UTC+01:00", told)

    def test_what_is_missing_or_wrong(self):
        def fails(words, *flags):
            self.assert_fails(INPUT, words, "bake", "cube", *flags, "-o", self.folder / "day")
        light = f"path={self.light(self.SWEEP)}"
        fails(["--sun", "--light"])
        fails(["--sun and --light are both given"], *self.SUN, "--light", light)
        fails(["--light", "path"], "--light", "steps=4")
        fails(["--sun", "utc", "Europe/Berln", "Europe/Berlin\"?"], "--sun", f"{self.SUN[1]},utc=Europe/Berln")
        fails(["--light", "steps", "300", "255"], "--light", f"{light},steps=300")
        fails(["diameter", "-1", "0 to 180"], "--light", f"{light},diameter=-1")
        fails(["nowhere.json"], "--light", "path=nowhere.json")
        lamp = {"kind": "position", "keys": self.SWEEP["keys"]}
        fails(["sweep.json", "positions"], "--light", f"path={self.light(lamp)}")
        fails(["sweep.json", "one key"], "--light",
              f"path={self.light({**self.SWEEP, 'keys': self.SWEEP['keys'][:1]})}")
        self.assertEqual(self.files(), ["sweep.json"])

    def test_is_rendered_at_a_time_of_its_clock(self):
        self.bake(*self.SUN)
        out = self.folder / "frame.png"

        def render(*flags):
            self.assert_works("render", self.folder / "day", *SMALL, *flags, "-o", out)
            return out.read_bytes()
        morning = render("--time", "08:00")
        self.assertEqual(render("--time", "08:00:00.0"), morning)
        self.assertNotEqual(render("--time", "14:30"), morning)
        self.assertEqual(render("--time", "08:00", "--technique", "occlusion_interval_maps"), morning)
        self.assertNotEqual(render("--time", "08:00", "--occlusion_interval_maps.lookup", "nearest"), morning)
        # Other techniques and the truth have the bake's light.
        for how in (("--samples", 4), ("--technique", "shadow_map")):
            self.assertNotEqual(render("--time", "08:00", *how), render("--time", "14:30", *how))

    def test_is_a_row_of_a_comparison(self):
        self.bake(*self.SUN, "--bits", 16)
        techniques = ("--techniques", "occlusion_interval_maps,shadow_map", "--frames", 1, "--reference-samples", 16)
        self.assert_works("compare", self.folder / "day", "--time", "08:00", *SMALL, *techniques, "-o", self.folder / "report")
        rows = json.loads((self.folder / "report/results.json").read_text(encoding="utf-8"))["results"]
        baked, mapped = rows
        self.assertEqual(baked["parameters"], {"lookup": "edges", "weight": "disc"})
        self.assertIn("Looks up the bake", baked["note"])
        self.assertLess(baked["error"]["rmse"], 0.1)
        self.assertIn("map_size", mapped["parameters"])
        told = self.assert_works("bench", self.folder / "day", "--time", "08:00", *SMALL, "--frames", 1,
                                 "--techniques", "occlusion_interval_maps")
        self.assertIn("occlusion_interval_maps on sun", told)

    def test_times_of_bakes_and_of_others(self):
        self.bake(*self.SUN)
        (self.folder / "empty").mkdir()

        def fails(words, scene, *flags):
            for command, name in (("render", "frame.png"), ("compare", "report"), ("bench", None)):
                out = ("-o", self.folder / name) if name else ()
                self.assert_fails(INPUT, words, command, scene, *flags, *out)
        day = self.folder / "day"
        fails(["--time is missing", "10:30", str(day)], day)
        fails(["03:00", "04:1", "20:1"], day, "--time", "03:00")
        fails(["--time", '"noon"', "10:30"], day, "--time", "noon")
        fails(["--time", "cube"], "cube", "--time", "10:30")
        fails(["--light", "--time"], day, "--time", "10:30", "--light", "sun:elevation=30,azimuth=90")
        fails(["--lights", "--time"], day, "--time", "10:30", "--lights", "0")
        fails([str(self.folder / "empty"), "bake.json", "gnomon bake"], self.folder / "empty", "--time", "10:30")
        self.assert_fails(INPUT, ["steps", "lookup, weight"], "render", day, "--time", "10:30",
                          "--occlusion_interval_maps.steps", 20, "-o", self.folder / "frame.png")
        (day / "page0-rise0.png").write_bytes(b"no picture")
        self.assert_fails(INPUT, ["page0-rise0.png"], "render", day, "--time", "10:30", "-o", self.folder / "frame.png")
        self.assertFalse([name for name in self.files() if name in ("frame.png", "report")])

    def test_rays_find_what_interval_traversal_finds(self):
        self.bake(*self.SUN)
        by_default = self.content()
        self.bake(*self.SUN, "--method", "interval_traversal")
        self.assertEqual(self.content(), by_default)
        self.bake(*self.SUN, "--method", "rays")
        self.assertEqual(self.content().keys(), by_default.keys())
        report, expected = (json.loads(content["bake.json"])["report"] for content in (self.content(), by_default))
        self.assertAlmostEqual(report["intervals"], expected["intervals"], delta=2)
        self.assertEqual(report["texels"], expected["texels"])
        self.assert_fails(INPUT, ["--method", "ray", "interval_traversal, rays"], "bake", "cube", *self.SUN,
                          "--method", "ray", "-o", self.folder / "day")

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
        self.assert_fails(INPUT, [str(kept), "--resume", "delete"], *flags("day"))
        self.assertGreater(kept.stat().st_size, 30_000)
        self.assert_works(*flags("day"), "--resume")
        self.assertEqual(self.content("day"), self.content("whole"))
        self.assertFalse(kept.exists())

    def test_a_bake_that_does_not_fit_is_refused_before_it_starts(self):
        for command in (("bake", "courtyard", *self.SUN), ("sun", "courtyard", *Sun.DAY)):
            told = self.assert_fails(INPUT, ["--texel 1e-05 makes", "this machine has", "--texel", "would fit"],
                                     *command, "--texel", "1e-5", "-o", self.folder / "day")
            self.assertNotIn("texel_size_m", told)
        self.assertEqual(self.files(), [])

    def test_a_triangle_larger_than_a_page_is_told_by_the_flag(self):
        plane = self.folder / "plane.obj"  # long, but of few texels
        plane.write_text("v 0 0 0\nv 900 0 0\nv 900 0 2\nf 1 2 3\n", encoding="utf-8")
        told = self.assert_fails(INPUT, ["a triangle of", "--texel must be at least"], "bake", plane, *self.SUN,
                                 "--texel", 0.1, "-o", self.folder / "day")
        self.assertNotIn("max_page_texels", told)

    def test_a_slash_after_the_folder_is_no_part_of_its_name(self):
        self.bake(*self.SUN)
        before = self.content()
        name = f"{self.folder / 'day'}/"
        for _ in range(2):
            told = self.assert_works("bake", "cube", "--texel", 0.25, *self.SUN, "-o", name)
            self.assertEqual(told.splitlines()[-1], f"bake: {self.folder / 'day'}")
            self.assertEqual(self.content(), before)
        (self.folder / "day.unfinished").write_text("mine", encoding="utf-8")
        self.assert_fails(INPUT, ["day.unfinished"], "bake", "cube", *self.SUN, "-o", name)

    def test_a_file_of_another_kind_is_never_deleted(self):
        notes = self.folder / "day.unfinished"
        notes.write_text("chapter 1", encoding="utf-8")
        for resume in ((), ("--resume",)):
            self.assert_fails(INPUT, [str(notes), "no unfinished bake", "move"], "bake", "cube", *self.SUN, *resume,
                              "-o", self.folder / "day")
        self.assertEqual(self.files(), ["day.unfinished"])
        self.assertEqual(notes.read_text(encoding="utf-8"), "chapter 1")


class LostIntervals(CliTest):
    """A bit of ground inside of a fence: the sun of a day is hidden there more often than textures can tell."""
    SLATS = 120
    FLAGS = ("--technique", "occlusion_interval_maps")
    PARAMETERS = ("--occlusion_interval_maps.texel_size", 0.05, "--occlusion_interval_maps.fine_parts", 1)
    VIEW = ("--camera", "eye=0,1,0.1,target=0,0,0", "--light", "sun:elevation=40,azimuth=150", *SMALL)

    def scene(self, slats):
        lines = ["v -0.1 0 -0.1", "v -0.1 0 0.1", "v 0.1 0 0.1", "v 0.1 0 -0.1", "f 1 2 3 4"]
        for k in range(slats):
            for bearing in (k - 0.25, k + 0.25):
                angle = math.radians(360 / self.SLATS * bearing)
                x, z = 2 * math.sin(angle), 2 * math.cos(angle)
                lines += [f"v {x} 0 {z}", f"v {x} 9 {z}"]
            lines.append("f -4 -3 -1 -2")
        path = self.folder / "fence.obj"
        path.write_text("\n".join(lines), encoding="utf-8")
        return path

    def warnings(self, command, slats, *flags):
        result = gnomon(command, self.scene(slats), *flags, *self.PARAMETERS, *self.VIEW)
        self.assertEqual(result.returncode, DONE, result.stderr)
        return [line for line in result.stderr.splitlines() if line.startswith("warning: ") and "gaps" in line]

    def test_are_a_warning(self):
        render = ("-o", self.folder / "x.png", *self.FLAGS)
        self.assertEqual(self.warnings("render", self.SLATS // 4, *render), [])
        for told in (self.warnings("render", self.SLATS, *render),
                     self.warnings("bench", self.SLATS, "--techniques", "occlusion_interval_maps", "--frames", 1)):
            self.assertRegex("".join(told), r"^warning: occlusion_interval_maps, sun: \d+ gaps closed for want of "
                                            r"pairs: \d+\.\d+ % of")

    def test_are_in_the_report(self):
        told = self.assert_works("compare", self.scene(self.SLATS), "-o", self.folder / "report",
                                 "--techniques", "occlusion_interval_maps", *self.PARAMETERS, *self.VIEW,
                                 "--reference-samples", 4, "--frames", 1)
        row = next(line for line in told.splitlines() if line.startswith("occlusion_interval_maps"))
        self.assertIn("gaps closed for want of pairs", row)
        results = json.loads((self.folder / "report" / "results.json").read_text(encoding="utf-8"))["results"]
        self.assertIn("gaps closed for want of pairs", results[0]["note"])


class Interrupt(CliTest):
    COMPARE = ("compare", "courtyard", "--size", "1920x1080", "--reference-samples", "65536")
    SUN = ("sun", "courtyard", "--place", "48.137,11.575", "--year", "2026", "--minutes", "2", "--texel", "0.01")
    BAKE = ("bake", "courtyard", "--sun", "place=48.137,11.575,date=2026-06-21", "--bits", "16", "--method", "rays",
            "--texel", "0.05")

    def interrupt(self, number, arguments=COMPARE, task=""):
        """Sends the signal to a long command once it tells its progress, at that task; its exit code and stderr."""
        def as_from_a_terminal():
            # A shell's background jobs, and so perhaps we, ignore Ctrl-C; the program would too.
            signal.signal(number, signal.SIG_DFL)

        command = [CLI, *arguments, "-o", str(self.folder / "report")]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                              preexec_fn=as_from_a_terminal) as process:
            try:
                for line in process.stderr:
                    if line.startswith(task) and (line.endswith("%\n") or line.endswith("left\n")):
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

    def test_a_closed_terminal_keeps_what_is_baked(self):
        code, stderr = self.interrupt(signal.SIGHUP, self.BAKE, "baking the sun")
        self.assertEqual(code, 128 + signal.SIGHUP, stderr)
        self.assertIn("--resume goes on with it", stderr.splitlines()[-1])
        self.assertEqual(self.files(), ["report.unfinished"])


if __name__ == "__main__":
    if not CLI:
        sys.exit("GNOMON_CLI must be the path of the program gnomon")
    unittest.main()
