#!/usr/bin/env python3
"""Malformed and hostile scenes: gnomon loads them with warnings or refuses them, and nothing else.

    bad_inputs_test.py GNOMON [FOLDER]     or GNOMON_BINARY and GNOMON_BAD_INPUTS in the environment

FOLDER holds collections of files, each with a LIST.md whose table says what is wrong with each file.
JSON texts are tried as the text of a .gltf and pictures as the texture of a square. Without FOLDER
only the scenes that this test makes itself are tried.

Each file must end within 5 s and 2 GiB with
  - exit code 0 and nothing but `warning:` lines on stderr, or
  - exit code 2 and exactly one `error:` line, besides warnings, that names the file;
and no file outside the scene's own folder may be read.
"""

import base64
import json
import os
import pathlib
import resource
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest

LIMIT_S = 5.0
LIMIT_BYTES = 2 << 30
SCENES = {".gltf", ".glb", ".obj"}
PICTURES = {".png", ".jpg", ".jpeg"}

GNOMON = os.environ.get("GNOMON_BINARY", "")
FOLDER = os.environ.get("GNOMON_BAD_INPUTS", "")


def is_sanitized():
    """AddressSanitizer reserves terabytes of address space, so that it cannot be limited."""
    return b"__asan_init" in pathlib.Path(GNOMON).read_bytes()


def run(scene, sanitized):
    def limit():
        if not sanitized:
            resource.setrlimit(resource.RLIMIT_AS, (LIMIT_BYTES, LIMIT_BYTES))

    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run(
        [GNOMON, "info", "--scene", str(scene)], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
        stderr=subprocess.PIPE, preexec_fn=limit, timeout=10 * LIMIT_S, check=False)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    # Of processor time, which other work on the machine does not lengthen.
    seconds = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return done.returncode, done.stdout, done.stderr.decode("utf-8", "replace"), seconds


def quad(texture):
    """The text of a .gltf with one square that shows the picture `texture`, masked by its alpha."""
    positions = struct.pack("<12f", 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0)
    texcoords = struct.pack("<8f", 0, 1, 1, 1, 1, 0, 0, 0)
    indices = struct.pack("<6H", 0, 1, 2, 0, 2, 3)
    data = positions + texcoords + indices
    return json.dumps({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2,
                                    "material": 0}]}],
        "materials": [{"alphaMode": "MASK",
                       "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}}}],
        "textures": [{"source": 0}], "images": [{"uri": texture}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR"}],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 32},
            {"buffer": 0, "byteOffset": 80, "byteLength": 12}],
        "buffers": [{"byteLength": 92, "uri": "data:application/octet-stream;base64,"
                                              + base64.b64encode(data).decode()}]})


class BadInputs(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.sanitized = is_sanitized()
        cls.scratch = pathlib.Path(tempfile.mkdtemp(prefix="gnomon_bad_inputs_"))

    @classmethod
    def tearDownClass(cls):
        shutil.rmtree(cls.scratch, ignore_errors=True)

    def check(self, scene, expected=None):
        """Runs gnomon on the file and checks how it ends; returns the exit code and stderr."""
        code, out, err, seconds = run(scene, self.sanitized)
        lines = err.splitlines()
        errors = [line for line in lines if line.startswith("error: ")]
        others = [line for line in lines if not line.startswith(("error: ", "warning: "))]
        self.assertEqual(others, [], f"stray lines on stderr, exit code {code}")
        self.assertIn(code, (0, 2), err)
        if code == 0:
            self.assertEqual(errors, [])
        else:
            self.assertEqual(len(errors), 1, err)
            self.assertIn(pathlib.Path(scene).name, errors[0])
            self.assertEqual(out, b"", "an error, but results all the same")
        self.assertLess(seconds, LIMIT_S)
        # Of the greediest run so far; the address space of sanitized programs cannot be limited.
        peak_bytes = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024
        self.assertLess(peak_bytes, LIMIT_BYTES)
        if expected is not None:
            self.assertEqual(code, expected, err)
        return code, err

    def listed(self, collection):
        """(path, what is wrong) for each file of a collection's table."""
        folder = pathlib.Path(FOLDER) / collection
        for line in (folder / "LIST.md").read_text().splitlines():
            cells = [cell.strip() for cell in line.strip("| \n").split(" | ")]
            path = folder / cells[0]
            if path.is_file() and path.suffix.lower() != ".md":
                yield path, cells[-1]

    def collections(self):
        if not FOLDER:
            self.skipTest("no folder of bad inputs is named")
        return sorted(p.parent.name for p in pathlib.Path(FOLDER).glob("*/LIST.md"))

    def test_scenes(self):
        count = 0
        for collection in self.collections():
            for path, fault in self.listed(collection):
                if path.suffix.lower() not in SCENES or "companion" in fault:
                    continue
                harmless = "warnings only" in fault
                with self.subTest(file=f"{collection}/{path.name}", fault=fault):
                    self.check(path, 0 if harmless else None)
                    count += 1
        self.assertGreater(count, 0)

    def test_json_texts(self):
        self.collections()
        for path, fault in self.listed("json"):
            scene = self.scratch / (path.name + ".gltf")
            shutil.copyfile(path, scene)
            with self.subTest(file=path.name, fault=fault):
                self.check(scene, 2)  # not one of them is a glTF document

    def test_pictures(self):
        for collection in self.collections():
            for path, fault in self.listed(collection):
                if path.suffix.lower() not in PICTURES or "companion" in fault:
                    continue
                scene = self.scratch / "quad.gltf"
                shutil.copyfile(path, self.scratch / ("picture" + path.suffix))
                scene.write_text(quad("picture" + path.suffix))
                with self.subTest(file=f"{collection}/{path.name}", fault=fault):
                    self.check(scene, 0)  # a texture that cannot be read is a warning

    def test_required_extensions_are_named(self):
        self.collections()
        for path, fault in self.listed("needs-extension"):
            if path.suffix.lower() not in SCENES:
                continue
            with self.subTest(file=path.name):
                code, err = self.check(path)
                if code == 2:
                    self.assertRegex(err, r"[A-Z]{3,}_\w+")

    def test_nothing_outside_the_folder_is_read(self):
        """A canary beside the scene's folder, and ways to it. Were it read, it would be a texture
        (no warning) or a buffer (no error)."""
        inside = self.scratch / "inside"
        inside.mkdir()
        white = bytes.fromhex(
            "89504e470d0a1a0a0000000d4948445200000001000000010804000000b51c0c02"
            "0000000b4944415478da6364f80f00010501012718e3660000000049454e44ae426082")
        canary = self.scratch / "canary.png"
        canary.write_bytes(white)
        (inside / "canary.png").write_bytes(white)
        scene = inside / "scene.gltf"
        scene.write_text(quad("canary.png"))
        self.assertEqual(self.check(scene, 0)[1], "", "the picture itself is fine")
        (inside / "canary.png").unlink()
        os.symlink(canary, inside / "link.png")
        os.symlink(self.scratch, inside / "folder")
        os.mkfifo(inside / "pipe.png")
        for uri in ("../canary.png", "%2e%2e/canary.png", "..%2Fcanary.png", "x/../../canary.png",
                    str(canary), "file://" + str(canary), "link.png", "folder/canary.png",
                    "pipe.png", "//" + str(canary), "http://localhost/canary.png", ".", "", "\u0000"):
            scene.write_text(quad(uri))
            with self.subTest(uri=uri):
                self.assertIn("warning: ", self.check(scene, 0)[1])
        for name in ("../canary.png", str(canary), "link.png", "..\\canary.png"):
            (inside / "scene.mtl").write_text(f"newmtl m\nmap_Kd {name}\n")
            (inside / "scene.obj").write_text(
                "mtllib scene.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n")
            with self.subTest(map_Kd=name):
                self.assertIn("warning: ", self.check(inside / "scene.obj", 0)[1])
        (self.scratch / "outside.mtl").write_text("newmtl m\n")
        for name in ("../outside.mtl", str(self.scratch / "outside.mtl"), "folder/outside.mtl"):
            (inside / "scene.obj").write_text(
                f"mtllib {name}\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n")
            with self.subTest(mtllib=name):
                self.assertIn("warning: ", self.check(inside / "scene.obj", 0)[1])

    def test_what_is_no_file(self):
        for name in ("missing.gltf", "missing.glb", "missing.obj"):
            with self.subTest(name=name):
                self.check(self.scratch / name, 2)
        folder = self.scratch / "folder.gltf"
        folder.mkdir()
        self.check(folder, 2)
        unreadable = self.scratch / "unreadable.obj"
        unreadable.write_text("v 0 0 0\n")
        unreadable.chmod(0)
        if not os.access(unreadable, os.R_OK):  # root may read it
            self.check(unreadable, 2)

    def test_demands_out_of_proportion(self):
        """Small files that ask for much memory or time."""
        base = json.loads(quad("none.png"))
        huge = json.loads(json.dumps(base))
        huge["accessors"][0] = {"componentType": 5126, "count": 2147483647, "type": "VEC3"}
        chain = {"asset": {"version": "2.0"}, "scenes": [{"nodes": [0]}],
                 "nodes": [{"children": [i + 1]} for i in range(100000)] + [{}]}
        many = json.loads(json.dumps(base))
        many["accessors"][0] = {"componentType": 5126, "count": 1000000, "type": "VEC3"}
        many["meshes"][0]["primitives"] *= 10000
        texts = {"huge": json.dumps(huge), "many": json.dumps(many), "chain": json.dumps(chain),
                 "deep": "[" * 1000000, "deep_object": '{"a":' * 500000}
        for name, text in texts.items():
            scene = self.scratch / (name + ".gltf")
            scene.write_text(text)
            with self.subTest(name=name):
                self.check(scene, 0 if name == "chain" else 2)
        corners = 200000
        polygon = self.scratch / "polygon.obj"
        polygon.write_text("".join(f"v {i % 2} {i} 0\n" for i in range(corners))
                           + "f " + " ".join(str(i + 1) for i in range(corners)) + "\n")
        self.check(polygon, 0)


if __name__ == "__main__":
    arguments = [a for a in sys.argv[1:] if not a.startswith("-")]
    GNOMON = arguments[0] if arguments else GNOMON
    FOLDER = arguments[1] if len(arguments) > 1 else FOLDER
    if not GNOMON:
        sys.exit(__doc__)
    unittest.main(argv=[sys.argv[0]] + [a for a in sys.argv[1:] if a.startswith("-")])
