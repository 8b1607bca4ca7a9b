#!/usr/bin/env python3
"""skipped_tests.py finds the cases that were skipped in ctest's log, and no others."""

import unittest

import skipped_tests

LOG = """\
1/2 Testing: scene
1/2 Test: scene
Command: "/build/scene_test"
Output:
----------------------------------------------------------
[ RUN      ] Scenes.LoadAll
/src/scene_test.cpp:12: Skipped
GNOMON_SCENES is not set

[  SKIPPED ] Scenes.LoadAll (0 ms)
[ RUN      ] Scenes.Cube
some output
[       OK ] Scenes.Cube (3 ms)
[ RUN      ] Scenes.Bare
/src/scene_test.cpp:20: Skipped

[  SKIPPED ] Scenes.Bare (0 ms)
[==========] 3 tests from 1 test suite ran. (3 ms total)
[  PASSED  ] 1 test.
[  SKIPPED ] 2 tests, listed below:
[  SKIPPED ] Scenes.LoadAll
[  SKIPPED ] Scenes.Bare
<end of output>
Test Passed.
2/2 Test: bad_inputs
Output:
test_all (__main__.BadInputs.test_all) ... skipped 'GNOMON_SCENES is not set'
test_far (__main__.BadInputs.test_far)
Files far from here. ... skipped 'no folder'
test_none (__main__.BadInputs.test_none) ... ok
<end of output>
Test Passed.
"""


class SkippedTests(unittest.TestCase):
    def test_lists_each_skipped_case_once_with_its_reason(self):
        self.assertEqual(list(skipped_tests.skipped(LOG)), [
            ("Scenes.LoadAll", "GNOMON_SCENES is not set"),
            ("Scenes.Bare", ""),
            ("bad_inputs.test_all", "GNOMON_SCENES is not set"),
            ("bad_inputs.Files far from here.", "no folder"),
        ])

    def test_nothing_skipped_is_an_empty_list(self):
        self.assertEqual(list(skipped_tests.skipped("1/1 Test: a\nTest Passed.\n")), [])


if __name__ == "__main__":
    unittest.main()
