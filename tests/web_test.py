#!/usr/bin/env python3
"""`gnomon web` in a real browser: what its page draws and tells against the numbers of the bake's own files,
read here anew, and against rays. tests/web_drive.mjs visits the page. GNOMON_CLI is the path of the program."""

import http.server
import json
import math
import os
import pathlib
import re
import shutil
import struct
import subprocess
import tempfile
import threading
import unittest
import zlib

CLI = os.environ.get("GNOMON_CLI", "")
PACKAGES = pathlib.Path(os.environ.get("GNOMON_BUILD", ".")) / "web"
DRIVE = pathlib.Path(__file__).resolve().parent / "web_drive.mjs"
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
SUN = "place=48.137,11.575,date=2026-06-21"
TITLE = 'Cube & "plane"'
TIMEOUT_S = 240  # generous: a browser without a GPU on a busy machine
PHONE_PX = 360
LANES = 4  # intervals per pair of textures


def gnomon(*args, ok=True):
    result = subprocess.run([CLI, *map(str, args)], text=True, timeout=TIMEOUT_S, stdout=subprocess.PIPE,
                            stderr=subprocess.PIPE, check=False)
    if ok and result.returncode != 0:
        raise AssertionError(f"gnomon {args}: {result.stderr}")
    return result


def png(path):
    """(width, height, channels, numbers) of a PNG of 8 or 16 bits, not interlaced."""
    data = path.read_bytes()
    at, packed = 8, b""
    while at < len(data):
        length, kind = struct.unpack_from(">I4s", data, at)
        body = data[at + 8:at + 8 + length]
        if kind == b"IHDR":
            width, height, bits, colour = struct.unpack_from(">IIBB", body)
        elif kind == b"IDAT":
            packed += body
        at += length + 12
    channels = {0: 1, 2: 3, 6: 4}[colour]
    pixel = channels * bits // 8
    raw, stride, before, rows = zlib.decompress(packed), pixel * width, bytes(pixel * width), []
    for y in range(height):
        kind, line = raw[y * (stride + 1)], bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            a = line[i - pixel] if i >= pixel else 0
            b, c = before[i], before[i - pixel] if i >= pixel else 0
            line[i] = line[i] + (0, a, b, (a + b) // 2, paeth(a, b, c))[kind] & 255
        rows.append(bytes(line))
        before = line
    everything = b"".join(rows)
    numbers = struct.unpack(f">{len(everything) // 2}H", everything) if bits == 16 else everything
    return width, height, channels, numbers


def paeth(a, b, c):
    return min((abs(b - c), 0, a), (abs(a - c), 1, b), (abs(a + b - 2 * c), 2, c))[2]


class Bake:
    """A bake's files, as docs/bakes.md tells of them."""

    closed = False  # whether the path's first step comes after its last

    def __init__(self, folder):
        self.json = json.loads((folder / "bake.json").read_text(encoding="utf-8"))
        self.path = self.json["path"]
        self.steps = len(self.path["to_light_ws"])
        self.pages = []
        for p, page in enumerate(self.json["pages"]):
            pairs = [tuple(png(folder / f"page{p}-{what}{pair}.png")[3] for what in ("rise", "fall"))
                     for pair in range(page["pairs"])]
            self.pages.append((page["side_texels"], pairs))

    def intervals(self, page, x, y):
        """(rise, fall) of a texel, in steps."""
        side, pairs = self.pages[page]
        first = LANES * (y * side + x)
        lanes = [(rises[first + i], falls[first + i]) for rises, falls in pairs for i in range(LANES)]
        return [(r / self.json["codes_per_step"], f / self.json["codes_per_step"]) for r, f in lanes if f > r]

    def clock_s(self, step):
        return self.path["begin_s"] + step / self.steps * (self.path["end_s"] - self.path["begin_s"])

    def step(self, time_s):
        return (time_s - self.path["begin_s"]) / (self.path["end_s"] - self.path["begin_s"]) * self.steps

    def width_steps(self):
        """Of the sun's disc on its path; at least one code."""
        d = self.path["to_light_ws"]
        step_rad = sum(2 * math.asin(math.dist(a, b) / 2) for a, b in zip(d, d[1:])) / (self.steps - 1)
        return max(1 / self.json["codes_per_step"], self.path["angular_diameter_rad"] / step_rad)

    def visibility(self, page, x, y, time_s):
        """The part of the disc, cut where an interval begins and ends."""
        def before(time):
            c = min(max((time - self.step(time_s)) / (self.width_steps() / 2), -1), 1)
            return 0.5 + (c * math.sqrt(1 - c * c) + math.asin(c)) / math.pi
        laps = (-self.steps, 0, self.steps) if self.closed else (0,)
        return min(1, sum(before(f + lap) - before(r + lap)
                          for r, f in self.intervals(page, x, y) for lap in laps))


def clock(time_s, seconds=False):
    minutes = math.floor(time_s / 60 + 0.5) % 1440
    if not seconds:
        return f"{minutes // 60:02}:{minutes % 60:02}"
    rest = math.floor(time_s + 0.5) % 86400
    return f"{rest // 3600:02}:{rest // 60 % 60:02}:{rest % 60:02}"


class Quiet(http.server.SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


def visit(site, folder):
    """What tests/web_drive.mjs sees of the page in `site`."""
    def handler(*args):
        return Quiet(*args, directory=str(site))
    with http.server.ThreadingHTTPServer(("127.0.0.1", 0), handler) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        url = f"http://127.0.0.1:{server.server_port}/"
        result = subprocess.run(["node", DRIVE, PACKAGES, CHROMIUM, url, folder], text=True, timeout=TIMEOUT_S,
                                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
        server.shutdown()
    if result.returncode != 0:
        raise AssertionError(result.stdout)
    return {**json.loads((folder / "seen.json").read_text(encoding="utf-8")), "url": url}


def require_browser():
    if not (PACKAGES / "node_modules/playwright-core").is_dir():
        raise unittest.SkipTest("the build has no playwright-core: node, npm or their registry was missing")
    if "built without its page" in gnomon("web", "none", "-o", "none", ok=False).stderr:
        raise unittest.SkipTest("gnomon web is left out of this build")
    if not CHROMIUM:
        raise unittest.SkipTest("chromium is not installed")


class Page(unittest.TestCase):
    """The page of the cube, whose shadow falls on a plane, as 8 bits hold it."""
    BITS = 8

    @classmethod
    def setUpClass(cls):
        require_browser()
        temporary = tempfile.TemporaryDirectory()
        cls.addClassCleanup(temporary.cleanup)
        cls.folder = pathlib.Path(temporary.name)
        gnomon("bake", "cube", "--sun", SUN, "--bits", cls.BITS, "-o", cls.folder / "bake")
        gnomon("web", cls.folder / "bake", "--title", TITLE, "-o", cls.folder / "page")
        cls.bake = Bake(cls.folder / "bake")
        cls.seen = visit(cls.folder / "page", cls.folder)
        # What follows needs a page that works.
        assert not cls.seen["messages"], cls.seen["messages"]

    def test_asks_no_other_server(self):
        for url in self.seen["requests"]:
            self.assertTrue(url.startswith((self.seen["url"], f"blob:{self.seen['url']}")), url)

    def test_tells_title_place_and_date(self):
        self.assertEqual(self.seen["title"], TITLE)
        for words in (TITLE, "48.137° N, 11.575° E", "21 June 2026"):
            self.assertIn(words, self.seen["heading"])

    def test_tells_the_clocks_offset(self):
        self.assertEqual(self.seen["zone"], "UTC+01:00")

    def test_shader_has_the_bakes_visibility(self):
        # GLSL ES lets asin err by 2^-11, twice in a difference, over pi; half a grey level of 8 bits
        # is more than that and less than can be seen.
        most = 0.5 / 255
        partly, truths = 0, {}
        for image in self.seen["visibility"]:
            side = self.bake.pages[image["index"]][0]
            which = image["index"], image["time_s"]
            if which not in truths:
                truths[which] = [self.bake.visibility(image["index"], i % side, i // side, image["time_s"])
                                 for i in range(side * side)]
                partly += sum(0.01 < v < 0.99 for v in truths[which])
            truth = truths[which]
            if image["shift"]:  # the mean of what four texels see, not what their mean times would
                last = side - 1
                truth = [sum(truth[min(i // side + b, last) * side + min(i % side + a, last)]
                             for a in (0, 1) for b in (0, 1)) / 4 for i in range(side * side)]
            error = max(abs(a - b) for a, b in zip(truth, image["values"]))
            self.assertLess(error, most, (image["time_s"], image["shift"]))
        self.assertGreater(partly, 10)  # there are soft edges to get wrong

    def around(self, point, time_s):
        """0 or 1 where a texel and its neighbours all see so much of the sun, else None."""
        side = self.bake.pages[point["page"]][0]
        values = {round(self.bake.visibility(point["page"], x, y, time_s), 3)
                  for x in range(max(point["x"] - 1, 0), min(point["x"] + 2, side))
                  for y in range(max(point["y"] - 1, 0), min(point["y"] + 2, side))}
        return values.pop() if values in ({0.0}, {1.0}) else None

    def test_slider_moves_the_shadow(self):
        first, later = (png(self.folder / f"{name}.png") for name in ("morning", "later"))
        width, _, channels, _ = first
        turned = stayed = 0
        for point in self.seen["points"]:
            if not 80 < point["y_px"] < 600:
                continue  # beneath the panels
            at = channels * (point["y_px"] * width + point["x_px"])
            change = sum(first[3][at:at + 3]) - sum(later[3][at:at + 3])
            # Nor at an edge, where the picture mixes texels.
            was, now = (self.around(point, t) for t in self.seen["times_s"])
            if was is None or now is None:
                continue
            # Sun is the larger part of the light here: a tenth of white in each of three channels tells
            # sun from shade. What keeps its sun gets brighter by far less as the sun climbs 10 degrees.
            most = 76
            if was != now:
                self.assertGreater(change if was > now else -change, most, point)
                turned += 1
            else:
                self.assertLess(abs(change), most, point)
                stayed += 1
        self.assertGreater(turned, 3)
        self.assertGreater(stayed, 3)

    def test_points_are_where_rays_say(self):
        # The page has the file's camera. Where rays find shadow, and for 8 pixels around, which are
        # more than a texel, the texel that the page names must be dark.
        time_s = self.seen["times_s"][0]
        x, y, z = self.bake.path["to_light_ws"][int(self.bake.step(time_s))]
        light = f"sun:elevation={math.degrees(math.asin(y))},azimuth={math.degrees(math.atan2(x, -z)) % 360}"
        out = self.folder / "traced.png"
        gnomon("render", self.folder / "page/scene.glb", "--light", light, "--samples", 16, "--size", "1280x720", "-o", out)
        gnomon("render", self.folder / "page/scene.glb", "--light", light, "--technique", "local_illumination",
               "--size", "1280x720", "-o", self.folder / "bare.png")
        traced, bare = png(out), png(self.folder / "bare.png")
        width, height, channels, _ = traced

        def shadow(px, py):  # what a shadow takes away, 0 to 1 or so
            at = channels * (py * width + px)
            return 1 - sum(traced[3][at:at + 3]) / max(1, sum(bare[3][at:at + 3]))
        dark = lit = 0
        for point in self.seen["points"]:
            around = [shadow(min(max(point["x_px"] + a, 0), width - 1), min(max(point["y_px"] + b, 0), height - 1))
                      for a in (-8, 0, 8) for b in (-8, 0, 8)]
            visibility = self.bake.visibility(point["page"], point["x"], point["y"], time_s)
            if min(around) > 0.2:
                self.assertLess(visibility, 0.1, point)
                dark += 1
            elif max(around) < 0.02 and visibility > 0.9:
                lit += 1
        self.assertGreater(dark, 5)
        self.assertGreater(lit, 50)  # a map read at wrong places would hardly be dark where it must be

    def test_probe_tells_rise_fall_and_hours(self):
        told = 0
        for click in self.seen["clicks"]:
            spans = [tuple(map(self.bake.clock_s, i)) for i in self.bake.intervals(click["page"], click["x"], click["y"])]
            self.assertFalse(click["hidden"])
            exact = self.BITS == 16  # whose times are as fine as a second
            self.assertEqual(click["intervals"], [f"{clock(r, exact)} – {clock(f, exact)}" for r, f in spans], click)
            unit_s = 1 if exact else 60
            units = math.floor(sum(f - r for r, f in spans) / unit_s + 0.5)
            numbers = [int(n) for n in re.findall(r"\d+", click["total"])]
            if not spans:
                self.assertEqual(click["total"], "No sun all day")
                continue
            told += 1
            parts = (units // 3600, units // 60 % 60, units % 60) if exact else (units // 60, units % 60)
            wanted = [n for n in parts if n]
            self.assertEqual(numbers, wanted, click)
        self.assertGreater(told, 3)

    def test_keys(self):
        keys = self.seen["keys"]
        self.assertTrue(keys["start"]["probe"])
        self.assertFalse(keys["escape"]["probe"])
        self.assertEqual(keys["right"]["time_s"] - keys["start"]["time_s"], 300)
        self.assertEqual(keys["left"]["time_s"], keys["start"]["time_s"])
        self.assertEqual(keys["right"]["clock"], clock(keys["right"]["time_s"]))
        self.assertEqual([keys[k]["hours"] for k in ("left", "hours", "lit")], [False, True, False])
        self.assertEqual([keys[k]["playing"] for k in ("lit", "play", "pause")], [False, True, False])
        self.assertNotEqual(keys["pause"]["time_s"], keys["lit"]["time_s"])
        self.assertTrue(keys["middle"]["probe"])

    def test_keys_turn_the_camera(self):
        keys = self.seen["keys"]

        def change(key, before, what):
            return keys[key][what] - keys[before][what]
        self.assertAlmostEqual(change("Shift+ArrowLeft", "middle", "azimuth_deg"), -5, places=6)
        self.assertAlmostEqual(change("Shift+ArrowRight", "middle", "azimuth_deg"), 0, places=6)
        self.assertAlmostEqual(change("Shift+ArrowUp", "middle", "polar_deg"), -5, places=6)
        self.assertAlmostEqual(change("Shift+ArrowDown", "middle", "polar_deg"), 0, places=6)
        self.assertAlmostEqual(change("+", "middle", "distance_m") / keys["middle"]["distance_m"], -0.1, places=6)
        self.assertAlmostEqual(change("-", "middle", "distance_m"), 0, places=6)
        self.assertEqual({keys[key]["time_s"] for key in keys if "+" in key or key == "-"},
                         {keys["middle"]["time_s"]})
        self.assertNotEqual(png(self.folder / "turned.png")[3], png(self.folder / "later.png")[3])

    def test_fits_a_phone(self):
        self.assertFalse(self.seen["phone"]["scrolls"])
        boxes = {box["id"]: box for box in self.seen["phone"]["boxes"]}
        for box in boxes.values():
            self.assertTrue(0 <= box["left"] < box["right"] <= PHONE_PX, box)
        for upper, lower in (("title", "legend"), ("legend", "probe"), ("probe", "controls")):
            self.assertLessEqual(boxes[upper]["bottom"], boxes[lower]["top"], (upper, lower))
        for name in ("play", "hours"):  # a finger's width
            self.assertGreaterEqual(boxes[name]["bottom"] - boxes[name]["top"], 44, name)


class Page16(Page):
    """The same in 16 bits, whose codes are a 64th of a step."""
    BITS = 16


class PolarDay(unittest.TestCase):
    """24 hours of sun, whose end is its begin, and where no point has more than 11 of them."""

    def test_lit_ends_and_even_ticks(self):
        require_browser()
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            gnomon("bake", "cube", "--sun", "place=90,0,date=2026-06-21", "--texel", "0.25", "-o", folder / "bake")
            gnomon("web", folder / "bake", "-o", folder / "page")
            bake = Bake(folder / "bake")
            bake.closed = True
            facts = json.loads((folder / "page/web.json").read_text(encoding="utf-8"))
            facts["most_sun_s"] = 10.2 * 3600
            (folder / "page/web.json").write_text(json.dumps(facts), encoding="utf-8")
            seen = visit(folder / "page", folder)
        self.assertEqual([text for text, _ in seen["ticks"]], ["0", "3", "6", "9 h"])
        for text, left in seen["ticks"]:
            self.assertAlmostEqual(float(left.rstrip("%")), 100 * int(text.split()[0]) / 11, places=2)
        ends = [image for image in seen["visibility"]
                if image["time_s"] in (bake.path["begin_s"], bake.path["end_s"]) and not image["shift"]]
        self.assertEqual(len(ends), 2 * len(bake.pages))
        for image in ends:
            side = bake.pages[image["index"]][0]
            truth = [bake.visibility(image["index"], i % side, i // side, image["time_s"]) for i in range(side * side)]
            self.assertEqual(max(truth), 1)
            self.assertLess(max(abs(a - b) for a, b in zip(truth, image["values"])), 0.5 / 255)


class Files(unittest.TestCase):
    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        gnomon("bake", "cube", "--sun", SUN, "--texel", "0.5", "-o", self.folder / "bake")

    def web(self, *args):
        return gnomon("web", *args, ok=False)

    def require_page(self):
        result = self.web(self.folder / "bake", "-o", self.folder / "page")
        if "built without its page" in result.stderr:
            self.assertEqual(result.returncode, 1)
            self.assertEqual(result.stderr.count("\n"), 1)
            self.skipTest("gnomon web is left out of this build: node, npm or their registry was missing")
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_replaces_a_page_and_nothing_else(self):
        self.require_page()
        files = sorted(path.name for path in (self.folder / "page").iterdir())
        self.assertEqual(files, ["app.js", "index.html", "page0.bin", "scene.glb", "style.css", "web.json"])
        self.require_page()
        note = self.folder / "page/note.txt"
        note.write_text("mine", encoding="utf-8")
        result = self.web(self.folder / "bake", "-o", self.folder / "page")
        self.assertEqual(result.returncode, 2)
        self.assertIn('"note.txt"', result.stderr)
        self.assertEqual(note.read_text(encoding="utf-8"), "mine")
        self.assertEqual(self.web(self.folder / "bake", "-o", self.folder / "bake").returncode, 2)

    def test_damaged_bake_is_one_line_and_leaves_nothing(self):
        self.require_page()
        (self.folder / "bake/page0-rise0.png").write_bytes(b"no picture")
        result = self.web(self.folder / "bake", "-o", self.folder / "other")
        self.assertEqual((result.returncode, result.stderr.count("\n")), (2, 1), result.stderr)
        self.assertIn("page0-rise0.png", result.stderr)
        self.assertFalse((self.folder / "other").exists())


if __name__ == "__main__":
    unittest.main()
