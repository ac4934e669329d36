"""scripts/reliability_series: which poses are right, how errors are normalised, what is summed over runs."""
import importlib.machinery
import importlib.util
import math
import os
import sys
import tempfile
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
sys.dont_write_bytecode = True
loader = importlib.machinery.SourceFileLoader("reliability_series", os.path.join(ROOT, "scripts", "reliability_series"))
series = importlib.util.module_from_spec(importlib.util.spec_from_loader("reliability_series", loader))
loader.exec_module(series)

HEAD = "t_s,race,x_m,y_m,theta_rad,health,weight,victories,age,reliability,xx_m2,xy_m2,yy_m2,xt_mrad,yt_mrad,tt_rad2\n"
TRUTH = [(0.0, 1.0, 0.0, 3.1), (1.0, 2.0, 0.0, -3.1)]


class Score(unittest.TestCase):
    def score(self, rows, has_twin=False, is_mirrored=False):
        with tempfile.NamedTemporaryFile("w", suffix=".csv", delete=False) as stream:
            stream.write(HEAD + rows)
        self.addCleanup(os.remove, stream.name)
        return series.score(stream.name, TRUTH, has_twin, is_mirrored)

    def test_a_right_pose_counts_with_its_normalised_error(self):
        # At 0.5 s the truth is (1.5, 0, pi): the heading is interpolated across the wrap. Error 0.1 m in x, 2 sigma of 0.05 m.
        sums = self.score(f"0.5,1,1.6,0,{math.pi},1,1,9,9,0.95,0.0025,0,0.0025,0,0,0.01\n")
        self.assertEqual(sums["bins"][9], [1, 0.95, 1])
        self.assertAlmostEqual(sums["square"], 4.0)
        self.assertEqual((sums["near"], sums["chosen"]), (1, 1))

    def test_a_wrong_winner_beside_a_right_race(self):
        sums = self.score(f"0.5,1,1.5,0.3,{math.pi},1,0.7,9,9,0.7,0.01,0,0.01,0,0,0.01\n0.5,2,1.5,0.1,{math.pi},1,0.3,0,9,,,,,,,\n")
        self.assertEqual(sums["bins"][7], [1, 0.7, 0])
        self.assertEqual((sums["near"], sums["chosen"], sums["squares"]), (1, 0, 0))

    def test_the_twin_counts_where_there_is_one(self):
        row = "0.5,1,2.4,0,0,1,1,9,9,0.5,0.01,0,0.01,0,0,0.01\n"
        self.assertEqual(self.score(row)["chosen"], 0)
        self.assertEqual(self.score(row, has_twin=True)["chosen"], 1)

    def test_nothing_is_right_in_a_mirrored_map(self):
        sums = self.score(f"0.5,1,1.5,0,{math.pi},1,1,9,9,0.95,0.01,0,0.01,0,0,0.01\n", is_mirrored=True)
        self.assertEqual((sums["bins"][9][2], sums["near"], sums["chosen"], sums["squares"]), (0, 0, 0, 0))

    def test_maps_change_as_their_data_set_says(self):
        with tempfile.TemporaryDirectory() as folder:
            source, changed = os.path.join(folder, "map.csv"), os.path.join(folder, "changed.csv")
            rows = "x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,label\n" + "".join(f"{i},1.5,0,{i},-2,0,skirting\n" for i in range(30))
            with open(source, "w", encoding="utf-8") as stream:
                stream.write(rows)
            lines = {}
            for kind in ("mirrored room", "room, map lacks a third"):
                series.write_changed_map(source, changed, kind, 1)
                with open(changed, encoding="utf-8") as stream:
                    lines[kind] = stream.read().splitlines()
        self.assertEqual(lines["mirrored room"][:2], [rows.splitlines()[0], "0,-1.5,0,0,2.0,0,skirting"])
        self.assertTrue(12 <= len(lines["room, map lacks a third"]) - 1 <= 26)

    def test_estimates_without_a_truth_do_not_count(self):
        self.assertEqual(self.score("5.0,1,1.5,0,3.1,1,1,9,9,0.5,0.01,0,0.01,0,0,0.01\n")["poses"], 0)

    def test_correlated_errors_are_decorrelated(self):
        # P = [[2, 1, 0], [1, 2, 0], [0, 0, 1]]: e^T P^-1 e of (1, 1, 1) is 2/3 + 1.
        self.assertAlmostEqual(series.normalised_square((1, 1, 1), [2, 1, 2, 0, 0, 1]), 5.0 / 3.0)
        self.assertIsNone(series.normalised_square((1, 1, 1), [1, 2, 1, 0, 0, 1]), "not positive definite")

    def test_figures_sum_over_runs(self):
        run = {"bins": [[0, 0.0, 0] for _ in range(10)], "square": 12.0, "squares": 1, "poses": 4, "near": 2, "chosen": 1}
        run["bins"][9] = [2, 1.9, 1]
        figures = series.figures_of([run, run])
        self.assertEqual((figures["runs"], figures["poses"], figures["near_share"], figures["chosen_share"]), (2, 8, 0.5, 0.25))
        self.assertAlmostEqual(figures["normalised_error"], 2.0)
        self.assertAlmostEqual(figures["calibration_error"], 0.45)
        self.assertEqual(figures["bins"], {"0.9 to 1.0": {"poses": 4, "reliability": 0.95, "right_share": 0.5}})


if __name__ == "__main__":
    unittest.main()
