#!/usr/bin/env python3
"""`gnomon web` in a real browser: what its page draws and tells against what `gnomon render` sees of the same bake,
the numbers of its files, read here anew, and rays. tests/web_drive.mjs visits the page. GNOMON_CLI is the path of the program."""

import functools
import http.server
import itertools
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


def exr(path):
    """(width, height, numbers) of an EXR of one channel of floats, zipped, rows from the top."""
    data = path.read_bytes()
    at, attributes = 8, {}
    while data[at]:
        name, kind = data[at:at + 256].split(b"\0")[:2]
        at += len(name) + len(kind) + 2
        size, = struct.unpack_from("<i", data, at)
        attributes[name] = data[at + 4:at + 4 + size]
        at += 4 + size
    zipped_rows = {2: 1, 3: 16}[attributes[b"compression"][0]]
    x0, y0, x1, y1 = struct.unpack("<4i", attributes[b"dataWindow"])
    width, height = x1 - x0 + 1, y1 - y0 + 1
    numbers = []
    at += 1 + 8 * -(-height // zipped_rows)
    for first in range(0, height, zipped_rows):
        size = 4 * width * min(zipped_rows, height - first)
        length, = struct.unpack_from("<i", data, at + 4)
        block = data[at + 8:at + 8 + length]
        at += 8 + length
        if length < size:  # else it did not shrink and is as it is
            block = unshuffled(zlib.decompress(block))
        numbers += struct.unpack(f"<{size // 4}f", block)
    return width, height, numbers


def unshuffled(packed):
    """Differences of bytes, even ones first, as they were."""
    sums = bytes((total - 128 * i) & 255 for i, total in enumerate(itertools.accumulate(packed)))
    half = (len(sums) + 1) // 2
    result = bytearray(len(sums))
    result[::2], result[1::2] = sums[:half], sums[half:]
    return bytes(result)


class Bake:
    """A bake's files, as docs/bakes.md tells of them."""

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

    def sees_center(self, page, x, y, time_s):
        """Whether a texel sees the middle of the sun."""
        return any(r <= self.step(time_s) < f for r, f in self.intervals(page, x, y))


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


@functools.cache
def library(folder, time_s):
    """(width, height, visibility) of the bake in `folder` as `gnomon render` sees it at a time of its path, with
    the file's camera, which is the page's too."""
    milliseconds = round(time_s * 1000)
    time = f"{milliseconds // 3600000:02}:{milliseconds // 60000 % 60:02}:{milliseconds / 1000 % 60:06.3f}"
    out = folder / "library.exr"
    gnomon("render", folder / "bake", "--time", time, "--size", "1280x720", "-o", folder / "library.png",
           "--visibility", out, "--occlusion_interval_maps.lookup", "interpolated")
    return exr(out)


# GLSL ES lets asin err by 2^-11, twice in a difference, over pi; half a grey level of 8 bits is more than that and
# less than can be seen.
TOLERANCE = 0.5 / 255
# Of all pixels, on borders of triangles: either program may give one to either.
MOST_BESIDE = 1e-4


def expect_same(test, expected, folder, picture):
    """The page's visibility of each pixel is the library's."""
    data = (folder / picture["file"]).read_bytes()
    width, height = 1280, 720
    words = struct.unpack(f"<{2 * width * height}H", data)  # value, and whether there is one
    test.assertEqual(len(expected), width * height)
    beside = 0
    for y in range(height):
        first = 2 * width * (height - 1 - y)
        row = words[first:first + 2 * width]
        found = [value / 65535 if there else 1.0 for value, there in zip(row[::2], row[1::2])]
        beside += sum(abs(a - b) > TOLERANCE for a, b in zip(found, expected[y * width:(y + 1) * width]))
    test.assertLessEqual(beside / (width * height), MOST_BESIDE, picture)


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

    def test_shader_sees_what_the_library_sees(self):
        soft = 0
        for picture in self.seen["visibility"]:
            _, _, expected = library(self.folder, picture["time_s"])
            expect_same(self, expected, self.folder, picture)
            soft += sum(0.01 < v < 0.99 for v in expected)
        self.assertGreater(soft, 1000)  # there are soft edges to get wrong

    def test_slider_moves_the_shadow(self):
        # The canvas mixes what is next to each other: points count all around which the library sees
        # as much of the sun, all or nothing.
        first, later = (png(self.folder / f"{name}.png") for name in ("morning", "later"))
        before, after = (library(self.folder, time_s) for time_s in self.seen["times_s"])
        width, _, channels, _ = first

        def around(picture, point):
            values = {round(picture[2][(point["y_px"] + b) * width + point["x_px"] + a], 3)
                      for a in (-2, 0, 2) for b in (-2, 0, 2)}
            return values.pop() if values in ({0.0}, {1.0}) else None
        turned = stayed = 0
        for point in self.seen["points"]:
            if not 80 < point["y_px"] < 600:
                continue  # beneath the panels
            at = channels * (point["y_px"] * width + point["x_px"])
            change = sum(first[3][at:at + 3]) - sum(later[3][at:at + 3])
            was, now = around(before, point), around(after, point)
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
            sunny = self.bake.sees_center(point["page"], point["x"], point["y"], time_s)
            if min(around) > 0.2:
                self.assertFalse(sunny, point)
                dark += 1
            elif max(around) < 0.02 and sunny:
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
            # Turned, so that no wall is edge-on to the sun at midnight, where rounding would tell whether it is lit.
            gnomon("bake", "cube", "--sun", "place=90,0,date=2026-06-21,north=20", "--texel", "0.25", "-o", folder / "bake")
            gnomon("web", folder / "bake", "-o", folder / "page")
            facts = json.loads((folder / "page/web.json").read_text(encoding="utf-8"))
            facts["most_sun_s"] = 10.2 * 3600
            (folder / "page/web.json").write_text(json.dumps(facts), encoding="utf-8")
            seen = visit(folder / "page", folder)
            ends = [picture for picture in seen["visibility"]
                    if picture["time_s"] in (facts["begin_s"], facts["end_s"])]
            self.assertEqual(len(ends), 2)
            for picture in ends:
                _, _, expected = library(folder, picture["time_s"])
                self.assertIn(1.0, expected)
                expect_same(self, expected, folder, picture)
        self.assertEqual([text for text, _ in seen["ticks"]], ["0", "3", "6", "9 h"])
        for text, left in seen["ticks"]:
            self.assertAlmostEqual(float(left.rstrip("%")), 100 * int(text.split()[0]) / 11, places=2)


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
