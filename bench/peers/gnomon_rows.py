#!/usr/bin/env python3
"""Gnomon's rows for a comparison of shadows in rendering engines.

The folder of the comparison (--peers) holds common/gen_scene.cpp, which writes small.gltf and large.gltf;
common/scene.hpp, whose calibrate() tells how quiet the machine is; scenes/NAME.json with camera and sun; and
results/results.csv with the engines' rows. Each technique is timed by `gnomon bench` at the same camera, sun and
size on one core with one thread, as the engines were. Prints

    RESULT,name,scene,config,W,H,median,min,p90,frames,cpu,mem

a run (milliseconds; p90 is the maximum here, which is what `gnomon bench` tells; cpu and mem are the calibration
loops), then a table. Gnomon's figure is what it adds to a frame that has its depth buffer: map and look-up; it is
the median times the share of the core that the process got, and the share is told. The engines' are whole frames;
beside them in brackets stands what shadows add, the frame without them subtracted. Of repeated runs the one with
the lowest figure counts, for gnomon and for the engines.
"""
import argparse
import csv
import json
import math
import os
import pathlib
import resource
import subprocess
import sys
import tempfile
import time

SCENES = ("small", "large")
CONFIGS = {
    "shadow_map-2048": ["--techniques", "shadow_map", "--shadow_map.map_size", "2048"],
    "shadow_map-2048-2x2": ["--techniques", "shadow_map", "--shadow_map.map_size", "2048",
                            "--shadow_map.filter", "hardware_2x2"],
    "lispsm-2048": ["--techniques", "lispsm"],
    "pssm-4-2048": ["--techniques", "pssm"],
    "pssm-4-2048-2x2": ["--techniques", "pssm", "--pssm.filter", "hardware_2x2"],
    "local_illumination": ["--techniques", "local_illumination"],
    "shadow_volumes": ["--techniques", "shadow_volumes"],
    "ray_traced": ["--techniques", "ray_traced"],
}
SLOW_FRAME_MS = 2000.0  # the engines draw SLOW_FRAMES where a frame takes longer
SLOW_FRAMES = 5
CALIBRATE = """#include "scene.hpp"
int main() { double c, m; bench::calibrate(c, m); bench::calibrate(c, m); printf("%.1f,%.1f", c, m); }
"""


def compile_tool(compiler, peers, source, target):
    """Compiles C++ text that sees the comparison's common/ folder."""
    subprocess.run([compiler, "-O2", "-std=c++17", "-w", "-I", str(peers / "common"), "-x", "c++", "-",
                    "-o", str(target)], input=source, text=True, check=True)


def make_scenes(compiler, peers, folder, work):
    """Writes the scenes into `folder` unless they are there."""
    if all((folder / f"{scene}.gltf").exists() for scene in SCENES):
        return
    folder.mkdir(parents=True, exist_ok=True)
    tool = work / "gen_scene"
    compile_tool(compiler, peers, (peers / "common" / "gen_scene.cpp").read_text(), tool)
    subprocess.run([str(tool), str(folder), "--no-obj"], check=True, stdout=subprocess.DEVNULL)


def view_flags(peers, scene, size):
    """Camera and sun of a scene as flags of gnomon."""
    view = json.loads((peers / "scenes" / f"{scene}.json").read_text())
    vector = lambda key: ",".join(f"{value:.7g}" for value in view[key])
    x, y, z = view["to_sun"]
    elevation = math.degrees(math.asin(y / math.hypot(x, y, z)))
    azimuth = math.degrees(math.atan2(x, -z))  # clockwise from north = -Z
    return ["--size", size,
            "--camera", f"eye={vector('eye')},target={vector('target')},fov={view['fovy_deg']},near={view['near']}",
            "--light", f"sun:elevation={elevation:.5f},azimuth={azimuth:.5f},diameter=0"]


def pinned(core, command, **more):
    """Runs a command on one core with one thread of the software driver."""
    environment = dict(os.environ, LP_NUM_THREADS="1")
    return subprocess.run(["taskset", "-c", core, *command], env=environment, check=True, text=True,
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, **more)


def bench(args, scene, config, frames, work):
    """The times of one run of `gnomon bench`, and the share of its core that it got."""
    report = work / "times.json"
    command = [str(args.gnomon), "bench", str(args.scenes / f"{scene}.gltf"), *CONFIGS[config],
               *view_flags(args.peers, scene, args.size), "--threads", "1", "--frames", str(frames),
               "--json", str(report), "--quiet"]
    before, start = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    pinned(args.core, command)
    after, seconds = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic() - start
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return json.loads(report.read_text())["results"][0]["time_ms"], cpu / seconds


def measure(args, scene, config, calibrate, work):
    """One RESULT row as a dictionary."""
    probe, _ = bench(args, scene, config, 1, work)
    frames = SLOW_FRAMES if probe["total"]["median"] > SLOW_FRAME_MS else args.frames
    times, share = bench(args, scene, config, frames, work)
    cpu_ms, mem_ms = pinned(args.core, [str(calibrate)]).stdout.split(",")
    width, height = args.size.split("x")
    total = times["total"]
    passes = ", ".join(f"{name} {value['median']:.1f}" for name, value in times["passes"].items())
    print(f"{scene} {config}: {share:.0%} of the core; {passes}", file=sys.stderr, flush=True)
    return {"peer": "gnomon", "scene": scene, "config": config, "width": width, "height": height,
            "median_ms": total["median"], "min_ms": total["min"], "p90_ms": total["max"], "frames": frames,
            "calib_cpu_ms": float(cpu_ms), "calib_mem_ms": float(mem_ms), "core_share": share}


def print_row(row):
    times = ",".join(f"{row[key]:.2f}" for key in ("median_ms", "min_ms", "p90_ms"))
    print(f"RESULT,{row['peer']},{row['scene']},{row['config']},{row['width']},{row['height']},{times},"
          f"{row['frames']},{row['calib_cpu_ms']:.1f},{row['calib_mem_ms']:.1f}", flush=True)


def frame_ms(row):
    """Median of a frame as if the process had had its core for itself; the engines' rows had it nearly so."""
    return float(row["median_ms"]) * row.get("core_share", 1.0)


def best_rows(rows, width):
    """The fastest row of each (peer, config, scene)."""
    best = {}
    for row in rows:
        key = row["peer"], row["config"], row["scene"]
        if row["width"] == width and (key not in best or frame_ms(row) < frame_ms(best[key])):
            best[key] = row
    return best


def base_config(peer, config):
    """The frame without shadows that a frame with them is compared to."""
    if peer != "ogre":
        return "none"
    return "none-rtss" if config.startswith("pssm") else "none-ffp"


def number(ms):
    return f"{ms:.1f}" if ms < 100 else f"{ms:.0f}"


def cell(best, peer, config, scene):
    row = best.get((peer, config, scene))
    if row is None:
        return "-"
    ms = frame_ms(row)
    if "core_share" in row:
        return f"+{number(ms)} at {row['core_share']:.0%} of the core"
    base = best.get((peer, base_config(peer, config), scene))
    if base is None or config.startswith("none"):
        return number(ms)
    return f"{number(ms)} (+{number(ms - frame_ms(base))})"


def print_table(own, engines):
    print("\n| what | configuration | small ms | large ms |\n|---|---|---|---|")
    for best in (own, engines):
        for peer, config in dict.fromkeys((peer, config) for peer, config, _ in best):
            cells = " | ".join(cell(best, peer, config, scene) for scene in SCENES)
            print(f"| {peer} | {config} | {cells} |")


def parse_args():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("gnomon", type=pathlib.Path, help="the program")
    parser.add_argument("--peers", type=pathlib.Path, required=True, help="folder of the comparison")
    parser.add_argument("--scenes", type=pathlib.Path, help="where the scenes are, or are to be made; "
                        "default a temporary folder")
    parser.add_argument("--only", default="", help="configurations that contain this")
    parser.add_argument("--size", default="1920x1080")
    parser.add_argument("--frames", type=int, default=20)
    parser.add_argument("--repeats", type=int, default=2, help="runs of each configuration, taking turns")
    parser.add_argument("--core", default="0")
    parser.add_argument("--compiler", default="g++")
    return parser.parse_args()


def main():
    args = parse_args()
    with tempfile.TemporaryDirectory() as folder:
        work = pathlib.Path(folder)
        args.scenes = args.scenes or work / "scenes"
        make_scenes(args.compiler, args.peers, args.scenes, work)
        calibrate = work / "calibrate"
        compile_tool(args.compiler, args.peers, CALIBRATE, calibrate)
        rows = []
        for _ in range(args.repeats):
            for scene in SCENES:
                for config in CONFIGS:
                    if args.only not in config:
                        continue
                    rows.append(measure(args, scene, config, calibrate, work))
                    print_row(rows[-1])
    width = args.size.split("x")[0]
    with open(args.peers / "results" / "results.csv", newline="") as file:
        engines = best_rows(csv.DictReader(file), width)
    print_table(best_rows(rows, width), engines)


if __name__ == "__main__":
    try:
        main()
    except subprocess.CalledProcessError as error:
        sys.exit(f"error: {' '.join(map(str, error.cmd))}: exit code {error.returncode}\n{error.stderr or ''}")
    except OSError as error:
        sys.exit(f"error: {error}")
