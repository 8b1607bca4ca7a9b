#!/usr/bin/env python3
"""The program `gnomon` as its users meet it: help, typing errors, exit codes, and files that appear whole
or not at all. GNOMON_CLI is the path of the program."""

import json
import os
import resource
import signal
import subprocess
import sys
import unittest

from cli_case import CLI, DONE, INPUT, MACHINE, SMALL, TIMEOUT_S, CliTest, gnomon

COMMANDS = ("info", "scene", "render", "compare", "bench", "bake", "sun", "web")


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
        options = self.unprivileged()
        self.fails(["secret.glb"], secret, **options)


    def test_bytes_that_are_no_text_are_not_passed_on(self):
        name = "caf\u00e9 " + os.fsdecode(b"\xff\xc3(") + ".glb"
        command = [CLI, "info", "--scene", name]
        result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=TIMEOUT_S, check=False)
        self.assertEqual(result.returncode, INPUT)
        self.assertEqual(result.stderr.decode("utf-8").splitlines(), ["error: caf\u00e9 ??(.glb: no such file"])


class Output(CliTest):
    """Wrong places are refused before the work starts; failed writing leaves nothing."""

    def test_missing_folder(self):
        self.assert_fails(INPUT, ["-o", "does not exist"], "scene", "cube", "-o",
                          self.folder / "no" / "x.glb")
        self.assert_fails(INPUT, ["-o", "does not exist"], "compare", "cube", "-o",
                          self.folder / "no" / "report")

    # What comes before -o; the work itself, or its input, would fail otherwise.
    FOLDER_COMMANDS = (("compare", "cube"), ("bake", "cube", "--sun", "place=48,11,date=2026-06-21"),
                       ("sun", "cube", "--place", "48,11", "--date", "2026-06-21"), ("web", "no such bake"))

    def fails_everywhere(self, words, output, **options):
        for command in self.FOLDER_COMMANDS:
            self.assert_fails(INPUT, ["-o", *words], *command, "-o", output, **options)

    def test_folders_that_cannot_be_made(self):
        self.fails_everywhere(["does not exist; make it first"], self.folder / "no" / "x")
        (self.folder / "file").touch()
        self.fails_everywhere(["is not a folder"], self.folder / "file" / "x")
        (self.folder / "link").symlink_to(self.folder / "nowhere")
        self.fails_everywhere(["is a link to", "nowhere", "does not exist"], self.folder / "link")
        self.assertEqual(self.files(), ["file", "link"])

    def test_folder_without_permission(self):
        self.folder.chmod(0o755)
        closed = self.folder / "closed"
        closed.mkdir(mode=0o555)
        options = self.unprivileged()
        self.fails_everywhere(["closed cannot be written to"], closed / "x", **options)

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
    def test_light_by_vertices(self):
        out = self.folder / "frame.png"

        def render(*flags):
            return self.assert_works("render", "torches", *SMALL, "--lights", "0,3", *flags, "-o", out), out.read_bytes()
        coarse = ("--vertex_occlusion.tessellate", 1)
        told, vertex = render("--lighting", "vertex", *coarse)
        self.assertIn("vertices, cut edges of 1 m or less", told)
        self.assertNotEqual(render("--lighting", "vertex_flat", *coarse)[1], vertex)
        self.assertNotEqual(render("--lighting", "vertex", *coarse, "--vertex_occlusion.walls", "false")[1], vertex)
        self.assertNotEqual(render("--lighting", "pixel")[1], vertex)

    def test_what_light_by_vertices_is_not_for(self):
        out = self.folder / "frame.png"
        for flag, value in (("--technique", "pssm"), ("--samples", 4), ("--visibility", self.folder / "v.exr"),
                            ("--compose", "subtractive")):
            self.assert_fails(INPUT, [flag, "--lighting vertex"], "render", "cube", "--lighting", "vertex", flag, value,
                              "-o", out)
        self.assert_fails(INPUT, ["--pssm.splits", "vertex_occlusion"], "render", "cube", "--lighting", "vertex",
                          "--pssm.splits", 2, "-o", out)
        self.assert_fails(INPUT, ["--lighting", '"vertices"', "vertex_flat"], "render", "cube", "--lighting", "vertices", "-o", out)
        self.assertEqual(self.files(), [])

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


if __name__ == "__main__":
    if not CLI:
        sys.exit("GNOMON_CLI must be the path of the program gnomon")
    unittest.main()
