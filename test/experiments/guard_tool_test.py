#!/usr/bin/python3
"""scripts/guard: runs are made once, failures are said, and differences get the verdict that their interval allows."""
import json
import os
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
GUARD = os.path.join(ROOT, "scripts/guard")

# A program of the guard's set: notes its call, and prints a precision that depends on the seed.
PROGRAM = """#!/usr/bin/python3
import json, os, sys
seed = int(sys.argv[sys.argv.index("--seed") + 1])
with open(os.path.join(os.path.dirname(__file__), "calls"), "a") as calls:
    calls.write(" ".join(sys.argv[1:]) + "\\n")
if os.environ.get("FAIL_AT") == str(seed):
    sys.exit("the disk is full")
print("progress")
print(json.dumps({"room": {"drive": {"precision": 0.9 + seed % 10 * 0.001, "recall": 0.8, "duplicates": 1.0}}}))
"""


def guard(*words, **environment):
    return subprocess.run([GUARD, *words], capture_output=True, text=True, env={**os.environ, **environment})


class GuardTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.path = self.folder.name
        program = os.path.join(self.path, "experiment")
        with open(program, "w", encoding="utf-8") as stream:
            stream.write(PROGRAM)
        os.chmod(program, 0o755)

    def run_guard(self, name, **environment):
        return guard("run", os.path.join(self.path, name), "--bin", self.path, "--data", self.path, "--only", "E1_room",
                     **environment)

    def calls(self):
        with open(os.path.join(self.path, "calls"), encoding="utf-8") as stream:
            return stream.read().splitlines()

    def put(self, name, item, values):
        """A run for each value, with the JSON that holds it."""
        folder = os.path.join(self.path, name, item)
        os.makedirs(folder, exist_ok=True)
        for run, value in values.items():
            with open(os.path.join(folder, run + ".json"), "w", encoding="utf-8") as stream:
                json.dump(value, stream)

    def compare(self):
        return guard("compare", os.path.join(self.path, "a"), os.path.join(self.path, "b"))

    def verdict(self, title):
        done = self.compare()
        rows = [line for line in done.stdout.splitlines() if title in line]
        self.assertEqual(len(rows), 1, done.stdout + done.stderr)
        return rows[0].rstrip("| ").rsplit("| ", 1)[1], done.returncode

    def test_makes_each_run_once(self):
        first = self.run_guard("a")
        self.assertEqual(first.returncode, 0, first.stderr)
        self.assertEqual(len(self.calls()), 6)
        self.assertIn("6 of 6 runs, about 0 min left", first.stderr)
        again = self.run_guard("a")
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertEqual(len(self.calls()), 6)

    def test_says_which_run_failed_and_makes_it_again(self):
        failed = self.run_guard("a", FAIL_AT="503")
        self.assertEqual(failed.returncode, 1)
        self.assertIn("E1_room seed503: exit 1: the disk is full", failed.stderr)
        self.assertEqual(self.run_guard("a").returncode, 0)
        self.assertEqual(len(self.calls()), 7)

    def memory(self, precisions):
        return {f"seed{501 + i}": {"room": {"drive": {"precision": value, "recall": 0.8, "duplicates": 1.0}}}
                for i, value in enumerate(precisions)}

    def test_equal_builds_are_the_same(self):
        for name in "ab":
            self.put(name, "E1_room", self.memory([0.9, 0.92, 0.94]))
        self.assertEqual(self.verdict("| precision |"), ("same", 0))

    def test_a_loss_beyond_interval_and_margin_is_worse(self):
        self.put("a", "E1_room", self.memory([0.9, 0.92, 0.94]))
        self.put("b", "E1_room", self.memory([0.86, 0.87, 0.9]))
        self.assertEqual(self.verdict("| precision |"), ("WORSE", 1))

    def test_a_loss_inside_the_margin_is_none(self):
        self.put("a", "E1_room", self.memory([0.9, 0.92, 0.94]))
        self.put("b", "E1_room", self.memory([0.89, 0.91, 0.93]))
        self.assertEqual(self.verdict("| precision |"), ("same", 0))

    def test_a_loss_inside_the_interval_is_none(self):
        self.put("a", "E1_room", self.memory([0.9, 0.9, 0.9]))
        self.put("b", "E1_room", self.memory([0.7, 0.95, 0.95]))
        self.assertEqual(self.verdict("| precision |"), ("same", 0))

    def test_recordings_have_a_margin_of_two_percent(self):
        for name, error in (("a", 0.010), ("b", 0.011)):
            self.put(name, "room_wheels_a", {f"seed{i}": {"position_error_m": error, "settled_after_s": 0.0,
                                                          "heading_error_deg": 0.1} for i in (1, 2, 3)})
        self.assertEqual(self.verdict("| position error [m] |"), ("WORSE", 1))

    def test_a_run_that_never_settles_any_more_is_worse(self):
        self.put("a", "nao", {"seed1": {"map_projection_px": 2.0}})
        self.put("b", "nao", {"seed1": {"map_projection_px": None}})
        self.assertEqual(self.verdict("| detected lines to the map [px] |"), ("WORSE (1 lost, 0 won)", 1))

    def test_wrong_input_is_named(self):
        done = self.compare()
        self.assertEqual(done.returncode, 2)
        self.assertIn("/a: no such folder", done.stderr)
        self.assertEqual(guard("run", self.path, "--only", "E99").returncode, 2)
        self.assertIn("/nowhere: no such folder", guard("run", self.path, "--data", "/nowhere").stderr)


if __name__ == "__main__":
    sys.exit(unittest.main())
