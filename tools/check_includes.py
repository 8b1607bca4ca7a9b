#!/usr/bin/env python3
"""Checks that includes point only downwards (docs/architecture.md), and a few rules of the same kind.

    tools/check_includes.py [ROOT]

Prints `file:line: fault` for each fault and exits with 1 when there is any.
"""

import pathlib
import re
import sys

MAX_LINES = 500

# What each module of src/ may include besides itself.
BASE = {"base"}
IMAGE = BASE | {"image"}
SCENE = IMAGE | {"scene"}
SUN = SCENE | {"sun"}
GPU = IMAGE | {"gpu"}
VISIBILITY = SCENE | GPU | {"raster", "trace", "interval", "visibility"}
BAKE = SUN | {"trace", "interval", "lightmap", "bake"}
TECHNIQUE = VISIBILITY | BAKE | {"technique"}
MODULES = {
    "base": BASE,
    "image": IMAGE,
    "scene": SCENE,
    "sun": SUN,
    "lightmap": SCENE | {"lightmap"},
    "trace": SCENE | {"trace"},
    "interval": SCENE | {"trace", "interval"},
    "bake": BAKE,
    "web": BAKE | {"web"},
    "gpu": GPU,
    "raster": SCENE | GPU | {"raster"},
    "visibility": VISIBILITY,
    "technique": TECHNIQUE,
    "lighting": VISIBILITY | {"lighting"},
    "report": TECHNIQUE | {"web", "lighting", "report"},
}
ALL = set(MODULES)

# The module that each public header belongs to: whoever may include the module may include it.
PUBLIC = {
    "error": "base", "math": "base", "progress": "base",
    "image": "image", "metrics": "image",
    "light": "scene", "scene": "scene",
    "sun": "sun", "light_path": "sun",
    "context": "gpu",
    "bake": "bake", "sun_hours": "bake",
    "web": "web",
    "visibility": "visibility",
    "technique": "technique",
    "lighting": "lighting", "vertex_lighting": "lighting",
    "report": "report",
    "gnomon": "report",
    "vulkan": "technique",
}

# Third-party headers that only some modules may see.
RESERVED = [
    (re.compile(r"embree\d?/"), "Embree", {"trace"}),
    (re.compile(r"erfa"), "ERFA", {"sun"}),
    (re.compile(r"date/"), "date", {"sun"}),
    (re.compile(r"hwy/"), "Highway", {"interval"}),
    (re.compile(r"(volk\.h|vulkan/)"), "Vulkan", ALL - BAKE - {"web"}),
]

# Public headers may use the standard library, glm and each other.
PORTABLE = re.compile(r"([a-z_0-9]+|glm/.*|gnomon/.*)$")

INCLUDE = re.compile(r'\s*#\s*include\s*([<"])([^>"]+)[>"]')
SUFFIXES = {".h", ".cpp", ".glsl"}
FOLDERS = ["include", "src", "techniques", "apps", "examples", "bench", "tests"]


class Place:
    """Where a file is, and so what it may include."""

    def __init__(self, path):
        parts = path.parts
        self.top = parts[0]
        self.is_test = path.stem.endswith("_test")
        self.user = self.top in ("apps", "examples")
        self.free = self.top in ("tests", "bench")
        if self.top == "include":
            self.name, self.own = f"<gnomon/{path.name}>", PUBLIC.get(path.stem)
            self.allowed = MODULES.get(self.own, set())
        elif self.top == "src":
            self.name = self.own = parts[1] if len(parts) > 2 else ""
            self.allowed = MODULES.get(self.own, set())
        elif self.top == "techniques":
            self.name = self.own = "/".join(parts[:2])
            self.allowed = TECHNIQUE
        else:
            self.name, self.own, self.allowed = self.top, self.top, ALL


def fault_of_include(place, bracket, header):
    """Why a file at `place` may not include `header`, or None."""
    if header.startswith("/") or ".." in header.split("/"):
        return "includes go by the name from src/ or include/, without `..`"
    first, _, rest = header.partition("/")

    if first == "gnomon" and bracket == "<":
        module = PUBLIC.get(rest.removesuffix(".h"))
        if module is None:
            return f"<{header}> has no module in tools/check_includes.py"
        if place.free or place.user or module in place.allowed:
            return None
        return f"{place.name} is not above {module}, to which <{header}> belongs"

    if bracket == "<":
        if place.top == "include" and place.name != "<gnomon/vulkan.h>":
            if not PORTABLE.match(header):
                return f"public headers use the standard library and glm, not <{header}>"
        for pattern, what, modules in RESERVED:
            if pattern.match(header) and not (place.free or place.user):
                module = "technique" if place.top == "techniques" else place.own
                if module not in modules:
                    return f"{what} is not for {place.name}: only for {', '.join(sorted(modules))}"
        return None

    if not rest or place.free:
        return None  # a file of the same folder
    if place.user:
        return f"{place.top} sees only <gnomon/...>, not \"{header}\""
    if first in MODULES:
        return None if first in place.allowed else f"{place.name} is not above {first}"
    if first == "techniques":
        return None if header.startswith(f"{place.own}/") else "techniques do not see each other"
    return f"\"{header}\" is in no module of src/"


def faults_of_file(root, path):
    """(line, fault) of one file; `path` is relative to `root`."""
    place = Place(path)
    if place.top in ("src", "include") and not place.allowed:
        yield 1, f"{path} belongs to no module of tools/check_includes.py"
        return
    lines = (root / path).read_text(encoding="utf-8").splitlines()
    if path.suffix == ".h" and "#pragma once" not in lines and not path.name.endswith((".shared.h", ".inl.h")):
        yield 1, "a header starts with #pragma once"
    if len(lines) > MAX_LINES:
        yield MAX_LINES + 1, f"{len(lines)} lines, more than {MAX_LINES}: split the file"
    seen = set()
    for number, line in enumerate(lines, 1):
        if match := INCLUDE.match(line):
            if path.suffix != ".glsl" and match.group() in seen:
                yield number, f"{match.group().strip()} stands here twice"
            seen.add(match.group())
            if fault := fault_of_include(place, *match.groups()):
                yield number, fault


def check(root):
    """All faults below `root`, as `file:line: fault`."""
    faults = []
    for folder in FOLDERS:
        for file in sorted((root / folder).rglob("*")):
            if file.suffix in SUFFIXES and file.is_file():
                path = file.relative_to(root)
                faults += [f"{path}:{line}: {fault}" for line, fault in faults_of_file(root, path)]
    return faults


def main():
    root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else pathlib.Path(__file__).parent.parent)
    faults = check(root)
    print("\n".join(faults), end="\n" if faults else "")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
