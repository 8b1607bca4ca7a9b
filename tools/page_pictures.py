#!/usr/bin/env python3
"""Makes docs/images, the pictures of the README and of the techniques' pages, by running the program: crops,
side by side. Run it again, and look at the pictures, when a technique's pictures change. Needs Pillow.

    tools/page_pictures.py [GNOMON [PICTURE...]]

GNOMON: the built program; else $GNOMON_CLI, else build/release/apps/cli/gnomon. PICTURE: else all.
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

from PIL import Image

ROOT = pathlib.Path(__file__).resolve().parent.parent
CLI = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else
                   os.environ.get("GNOMON_CLI") or ROOT / "build/release/apps/cli/gnomon")
GAP_PX = 6
WEB_PORT = 8765
WEB_SIZE = (960, 540)
COLOURS = 256  # of a picture's palette, so that a file stays small

RECT = "--light rect:center=1.5,3,1,u=0.5,0,0,v=0,0,0.5"
NEAR = "--light point:position=0.2,1.3,0.1"
MAP = "--technique shadow_map"
NO_BIAS = ("--shadow_map.receiver_plane false --shadow_map.bias_constant 0 --shadow_map.bias_slope 0 "
           "--shadow_map.normal_offset 0 --shadow_map.caster_error 0")
BLURRED = "--technique blurred_projection --blurred_projection.blur 8"
FINE = "--shadow_map.map_size 4096"
INTERVALS = "--technique occlusion_interval_maps"
CHAPTER_13 = ("--occlusion_interval_maps.lookup nearest --occlusion_interval_maps.weight even "
              "--occlusion_interval_maps.bits 8")
VERTEX = "--technique vertex_occlusion"
COARSE_FACES = "--omni.map_size 128 --omni.filter nearest --omni.fit whole"
ON_GROUND = "--light point:position=0,0.02,0 --ambient 0 --exposure 4000"  # by which the ground's light can be seen
AUTO_GPU = "--technique auto --auto.device gpu"
LOW = "courtyard --light sun:elevation=25,azimuth=120"
STEEP = "courtyard --light sun:elevation=80,azimuth=30"
TREE_BEHIND = "--camera eye=-9,1.8,50,target=-8,0.8,38 --light sun:elevation=20,azimuth=180"

# Picture: size to render, crop (left, top, right, bottom) in px, panels in a row, and what each panel shows.
PICTURES = {
    "local_illumination": ("640x360", (0, 40, 640, 330), 2, [
        "courtyard --technique local_illumination", "courtyard"]),
    "ray_traced-samples": ("960x540", (250, 130, 650, 380), 3, [
        f"cube {RECT} --technique ray_traced --ray_traced.samples {samples}" for samples in (1, 16, 256)]),
    "shadow_map-parameters": ("1920x1080", (1400, 560, 1880, 860), 2, [
        f"courtyard {MAP} {NO_BIAS}", f"courtyard {MAP}",
        f"courtyard {MAP} --shadow_map.bias_constant 30", f"courtyard {MAP} --shadow_map.map_size 256"]),
    "shadow_map-far": ("1280x720", (440, 300, 760, 460), 2, ["field-small", f"field-small {MAP}"]),
    "shadow_map-plane": ("1280x720", (0, 160, 520, 360), 3, [
        STEEP, f"{STEEP} {MAP} --shadow_map.receiver_plane false", f"{STEEP} {MAP}"]),
    "shadow_map-pcss": ("1280x720", (460, 350, 760, 500), 3, [
        "courtyard", f"courtyard {MAP} {FINE} --shadow_map.filter box_3x3",
        f"courtyard {MAP} {FINE} --shadow_map.filter pcss --shadow_map.filter_taps 32"]),
    "shadow_map-contents": ("1280x720", (820, 340, 1120, 490), 2, [
        LOW] + [f"{LOW} {MAP} --shadow_map.light_bleeding 0 --shadow_map.blur 6 --shadow_map.content {content}"
                for content in ("variance", "exponential_variance", "moments")]),
    "object_id": ("1280x720", (470, 330, 710, 450), 3, ["field-small"] + [
        f"field-small --technique object_id --object_id.map_size 1024 --object_id.compare {compare}"
        for compare in ("ids", "ids_and_depths")]),
    "object_id-fails": ("1280x720", (480, 120, 960, 420), 2, ["courtyard", "courtyard --technique object_id"]),
    "blurred_projection": ("1280x720", (560, 380, 900, 500), 3, [
        "courtyard", f"courtyard {BLURRED}", f"courtyard {MAP} --shadow_map.content variance --shadow_map.blur 8"]),
    "blurred_projection-self": ("1280x720", (630, 440, 850, 550), 2, ["courtyard", f"courtyard {BLURRED}"]),
    "blurred_projection-fails": ("1280x720", (480, 370, 1040, 480), 1, ["field-small", f"field-small {BLURRED}"]),
    "omni": ("640x360", (0, 60, 640, 340), 2, [
        "jack-o-lantern", "jack-o-lantern --technique omni"] + [
        f"jack-o-lantern --technique omni {COARSE_FACES} --omni.projection {body}"
        for body in ("cube", "tetrahedral")]),
    "omni-bias": ("640x360", (200, 90, 620, 290), 3, [
        f"torches --lights 0{technique}"
        for technique in ("", f" --technique omni {NO_BIAS.replace('shadow_map', 'omni')}", " --technique omni")]),
    "dual_paraboloid": ("640x360", (60, 60, 580, 360), 3, [
        f"cube {NEAR}", f"cube {NEAR} --technique dual_paraboloid",
        f"cube {NEAR} --technique dual_paraboloid --dual_paraboloid.subdivide false"]),
    "dual_paraboloid-fails": ("1280x720", (220, 430, 660, 720), 3, [
        f"courtyard {ON_GROUND}{technique}"
        for technique in ("", " --technique dual_paraboloid", " --technique omni")]),
    "psm-suns": ("1280x720", (470, 300, 710, 440), 4, [
        f"field-small --light sun:{light}{technique}"
        for light in ("elevation=85,azimuth=0", "elevation=30,azimuth=180", "elevation=30,azimuth=90", "elevation=30,azimuth=0")
        for technique in ("", f" {MAP}", " --technique psm", " --technique psm --psm.map cube")]),
    "psm-choices": ("1280x720", (470, 300, 710, 440), 4, [
        f"field-small --light sun:{light} --technique psm{choice}"
        for light in ("elevation=85,azimuth=0", "elevation=30,azimuth=180", "elevation=30,azimuth=90", "elevation=30,azimuth=0")
        for choice in ("", " --psm.unit_cube_clipping false", " --psm.virtual_camera slide_back",
                       " --psm.virtual_camera none")]),
    "psm-infinity": ("640x360", (0, 60, 640, 360), 2, [
        f"field-small {TREE_BEHIND}{technique}"
        for technique in ("", " --technique psm --psm.virtual_camera none --psm.beyond_infinity false",
                          " --technique psm --psm.virtual_camera slide_back --psm.beyond_infinity false",
                          " --technique psm --psm.virtual_camera none")]),
    "psm-near": ("1280x720", (0, 380, 480, 620), 2, [
        f"courtyard --technique psm --psm.virtual_camera {camera}" for camera in ("none", "near_quad")]),
    "pssm": ("1280x720", (440, 300, 760, 460), 3, [
        "field-small", f"field-small {MAP}", "field-small --technique pssm"]),
    "pssm-splits": ("1280x720", (480, 280, 960, 440), 2, [
        f"field-large --technique pssm --pssm.splits {splits}" for splits in (1, 2, 4)] + [
        "field-large --technique pssm --pssm.fit stable"]),
    "pssm-step": ("1920x1080", (280, 860, 600, 1060), 3, ["courtyard"] + [
        f"courtyard --technique pssm --pssm.map_size 512 --pssm.split_lambda 1 --pssm.split_blend {blend}"
        for blend in (0, 0.3)]),
    "pssm-wires": ("1280x720", (0, 450, 420, 650), 3, ["gas-station"] + [
        f"gas-station --technique pssm --pssm.map_size {size}" for size in (2048, 512)]),
    "lispsm": ("1280x720", (480, 200, 960, 440), 3, [
        "field-large", f"field-large {MAP}", "field-large --technique lispsm"]),
    "lispsm-fails": ("1280x720", (580, 300, 900, 460), 3, [
        "gas-station", f"gas-station {MAP} --shadow_map.map_size 512",
        "gas-station --technique lispsm --lispsm.map_size 512"]),
    "tsm-focus": ("1280x720", (480, 200, 960, 440), 2, ["field-large"] + [
        f"field-large --technique tsm --tsm.focus {focus}" for focus in (0.1, 0.4, 0.7)]),
    "shadow_volumes-alpha": ("1280x720", (520, 380, 920, 560), 3, [
        "courtyard", "courtyard --technique shadow_volumes", "courtyard --ignore-alpha"]),
    "shadow_volumes-hard": ("1280x720", (0, 430, 480, 670), 2, [
        "gas-station", "gas-station --technique shadow_volumes"]),
    "occlusion_interval_maps": ("1280x720", (380, 300, 900, 540), 2, ["gas-station"] + [
        f"gas-station {INTERVALS} {lookup}" for lookup in (
            CHAPTER_13, "--occlusion_interval_maps.lookup interpolated", "")]),
    "vertex_occlusion": ("1280x720", (200, 340, 860, 580), 2, ["courtyard"] + [
        f"courtyard {VERTEX} --vertex_occlusion.tessellate {edge_m}" for edge_m in (0, 0.3, 0.03)]),
    "vertex_occlusion-walls": ("1280x720", (620, 440, 860, 560), 3, ["courtyard"] + [
        f"courtyard {VERTEX} --vertex_occlusion.tessellate 0.3 --vertex_occlusion.walls {walls}"
        for walls in ("false", "true")]),
    "vertex_occlusion-averaged": ("1280x720", (0, 130, 440, 510), 3, ["torches"] + [
        f"torches --lighting {lighting} --vertex_occlusion.tessellate 0.3" for lighting in ("vertex_flat", "vertex")]),
    "auto": ("1280x720", (0, 450, 420, 650), 3, [
        "gas-station", f"gas-station {AUTO_GPU}", "gas-station --technique pssm"]),
    "auto-fails": ("1920x1080", (1130, 500, 1330, 640), 3, [
        "gas-station", f"gas-station {AUTO_GPU}",
        "gas-station --technique pssm --pssm.filter pcss --pssm.splits 6 --pssm.map_size 4096"]),
}

# Of a report: where the two techniques are beside the truth.
REPORT_SIZE, REPORT_CROP = "800x450", (320, 6, 600, 344)
REPORT_PANELS = ("truth-picture", "shadow_map-picture", "shadow_volumes-picture",
                 "shadow_map-difference", "shadow_volumes-difference")

# Hours of sun, as docs/sun_hours.md tells them.
SUN_HOURS = ("--place", "48.137,11.575", "--date", "2026-03-20", "--at-least", "4", "--texel", "0.04",
             "--size", "800x520")


def gnomon(*words):
    subprocess.run([CLI, *words, "--quiet"], check=True, stdout=subprocess.DEVNULL)


def save(name, panels, columns):
    """Panels of one size in rows, white between them."""
    width, height = panels[0].size
    rows = -(-len(panels) // columns)
    sheet = Image.new("RGB", (columns * (width + GAP_PX) - GAP_PX, rows * (height + GAP_PX) - GAP_PX), "white")
    for i, panel in enumerate(panels):
        sheet.paste(panel, (i % columns * (width + GAP_PX), i // columns * (height + GAP_PX)))
    path = ROOT / "docs" / "images" / f"{name}.png"
    sheet.quantize(COLOURS, dither=Image.Dither.NONE).save(path, optimize=True)
    print(f"{path.relative_to(ROOT)}: {sheet.width}x{sheet.height}, {path.stat().st_size // 1024} KiB")


def cropped(path, crop):
    with Image.open(path) as image:
        return image.convert("RGB").crop(crop)


def web_picture(folder):
    """The page of gnomon web, as tests/web_drive.mjs photographs it; needs node, its packages and Chromium."""
    gnomon("bake", "courtyard", "--sun", "place=48.137,11.575,date=2026-06-21", "--texel", "0.05", "-o", f"{folder}/day")
    gnomon("web", f"{folder}/day", "--title", "Courtyard", "-o", f"{folder}/page")
    server = subprocess.Popen([sys.executable, "-m", "http.server", str(WEB_PORT), "--directory", f"{folder}/page"],
                              stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        time.sleep(1)  # for the server to listen
        packages = CLI.resolve().parents[2] / "web"
        subprocess.run(["node", ROOT / "tests/web_drive.mjs", packages, shutil.which("chromium"),
                        f"http://localhost:{WEB_PORT}/", folder, "picture"], check=True)
    finally:
        server.terminate()
    with Image.open(f"{folder}/web.png") as image:
        save("web", [image.convert("RGB").resize(WEB_SIZE, Image.LANCZOS)], 1)


def bump_picture(folder):
    """What no scene has, a bump map: bench/bump_light draws it."""
    program = CLI.resolve().parents[2] / "bench/bump_light"
    subprocess.run([program, f"{folder}/bumps.png"], check=True, stdout=subprocess.DEVNULL)
    with Image.open(f"{folder}/bumps.png") as image:
        side = image.height
        save("vertex_occlusion-bumps", [image.convert("RGB").crop((i * side, 0, (i + 1) * side, side))
                                        for i in range(image.width // side)], 3)


def main():
    (ROOT / "docs" / "images").mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        frame = f"{folder}/frame.png"
        wanted = sys.argv[2:] or [*PICTURES, "vertex_occlusion-bumps", "sun_hours", "compare", "web"]
        for name, (size, crop, columns, commands) in PICTURES.items():
            if name not in wanted:
                continue
            panels = []
            for command in commands:
                truth = [] if "--technique" in command or "--lighting" in command else ["--samples", "256"]
                gnomon("render", *command.split(), *truth, "-o", frame, "--size", size)
                panels.append(cropped(frame, crop))
            save(name, panels, columns)
        if "vertex_occlusion-bumps" in wanted:
            bump_picture(folder)
        if "sun_hours" in wanted:
            gnomon("sun", "courtyard", "-o", f"{folder}/hours", *SUN_HOURS)
            with Image.open(f"{folder}/hours/view.png") as image:
                save("sun_hours", [image.convert("RGB")], 1)
        if "web" in wanted:
            web_picture(folder)
        if "compare" not in wanted:
            return
        gnomon("compare", "courtyard", "-o", f"{folder}/report", "--size", REPORT_SIZE,
               "--techniques", "shadow_map,shadow_volumes", "--frames", "1")
        save("compare", [cropped(f"{folder}/report/images/sun/{panel}.png", REPORT_CROP)
                         for panel in REPORT_PANELS], len(REPORT_PANELS))


if __name__ == "__main__":
    main()
