#!/usr/bin/python3
"""Tests of the guards themselves: each is shown small projects, whole and with one thing wrong."""
import os
import subprocess
import sys
import tempfile
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
TRACEABILITY = os.path.join(ROOT, "scripts", "traceability")

SPEC = """# Specification
| id | requirement | state | keys |
|---|---|---|---|
| M1 | Places segments. | built | `Robot.Memory.Range_m` |
| M2 | Fuses segments. | part | |
| B1 | Sees in stereo. | not built yet | |
"""


class Guard(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = folder.name

    def write(self, path, text):
        path = os.path.join(self.root, path)
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)

    def remove(self, path):
        os.remove(os.path.join(self.root, path))

    def run_guard(self, program, *options):
        done = subprocess.run([sys.executable, program, "--root", self.root, *options], capture_output=True, text=True)
        return done.returncode, done.stdout + done.stderr

    def expect(self, program, *needles, options=(), code=1):
        found, output = self.run_guard(program, *options)
        self.assertEqual(found, code, output)
        for needle in needles:
            self.assertIn(needle, output)


class Traceability(Guard):
    def setUp(self):
        super().setUp()
        self.write("docs/spec.md", SPEC)
        self.write("components/robot/core/ground.h", "/// @file Places segments. Implements M1.\n")
        self.write("components/robot/core/fuse.h", "/// @file Fuses. Pure. See M1. Implements\n/// M2.\n")
        self.write("components/robot/app/config.cpp", 'readMemory(reader.group("Memory"));\nr.real("Range_m", 1);\n')
        self.write("test/robot/ground_test.cpp", "// Placing.\n// Tests M1, M2.\n")
        self.assertEqual(self.run_guard(TRACEABILITY)[0], 0)

    def check(self, *needles, code=1):
        self.expect(TRACEABILITY, *needles, options=("--check",), code=code)

    def test_a_whole_project_passes(self):
        self.check("3 rows, 2 built, 0 problems", code=0)

    def test_a_removed_citation_fails(self):
        self.write("components/robot/core/ground.h", "/// @file Places segments.\n")
        self.check("M1: no header says `Implements M1.`")

    def test_a_row_without_a_test_fails(self):
        self.write("test/robot/ground_test.cpp", "// Tests M1.\n")
        self.check("M2: no test says `Tests M2.`")

    def test_two_homes_of_a_row_fail(self):
        self.write("components/robot/core/other.h", "/// Implements M1.\n")
        self.check("M1: several headers implement it", "core/ground.h", "core/other.h")

    def test_a_source_is_no_home(self):
        self.write("components/robot/core/other.cpp", "// Implements M1.\n")
        self.check("other.cpp:1: Implements M1 (only a header")

    def test_a_citation_of_a_row_that_does_not_exist_fails_with_its_line(self):
        self.write("components/robot/core/fuse.h", "/// Fuses.\n/// See M1,\n/// M7. Implements M2.\n")
        self.check("fuse.h:2: See M7: docs/spec.md has no such row")

    def test_a_range_cites_each_of_its_rows(self):
        self.write("components/robot/core/fuse.h", "/// See M1-M3. Implements M2.\n")
        self.check("See M3: docs/spec.md has no such row")

    def test_pages_outside_the_repository_are_no_source(self):
        self.write("components/robot/core/fuse.h", "/// Implements M2. %s 14.\n" % "DESIGN")
        self.check('fuse.h:1: "DESIGN 1', "outside the repository")

    def test_a_key_that_nobody_reads_fails(self):
        self.write("components/robot/app/config.cpp", 'readMemory(reader.group("Memory"));\n')
        self.check("M1: no source of components/robot reads the key Robot.Memory.Range_m")

    def test_the_old_name_of_a_renamed_key_does_not_count(self):
        self.write("components/robot/app/config.cpp",
                   'reader.group("Memory").alias("Range_m", "Reach_m");\nr.real("Reach_m", 1);\n')
        self.check("reads the key Robot.Memory.Range_m")

    def test_an_outdated_table_fails(self):
        self.write("components/robot/core/ground.h", "/// @file Nothing.\n")
        self.write("components/robot/core/place.h", "/// @file Places. Implements M1.\n")
        self.check("docs/traceability.md: is not what scripts/traceability writes")

    def test_what_is_not_built_has_no_home(self):
        self.write("components/robot/core/stereo.h", "/// Implements B1.\n")
        self.check("B1: docs/spec.md says it is not built yet")

    def test_rows_are_drawn_the_same_with_the_same_seed(self):
        first = self.run_guard(TRACEABILITY, "--draw", "7", "2")
        self.assertEqual(first, self.run_guard(TRACEABILITY, "--draw", "7", "2"))
        self.assertIn("seed 7: 2 of 2 rows", first[1])
        self.assertIn("components/robot/core/ground.h", first[1])
        self.assertNotIn("B1", first[1])


class Words(Guard):
    LIST = """[everywhere]
except ^LICENSE$
allow ^.*\\balias\\(.*$
[lean]
say camera tilt error
word lean leans
[tell]
say report
word tells
allow \\btells\\b.*\\bapart\\b
[covered]
say occluded
word covered
in ^components/
"""

    def check(self, *needles, words=None, code=1):
        with tempfile.NamedTemporaryFile("w", suffix=".txt") as file:
            file.write(words or self.LIST)
            file.flush()
            self.expect(os.path.join(HERE, "words"), *needles, options=("--list", file.name), code=code)

    def test_clean_text_passes(self):
        self.write("components/a.h", "// A clean boolean; what tells edges apart. covers\n")
        self.write("docs/a.md", "The ground is covered.\n")
        self.write("LICENSE", "leans\n")
        self.check("0 uses", code=0)

    def test_a_word_is_found_in_prose_and_in_names_with_its_line(self):
        self.write("components/a.h", "int x;\n// the camera leans\nCameraLean lean_rad; int cameraLean; LEAN_M;\n")
        self.check('components/a.h:2: "leans" -> camera tilt error', 'a.h:3: "Lean"', 'a.h:3: "lean"', "5 uses")

    def test_file_names_are_names(self):
        self.write("components/camera_lean.h", "\n")
        self.check('components/camera_lean.h:0: "lean"')

    def test_an_ordinary_use_excuses_no_other_line(self):
        self.write("docs/a.md", "Size tells both apart.\nAn image tells the heading.\n")
        self.check("docs/a.md:2", "1 uses")

    def test_a_word_counts_only_in_its_folders(self):
        self.write("components/a.h", "// covered\n")
        self.write("test/a.cpp", "// covered\n")
        self.check("components/a.h:1", "1 uses")

    def test_old_names_of_keys_may_stay_in_aliases(self):
        self.write("components/a.cpp", 'r.alias("Lean.Mount_deg", "CameraTilt.Mount_deg");\n')
        self.check("0 uses", code=0)

    def test_a_broken_list_is_an_error_with_its_line(self):
        self.check('unknown "fnd"', words="[lean]\nsay tilt\nfnd lean\n")
        self.check("[lean] needs", words="[lean]\nsay tilt\n")

    def test_the_projects_own_list_knows_old_meanings_and_ordinary_ones(self):
        old = ("the lines of an image tell of the heading", "camera_lean.h", "a body that sways", "SmallMotion motion;",
               "double sway_doubt = 4;", "made-up observations", "P_stated", "an urgent wish", "GazeMailbox mailbox_;",
               "observation_news.h", "the stated covariance", "bool is_surprised", "birth_penalty", "worlds of strangers",
               "JointAlignment::Params", "meetSwaying(view)", "keepParted(a)", "learnt_odometry.h", "test/hostile",
               "the robot turns too little", "an edge parted by a mark", "Align.Compass = yes", "Rectilinearity")
        ordinary = ("the step of a filter", "look around", "meet the deadline", "a list of segments", "where two lines meet",
                    "told apart by parallax", "the robot is told to stand", "a clean floor", "body sway of the walk",
                    "the pose is in doubt", "learn the odometry's bias", "it was made up of two parts", "departed",
                    "the stated rule", "covered ground", "an open door", "of course", "redirect stderr")
        own = os.path.join(HERE, "words.txt")
        self.write("components/localization/README.md", "\n".join(old) + "\n")
        self.write("components/devices/README.md", "\n".join(ordinary) + "\n")
        found, output = self.run_guard(os.path.join(HERE, "words"), "--list", own)
        self.assertEqual(found, 1)
        self.assertNotIn("components/devices", output)
        for line, text in enumerate(old, 1):
            self.assertIn(f"components/localization/README.md:{line}:", output, text)


class Rooms(Guard):
    LIST = "core components/a/core rooms 3 floors 2\nground\nmemory\nwhole\n"

    def setUp(self):
        super().setUp()
        self.write("components/a/core/ground/plane.h", "#pragma once\n")
        self.write("components/a/core/memory/map.h", '#include "a/core/ground/plane.h"\n#include "common/x.h"\n')

    def check(self, *needles, rooms=None, code=1):
        with tempfile.NamedTemporaryFile("w", suffix=".txt") as file:
            file.write(rooms or self.LIST)
            file.flush()
            self.expect(os.path.join(HERE, "rooms"), *needles, options=("--list", file.name), code=code)

    def test_a_house_in_order_passes_and_is_printed(self):
        self.write("components/a/core/whole.h", '#include "a/core/ground/plane.h"\n')
        self.write("components/a/core/whole.cpp", '#include "a/core/whole.h"\n')
        self.check("3 rooms (at most 3), 2 arrows", "floor 2  memory", "2 floors (at most 2)", code=0)

    def test_an_include_upwards_is_named_with_its_line(self):
        self.write("components/a/core/whole.h", "")
        self.write("components/a/core/ground/near.cpp", '\n#include "a/core/whole.h"\n')
        self.check("ground/near.cpp:2: includes a/core/whole.h (upwards: ground lies below whole)")

    def test_a_circle_is_named(self):
        self.write("components/a/core/whole.h", "")
        self.write("components/a/core/ground/plane.h", '#include "a/core/memory/map.h"\n')
        self.check("a circle of includes: ground -> memory -> ground")

    def test_too_many_floors(self):
        self.write("components/a/core/whole.h", '#include "a/core/memory/map.h"\n')
        self.check("3 floors (at most 2)")

    def test_too_many_rooms_and_rooms_outside_the_list(self):
        self.write("components/a/core/whole.h", "")
        self.write("components/a/core/attic.cpp", "")
        self.check("room attic is not in the list", "4 rooms (at most 3)")

    def test_a_room_of_the_list_must_exist(self):
        self.check("the list has a room whole that does not exist")


class Pages(Guard):
    def setUp(self):
        super().setUp()
        self.write("README.md", "# A\n[Guide](docs/guide.md#how-to) ![](docs/a.png)\n")
        self.write("CHANGELOG.md", "# Changes\n")
        self.write("docs/a.png", "x")
        self.write("docs/guide.md", "# Guide\n## How to\n[Deep](deep/README.md), `[no](link)`\n```\n[no](link)\n```\n")
        self.write("docs/deep/README.md", "# Deep\n[back](../guide.md) [web](https://example.org/x)\n")

    def check(self, *needles, code=1):
        self.expect(os.path.join(HERE, "pages"), *needles, code=code)

    def test_whole_pages_pass(self):
        self.check("4 pages, 0 problems", code=0)

    def test_a_page_that_nothing_leads_to(self):
        self.write("docs/lost.md", "# Lost\n")
        self.check("docs/lost.md: no way of links from README.md")

    def test_links_that_lead_nowhere(self):
        self.write("docs/deep/README.md", "# Deep\n\n[x](gone.md) [y](../guide.md#what)\n")
        self.check("docs/deep/README.md:3: gone.md leads nowhere", "../guide.md#what: docs/guide.md has no heading #what")

    def test_long_pages(self):
        self.write("README.md", "[g](docs/guide.md)\n" * 150)
        self.write("CHANGELOG.md", "x\n" * 41)
        self.write("docs/deep/README.md", "word " * 1500)
        self.check("README.md: 150 lines", "CHANGELOG.md: 41 lines", "docs/deep/README.md: 1500 words (at most 1499)")

    def test_tests_that_are_not_there(self):
        self.write("test/a_test.cpp", "TEST(A, Works) {\n}\nTEST_F(B, WorksToo) {\n}\n")
        self.write("docs/guide.md", "# Guide\n## How to\n[Deep](deep/README.md) `a_test`: Works, WorksToo, Fails; `b_test`: Works\n")
        self.check("`a_test`: Fails is no test", "`b_test`: Works is no test", "2 problems")

    def test_generated_pages_may_be_long(self):
        self.write("docs/deep/README.md", "# T\nGenerated by x. Do not edit.\n" + "word " * 2000)
        self.check("0 problems", code=0)


class Types(Guard):
    def check(self, *needles, code=1):
        self.expect(os.path.join(HERE, "types"), *needles, code=code)

    def test_names_of_their_own_pass(self):
        self.write("components/a/edge.h", "namespace vismem {\nstruct Edge {\n};\nclass Late;\n}  // namespace vismem\n")
        self.write("drivers/b/edge.h", "namespace vismem::b {\nstruct Edge : Base {\n};\nstruct Edge::Impl {\n};\n}  // namespace\n")
        self.write("test/edge.h", "namespace vismem {\nnamespace {\nstruct Edge {\n};\n}  // namespace\n}  // namespace vismem\n")
        self.check("types: 2 types of headers, 0 problems", code=0)

    def test_two_types_of_one_name(self):
        for path in ("components/a/edge.h", "drivers/b/edge.h"):
            self.write(path, "namespace vismem {\nclass Edge final : public Base {\n};\n}  // namespace vismem\n")
        self.check("vismem::Edge: components/a/edge.h, drivers/b/edge.h")


if __name__ == "__main__":
    unittest.main()
