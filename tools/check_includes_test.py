#!/usr/bin/env python3
"""Each rule of check_includes.py finds its fault and lets what is right pass."""

import pathlib
import tempfile
import unittest

import check_includes


class CheckIncludes(unittest.TestCase):
    def faults(self, path, *lines):
        """The faults of one file in an otherwise empty tree, without its path."""
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            file = root / path
            file.parent.mkdir(parents=True)
            file.write_text("\n".join(lines) + "\n", encoding="utf-8")
            return [fault.removeprefix(f"{path}:") for fault in check_includes.check(root)]

    def assert_right(self, path, *lines):
        self.assertEqual(self.faults(path, *lines), [])

    def assert_fault(self, path, include, expected):
        """`include` stands on line 2 and is the one fault, told with file, line and reason."""
        faults = self.faults(path, "#pragma once", include)
        self.assertEqual(len(faults), 1, faults)
        self.assertTrue(faults[0].startswith("2: "), faults)
        self.assertIn(expected, faults[0])

    def test_downward_includes_are_right(self):
        self.assert_right("src/scene/a.cpp", '#include "scene/a.h"', '#include "image/png.h"',
                          '#include "base/check.h"', "#include <gnomon/scene.h>", "#include <vector>")
        self.assert_right("src/report/a.cpp", '#include "lighting/a.h"', '#include "technique/a.h"')
        self.assert_right("techniques/pssm/a.cpp", '#include "visibility/fit.h"', '#include "a.h"',
                          '#include "split.comp.spv.h"', "#include <gnomon/technique.h>")

    def test_upward_includes_are_faults(self):
        self.assert_fault("src/base/a.cpp", '#include "image/png.h"', "base is not above image")
        self.assert_fault("src/gpu/a.h", '#include "scene/a.h"', "gpu is not above scene")
        self.assert_fault("src/gpu/a.h", '#include "trace/a.h"', "gpu is not above trace")
        self.assert_fault("src/raster/a.h", '#include "trace/a.h"', "raster is not above trace")
        self.assert_fault("src/trace/a.h", '#include "gpu/a.h"', "trace is not above gpu")
        self.assert_fault("src/lighting/a.h", '#include "technique/a.h"', "not above technique")
        self.assert_fault("src/technique/a.h", '#include "lighting/a.h"', "not above lighting")
        self.assert_fault("src/visibility/a.glsl", '#include "lighting/a.glsl"', "not above lighting")

    def test_public_headers_have_layers(self):
        self.assert_fault("src/base/a.cpp", "#include <gnomon/image.h>", "not above image")
        self.assert_fault("src/scene/a.cpp", "#include <gnomon/context.h>", "not above gpu")
        self.assert_fault("src/gpu/a.cpp", "#include <gnomon/scene.h>", "not above scene")
        self.assert_fault("src/gpu/a.cpp", "#include <gnomon/gnomon.h>", "not above report")
        self.assert_fault("src/report/a.cpp", "#include <gnomon/new.h>", "no module")
        self.assert_right("src/report/a.cpp", "#include <gnomon/gnomon.h>")
        self.assert_fault("include/gnomon/scene.h", "#include <gnomon/technique.h>", "not above")
        self.assert_fault("include/gnomon/scene.h", "#include <fmt/format.h>", "public headers")
        self.assert_right("include/gnomon/math.h", "#pragma once", "#include <glm/geometric.hpp>",
                          "#include <limits>")

    def test_techniques_do_not_see_each_other(self):
        path = "techniques/pssm/a.cpp"
        self.assert_fault(path, '#include "techniques/psm/psm.h"', "techniques do not see each other")
        self.assert_fault(path, '#include "../psm/psm.h"', "without `..`")
        self.assert_fault(path, '#include "psm/psm.h"', "no module")
        self.assert_fault(path, '#include "lighting/a.h"', "not above lighting")
        self.assert_right(path, '#include "techniques/pssm/fit.h"')

    def test_users_see_only_the_public_api(self):
        self.assert_fault("apps/cli/a.cpp", '#include "scene/scene.h"', "only <gnomon/...>")
        self.assert_fault("examples/one/a.cpp", '#include "base/check.h"', "only <gnomon/...>")
        self.assert_right("apps/cli/a.cpp", '#include "options.h"', "#include <gnomon/gnomon.h>",
                          "#include <CLI/CLI.hpp>")

    def test_vulkan_and_embree_stay_where_they_belong(self):
        for module in ("base", "image", "scene", "trace"):
            self.assert_fault(f"src/{module}/a.h", "#include <volk.h>", "Vulkan is not for")
            self.assert_fault(f"src/{module}/a.h", "#include <vulkan/vulkan.h>", "Vulkan is not for")
        for module in ("scene", "visibility", "gpu"):
            self.assert_fault(f"src/{module}/a.h", "#include <embree3/rtcore.h>", "Embree is not for")
        self.assert_fault("techniques/pssm/a.h", "#include <embree4/rtcore.h>", "Embree is not for")
        self.assert_right("src/trace/a.cpp", "#include <embree3/rtcore.h>")
        self.assert_right("src/gpu/a.cpp", "#include <volk.h>")
        self.assert_right("bench/a.cpp", "#include <embree3/rtcore.h>", "#include <volk.h>")

    def test_erfa_stays_in_sun(self):
        self.assert_fault("src/scene/a.cpp", "#include <erfa.h>", "ERFA is not for scene")
        self.assert_right("src/sun/a.cpp", "#include <erfa.h>", "#include <gnomon/light.h>")
        self.assert_fault("src/bake/a.cpp", "#include <date/tz.h>", "date is not for bake")
        self.assert_right("src/sun/a.cpp", "#include <date/tz.h>")
        self.assert_fault("src/scene/a.h", "#include <gnomon/sun.h>", "scene is not above sun")

    def test_headers_are_guarded_and_files_short(self):
        self.assertIn("#pragma once", self.faults("src/base/a.h", "int a;")[0])
        self.assert_right("src/interval/a.inl.h", "int a;")  # compiled once for each target
        limit = check_includes.MAX_LINES
        self.assert_right("src/base/a.cpp", *["int a;"] * limit)
        self.assertIn(f"{limit + 1}: ", self.faults("src/base/a.cpp", *["int a;"] * (limit + 1))[0])

    def test_a_header_is_included_once(self):
        faults = self.faults("src/base/a.cpp", "#include <map>", "int a;", "#include <map>")
        self.assertEqual(faults, ["3: #include <map> stands here twice"])

    def test_unknown_modules_are_faults(self):
        self.assertIn("no module", self.faults("src/misc/a.cpp", "int a;")[0])
        self.assertIn("no module", self.faults("src/a.cpp", "int a;")[0])

    def test_this_repository_is_right(self):
        self.assertEqual(check_includes.check(pathlib.Path(__file__).parent.parent), [])


if __name__ == "__main__":
    unittest.main()
