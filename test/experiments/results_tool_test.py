"""scripts/results: data from results, pages from data, errors that name file and key."""
import contextlib
import importlib.machinery
import importlib.util
import io
import json
import os
import sys
import tempfile
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.dont_write_bytecode = True
loader = importlib.machinery.SourceFileLoader("results", os.path.join(ROOT, "scripts", "results"))
results = importlib.util.module_from_spec(importlib.util.spec_from_loader("results", loader))
loader.exec_module(results)

FIGURE = {"value": 0.5, "low": 0.25, "high": 0.75}
E5 = {"experiment": "E5", "commit": "abc1234", "command": "experiment E5 --trials 2", "mode": "default", "seed": 1,
      "out": "/somewhere/E5",
      "rendered": {"default": {"events": 2, "recovered_share": FIGURE, "median_s": FIGURE, "p90_s": dict(FIGURE, value=None, high=None),
                                "position_error_m": {"value": 0.0123456, "low": 0.01, "high": 0.02},
                                "cpu_ms_mean": 0.3, "better_than_published": True},
                    "published": {"position_error_m": 0.118, "heading_error_deg": 2.1},
                    "gaze_requests": 3, "seeds": [1001, 1002], "took_s": 5.0}}
STAT = {"mean": 0.5, "min": 0.0, "max": 1.0, "runs": 2}
E2 = {"experiment": "E2", "commit": "abc1234", "command": "experiment E2 --seeds 1..2", "mode": "default",
      "seeds": [1, 2], "over_seeds": {"memory": {"taken": STAT, "nearest_wall_m": dict(STAT, mean=0.456)}}}


class Tool(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def path(self, *names):
        return os.path.join(self.folder.name, *names)

    def result(self, data, name="result.json"):
        with open(self.path(name), "w", encoding="utf-8") as stream:
            stream.write(data if isinstance(data, str) else json.dumps(data))
        return self.path(name)

    def run_tool(self, *arguments):
        """@return exit code, standard output and standard error."""
        out, err = io.StringIO(), io.StringIO()
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
            code = results.main(["--root", self.folder.name, *arguments])
        return code, out.getvalue(), err.getvalue()

    def read(self, name):
        with open(self.path("docs", "results", name), encoding="utf-8") as stream:
            return stream.read()

    def test_figures_with_intervals_become_a_table_of_methods(self):
        self.assertEqual(self.run_tool("add", self.result(E5))[0], 0)
        text = self.read("E5.md")
        self.assertIn("| variant | method | events | recovered [%] |", text)
        self.assertIn("| `rendered` | `default` | 2 | 50.0 (25.0 to 75.0) | 0.5 (0.2 to 0.8) | never (0.2 to never) |", text)
        self.assertIn("1.2 (1.0 to 2.0)", text)
        self.assertIn("| `rendered` | `published` | - | - |", text)
        self.assertIn("`experiment E5 --trials 2`, default mode, seeds of the runs rendered: 1001 to 1002, commit `abc1234`.", text)
        self.assertIn("do not edit", text)
        self.assertIn("with the figures that it published", text)
        self.assertIn("[E5](E5.md)", self.read("index.md"))

    def test_data_hold_the_figures_of_the_tables_only(self):
        self.run_tool("add", self.result(E5))
        text = self.read("data/E5.json")
        data = json.loads(text)
        self.assertEqual(data["figures"]["rendered"]["default"]["position_error_m"]["value"], 0.01235)
        self.assertEqual(data["figures"]["rendered"]["seeds"], [1001, 1002])
        for absent in ("cpu_ms_mean", "took_s", "/somewhere", "gaze_requests"):
            self.assertNotIn(absent, text)

    def test_statistics_over_seeds(self):
        self.run_tool("add", self.result(E2))
        text = self.read("E2.md")
        self.assertIn("| `memory` | 1 of 2 | 0.46 (0.00 to 1.00) |", text)
        self.assertIn("seeds 1 to 2", text)
        self.assertNotIn("wall touched", text, "a column without any figure")
        self.assertNotIn("published", text)

    def test_the_data_of_each_variant_gaze_and_mode_have_a_name(self):
        for command, mode, name in (("experiment E6 --variant room", "default", "E6-room"),
                                    ("experiment E6 --variant=room --gaze both", "chapter", "E6-gaze-room-chapter")):
            data = dict(E5, experiment="E6", command=command, mode=mode)
            self.assertEqual(self.run_tool("add", self.result(data))[1], f"docs/results/data/{name}.json\n")
        text = self.read("E6.md")
        self.assertIn("## E6-room\n", text)
        self.assertIn("## E6-gaze-room-chapter\n", text)

    def test_detectors_of_every_image(self):
        image = {"image": "room", "detectors": {"solis": {"segments": 29, "recall_2px": 0.99}},
                 "merging": {"chapter": {"before": {"labelled": 50, "unknown": 1}, "after": {"labelled": 30, "unknown": 1}}}}
        data = {"experiment": "E9", "commit": "abc1234", "command": "experiment E9", "mode": "default", "seed": 1,
                "images": [image], "absent": []}
        self.run_tool("add", self.result(data))
        text = self.read("E9.md")
        self.assertIn("| `room` | `solis` | 29 | 0.990 |", text)
        self.assertIn("| `room` | `chapter, after` | 30 | 1 |", text)

    def test_a_line_of_evaluate(self):
        line = {"mode": "default", "seed": 7, "frames": 600, "memory_segments": 70, "position_error_m": 0.0034,
                "robot_s": 60.0}
        file = self.result(line, "corridor.json")
        code, _, err = self.run_tool("add", file)
        self.assertEqual(code, 2)
        self.assertIn('corridor.json: key "commit": null (expected a text, or --commit)', err)
        self.assertEqual(self.run_tool("add", "--commit", "abc1234", "--command", "evaluate --seed 7", file)[0], 0)
        self.run_tool("add", "--commit", "abc1234", "--command", "evaluate --seed 8", self.result(line, "room.json"))
        text = self.read("evaluate.md")
        self.assertIn("- room: `evaluate --seed 8`, commit `abc1234`\n", text)
        self.assertIn("| `corridor` | default | 7 | 60.0 | 0.3 | 70 |\n| `room` | default", text, "one table")

    def test_the_check_finds_edited_absent_and_orphaned_pages(self):
        self.run_tool("add", self.result(E2))
        self.assertEqual(self.run_tool("--check")[0], 0)
        with open(self.path("docs/results/E2.md"), "a", encoding="utf-8") as stream:
            stream.write("better\n")
        os.remove(self.path("docs/results/index.md"))
        with open(self.path("docs/results/E3.md"), "w", encoding="utf-8") as stream:
            stream.write("# E3\n")
        code, _, err = self.run_tool("--check")
        self.assertEqual(code, 1)
        self.assertIn("docs/results/E2.md: not what its data give", err)
        self.assertIn("docs/results/index.md: absent", err)
        self.assertIn("docs/results/E3.md: no data for this page", err)

    def test_a_picture_lies_beside_its_data(self):
        with open(self.path("plan.png"), "wb") as stream:
            stream.write(b"picture")
        self.assertEqual(self.run_tool("add", "--picture", self.path("plan.png"), self.result(E2))[0], 0)
        self.assertIn("![E2: A curve ahead, E2](data/E2.png)", self.read("E2.md"))
        self.assertEqual(self.run_tool("add", "--picture", self.path("plan.gif"), self.result(E2))[0], 2)

    def test_wrong_input_is_named(self):
        for data, message in (("{\n\"a\": }", "result.json:2: Expecting value (expected JSON)"),
                              ([1], "result.json: list (expected an object)"),
                              (dict(E2, experiment="E99"), 'key "experiment": "E99" (expected one of E1, E2'),
                              (dict(E2, commit=None), 'key "commit": null (expected a text, or --commit)'),
                              (dict(E2, over_seeds={}), "no figures of E2")):
            code, _, err = self.run_tool("add", self.result(data))
            self.assertEqual(code, 2)
            self.assertIn(message, err)
        code, _, err = self.run_tool("add", self.path("nowhere.json"))
        self.assertIn("nowhere.json: No such file", err)
        self.assertEqual(code, 2)


if __name__ == "__main__":
    unittest.main()
