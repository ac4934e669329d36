#!/usr/bin/python3
"""own_robot_test.py BIN_DIR: the wizard scripts/own_robot in a copy of the project's cfg/: a simulated robot and a recording
from the first step to a localized robot, and what it says about wrong input."""
import csv
import glob
import json
import math
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BIN = os.path.abspath(sys.argv.pop(1))
DATA = os.environ.get("AVM_DATA", os.path.join(ROOT, "..", "shared", "data"))
sys.path.insert(0, os.path.join(ROOT, "scripts", "wizard"))
sys.dont_write_bytecode = True
from rigid_motion import best_motion, matched  # noqa: E402
from setup_files import value_of  # noqa: E402
from simulated_robot import draw, true_camera  # noqa: E402
from verdict import judge, read_poses, turned  # noqa: E402

PORTS = (9970, 9971, 9972, 9977, 9990, 9992, 9997, 9999, 11000, 11001, 11002, 11003, 11004, 11005, 11006, 11008)


def free_port_offset():
    for offset in range(20000 + os.getpid() % 1000, 50000, 1000):
        try:
            for port in PORTS:
                with socket.socket() as probe:
                    probe.bind(("127.0.0.1", port + offset))
            return offset
        except OSError:
            continue
    raise AssertionError("no free ports")


def aligned_errors(estimate, truth):
    """RMS of the distance [m] and largest angle [rad] after the best rigid motion."""
    pairs = matched(estimate, truth)
    motion = best_motion(pairs)
    squares = [abs(motion.apply(at) - true_at) ** 2 for _, at, _, true_at, _ in pairs]
    return (math.sqrt(sum(squares) / len(squares)),
            max(abs(turned(heading + motion.turn - true_heading)) for _, _, heading, _, true_heading in pairs))


def mean_reliability(races):
    """Of the most reliable race of each image."""
    best = {}
    with open(races, encoding="utf-8") as file:
        for row in csv.DictReader(file):
            best[row["t_s"]] = max(best.get(row["t_s"], 0.0), float(row["reliability"] or 0.0))
    return sum(best.values()) / len(best)


class Wizard(unittest.TestCase):
    def setUp(self):
        self.root = self.enterContext(tempfile.TemporaryDirectory(prefix="vismem_own_robot_"))
        shutil.copytree(os.path.join(ROOT, "cfg"), os.path.join(self.root, "cfg"))
        for name in ("scripts", "components"):
            os.symlink(os.path.join(ROOT, name), os.path.join(self.root, name))
        self.bin = self.path("build/release/bin")
        os.makedirs(self.bin)
        for name in os.listdir(BIN):
            os.symlink(os.path.join(BIN, name), os.path.join(self.bin, name))

    def path(self, name):
        return os.path.join(self.root, name)

    def write(self, name, text):
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)

    def replace_program(self, name, script):
        """By a shell script."""
        path = os.path.join(self.bin, name)
        if os.path.lexists(path):
            os.remove(path)
        with open(path, "w", encoding="utf-8") as file:
            file.write("#!/bin/sh\n" + script)
        os.chmod(path, 0o755)

    def read(self, name):
        with open(self.path(name), encoding="utf-8") as file:
            return file.read()

    def step(self, *arguments, code=0):
        """@return output and errors of the wizard for the robot `mine`."""
        done = subprocess.run([self.path("scripts/own_robot"), "mine", *arguments], stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              stdin=subprocess.DEVNULL, text=True)
        self.assertEqual(done.returncode, code, f"{arguments}\n{done.stdout}")
        return done.stdout

    def steps_done(self):
        return {line.split()[0] for line in self.step().splitlines() if re.match(r"\w+ +done", line)}


class WrongInput(Wizard):
    def test_a_missing_step_is_named(self):
        for step, first in (("ruler", "target"), ("lens", "target"), ("body", "target"), ("map", "drive"), ("colours", "drive"),
                            ("localize", "map")):
            self.assertIn(f"own_robot: {first} comes first: scripts/own_robot mine {first}", self.step(step, code=1))
        self.assertEqual(self.steps_done(), set())
        self.assertIn("next: scripts/own_robot mine start", self.step())

    def test_wrong_arguments_are_named_with_what_is_expected(self):
        self.assertIn("--simulated moon: no such world (expected an SDF file or one of alike_wings corridor", self.step("start", "--simulated", "moon", code=2))
        self.assertIn("found --fast", self.step("start", "--fast", code=2))
        self.assertIn("--bag none.bag: no such file (expected a ROS 1 bag", self.step("drive", "--bag", "none.bag", code=2))
        self.assertIn("cfg: a folder without a bag", self.step("drive", "--bag", "cfg", code=2))
        self.assertIn("--seconds: found -3 (expected a number above 0)", self.step("drive", "--seconds", "-3", code=2))
        os.makedirs(self.path("out/own_robot/mine/board"))
        self.write("out/own_robot/mine/board/board.json", "{}")
        for lengths in ((), ("100",), ("100", "9,5"), ("100", "99.5", "3")):
            self.assertIn(f"ruler: found {' '.join(lengths) or 'nothing'} (expected ACROSS UP [mm]", self.step("ruler", *lengths, code=2))
        self.assertIn("--palette none: no such file", self.step("colours", "--palette", "none", code=2))
        self.assertIn("unknown step 'jump' (must be one of start, devices, target, ruler", self.step("jump", code=2))
        self.assertIn("start comes first", self.step("drive", "--no-gui", code=1))  # a misspelt name makes no setup
        self.assertFalse(os.path.exists(self.path("cfg/mine")))

    def test_files_that_cannot_be_used_change_nothing(self):
        self.write("wrong", "a wrong file\n")
        self.assertIn('wrong:1: "a wrong file" (must be KEY = VALUE)', self.step("colours", "--palette", "wrong", code=2))
        self.assertEqual(self.step("drive", "--bag", "wrong", code=1).count("wrong: not a ROS 1 bag"), 1, "by the name that was given, once")
        self.assertFalse(os.path.exists(self.path("out/own_robot/mine/drives")))
        self.assertEqual(self.steps_done(), set())

    def test_a_palette_that_was_not_learnt_changes_nothing(self):
        os.makedirs(self.path("out/own_robot/mine/drive"))
        for script in ("echo half > $4; exit 1\n", "exit 0\n"):
            self.replace_program("learn_palette", script)
            said = self.step("colours", code=1)
            self.assertIn("no palette was learnt from the drive", said)
            self.assertIn("--palette FILE", said)
        self.replace_program("learn_palette", "exit 2\n")
        self.step("colours", code=2)
        self.assertEqual(self.steps_done(), {"drive"})

    def test_the_program_of_a_step_that_is_stopped_may_end(self):
        os.makedirs(self.path("out/own_robot/mine/drive"))
        self.replace_program("learn_palette", f"trap 'kill $!; sleep 1; touch {self.root}/ended; exit 1' TERM\ntouch {self.root}/began\nsleep 60 & wait\n")
        step = subprocess.Popen([self.path("scripts/own_robot"), "mine", "colours"], stdin=subprocess.DEVNULL)
        while not os.path.exists(self.path("began")):
            self.assertIsNone(step.poll())
            time.sleep(0.05)
        step.terminate()
        self.assertEqual(step.wait(30), 128 + signal.SIGTERM)
        self.assertTrue(os.path.exists(self.path("ended")))

    def test_a_drive_without_a_map_changes_nothing(self):
        os.makedirs(self.path("out/own_robot/mine/drive"))
        self.step("colours", "--palette", "cfg/maps/corridor.palette")
        before = self.read("cfg/mine/localization.cfg")
        self.replace_program("map_from_drive", "echo 'map_from_drive: no edge' >&2; echo '{\"problems\": []}'; exit 1\n")
        self.assertIn("No usable map: cfg/mine stays as it is", self.step("map", code=1))
        self.assertEqual(self.read("cfg/mine/localization.cfg"), before)
        self.assertFalse(os.path.exists(self.path("cfg/mine/map.csv")))

    def test_edges_that_do_not_border_the_floor_stand_up(self):
        key = "ActiveVisualMemory.Ground.OffFloorLabels"
        self.write("my.palette", "class.floor = value 0..30  # grey\nclass.wall = value 31..60\nclass.door = value 61..100\n"
                   "pair.skirting = floor wall\npair.frame = wall door\n")
        self.step("colours", "--palette", "my.palette")
        self.assertIn(f"{key} = frame\n", self.read("cfg/mine/active_visual_memory.cfg"))
        self.assertIn(f"{key} = door_jamb door2_jamb\n", self.read("cfg/mine/active_visual_memory.cfg.old"))
        self.assertIn(f"no class floor: set {key}", self.step("colours", "--palette", "cfg/maps/field_6x4.palette"))
        self.assertIn(f"{key} = frame\n", self.read("cfg/mine/active_visual_memory.cfg"))

    def test_setups_of_the_project_are_no_robots_of_ones_own(self):
        for name in os.listdir(os.path.join(ROOT, "cfg")):
            tracked = subprocess.run(["git", "-C", ROOT, "ls-files", "--error-unmatch", f"cfg/{name}"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            if tracked.returncode == 0:
                done = subprocess.run([self.path("scripts/own_robot"), name, "map"], stderr=subprocess.PIPE, text=True)
                self.assertEqual((done.returncode, done.stderr), (2, f"own_robot: cfg/{name} belongs to the project (expected a name of your own)\n"))

    def test_a_step_without_a_name_is_not_taken_for_a_name(self):
        for step in ("page", "drive"):
            done = subprocess.run([self.path("scripts/own_robot"), step], capture_output=True, text=True)
            self.assertEqual((done.returncode, done.stderr), (2, f"own_robot: {step} is a step (expected a name before it: scripts/own_robot NAME {step})\n"))

    def test_a_described_simulated_robot_has_nothing_to_calibrate(self):
        self.assertIn("next: scripts/own_robot mine drive", self.step("start", "--simulated"))
        for step in ("target", "ruler", "lens", "body"):
            self.assertIn(f"{step} is not for a simulated robot", self.step(step, code=1))

    def test_a_setup_is_not_overwritten(self):
        self.assertIn("next: scripts/own_robot mine target", self.step("start"))
        self.assertIn("GuiServer.Setup = mine", self.read("cfg/mine/gui_server.cfg"))
        self.assertIn("cfg/mine exists already", self.step("start", "--simulated", code=1))
        self.assertFalse(os.path.exists(self.path("cfg/mine/simulator.cfg")))


class RobotWithServers(Wizard):
    """Camera, joints and base are components of their own, as on a real robot."""

    def setUp(self):
        super().setUp()
        shutil.copytree(self.path("cfg/files"), self.path("cfg/mine"))
        self.offset = str(free_port_offset())

    def test_ctrl_c_ends_the_drive(self):
        with subprocess.Popen([self.path("scripts/own_robot"), "mine", "drive", "--no-gui", "--port-offset", self.offset],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True) as drive:
            for line in drive.stdout:
                if re.match(r"recording: .* [1-9]\d* images", line):
                    drive.send_signal(signal.SIGINT)
                    break
            rest = drive.stdout.read()
        self.assertEqual(drive.returncode, 0, rest)
        self.assertRegex(rest, r"Drive: \d{1,2} s, \d+ images of 320 x 240")
        self.assertFalse(os.path.exists(self.path(f"out/mine+{self.offset}/pids")), "all that was started has ended")
        self.assertEqual(self.steps_done(), {"start", "drive"})

    def test_ctrl_c_before_it_records_leaves_nothing_running(self):
        self.replace_program("recorder", "sleep 60\n")  # it never becomes ready
        with subprocess.Popen([self.path("scripts/own_robot"), "mine", "drive", "--no-gui", "--port-offset", self.offset],
                              stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, start_new_session=True) as drive:
            pids = self.path(f"out/mine+{self.offset}/pids")
            while not (os.path.exists(pids) and "recorder" in self.read(pids)):
                time.sleep(0.05)
            os.killpg(drive.pid, signal.SIGINT)  # as a terminal does
            said = drive.stderr.read()
        self.assertEqual(drive.returncode, 130, said)
        self.assertIn("drive was stopped before its end and can be repeated", said)
        self.assertFalse(os.path.exists(pids), said)

    def test_what_runs_already_goes_on(self):
        ports = ("--port-offset", self.offset)
        servers = ("camera_server", "pantilt_server", "base_server")
        subprocess.run([self.path("scripts/start"), "mine", *servers, "--no-build", *ports], check=True, stdout=subprocess.DEVNULL)
        self.addCleanup(subprocess.run, [self.path("scripts/stop"), f"mine+{self.offset}"], stdout=subprocess.DEVNULL)
        self.step("drive", "--no-gui", "--seconds", "3", *ports)
        with open(self.path(f"out/mine+{self.offset}/pids"), encoding="utf-8") as file:
            self.assertEqual({line.split()[1] for line in file}, set(servers))

    def test_a_component_that_does_not_start_is_named(self):
        self.write("cfg/mine/camera_server.cfg", self.read("cfg/mine/camera_server.cfg") + "CameraServer.Camera.cameraA.Speed = 3\n")
        said = self.step("drive", "--no-gui", "--seconds", "3", "--port-offset", self.offset, code=1)
        self.assertIn("CameraServer.Camera.cameraA.Speed", said)
        self.assertIn("the robot did not start", said)

    def test_the_lens_takes_the_place_of_the_stated_view(self):
        self.replace_program("calibrate", 'mkdir -p "$5" && echo "image_width: 320" > "$5/camera.yaml"\n')
        os.makedirs(self.path("out/own_robot/mine/board"))
        self.write("out/own_robot/mine/board/board.json", "{}")
        self.write("cfg/mine/camera_server.cfg", "A.Key = 1\nCameraServer.Camera.cameraA.HorizontalView_deg = 60\nB.Key = 2\n")
        self.step("lens", "--images", "views")
        self.assertEqual(self.read("cfg/mine/camera_server.cfg"),
                         "A.Key = 1\nB.Key = 2\nCameraServer.Camera.cameraA.Calibration = cfg/mine/camera.yaml\n")
        self.assertIn("HorizontalView_deg", self.read("cfg/mine/camera_server.cfg.old"))
        self.assertEqual(self.read("cfg/mine/camera.yaml"), "image_width: 320\n")


class SimulatedRobot(Wizard):
    def test_ends_with_a_setup_that_localizes(self):
        self.assertIn("Simulator.World = cfg/worlds/room.world", self.step("start", "--simulated", "room", "--seed", "3"))
        offset = free_port_offset()
        # The truth is recorded for this test alone: drive leaves it out.
        drive = self.step("drive", "--port-offset", str(offset), "--Simulator.Camera.Rate_hz=5", "--Recorder.Split.Size_MB=40",
                          f"--Recorder.Simulation.Proxy=Simulation:tcp -h 127.0.0.1 -p {9972 + offset}")
        self.assertRegex(drive, r"recording: \d+ of \d+ s, \d+ images")
        self.assertEqual(self.steps_done(), {"start", "drive"})
        self.assertGreater(len(glob.glob(self.path("out/own_robot/mine/drive/*.bag"))), 1, "a drive in parts")
        # Without the program that learns a palette, with the one of the world.
        learns = os.access(os.path.join(BIN, "learn_palette"), os.X_OK)
        self.step("colours", *([] if learns else ["--palette", "cfg/maps/room.palette"]))
        self.assertIn("next: scripts/own_robot mine map", self.step())

        made = self.step("map")
        again = re.search(r"A later visit saw (\d+) of them again\.", made)
        self.assertGreater(int(again.group(1)), 3, "the drive goes round and further, whatever joined its visits")
        self.assertIn("+Localization.Map = cfg/mine/map.csv", made)
        self.assertIn("Localization.Map = cfg/maps/corridor.csv", self.read("cfg/mine/localization.cfg.old"))
        self.assertEqual(self.read("cfg/mine/gui_server.cfg").count("GuiServer.Truth = no\n"), 1)
        for file, key in (("localization", "Localization.Palette"), ("active_visual_memory", "ActiveVisualMemory.Palette")):
            self.assertEqual(self.read(f"cfg/mine/{file}.cfg").count(f"{key} = cfg/mine/map.palette\n"), 1)

        self.assertIn("next: scripts/run --setup mine", self.step("localize"))
        results = self.path("out/own_robot/mine/localize")
        # Before it has seen enough, a pose may be at a place that looks alike: one image at 8 m is 0.4 m in the RMS.
        settled_after_s = json.loads(self.read(f"{results}/verdict.json"))["settled_after_s"]
        self.assertLess(settled_after_s, 5.0)
        poses = read_poses(f"{results}/trajectory.tum")
        settled = [pose for pose in poses if pose[0] >= poses[0][0] + settled_after_s]
        error_m, error_rad = aligned_errors(settled, read_poses(f"{results}/truth.tum"))
        self.assertLess(error_m, 0.10)
        self.assertLess(math.degrees(error_rad), 3.0)
        self.assertEqual(self.steps_done(), {"start", "drive", "colours", "map", "localize"})

        # The components accept the setup, and a new drive with them is localized too.
        self.assertIn("mine is localized", self.step("localize", "--live", "--seconds", "15", "--port-offset", str(offset),
                                                     "--Simulator.Camera.Rate_hz=5"))

        # The configurations that running components recorded are those of an evaluation, too.
        newest = max(glob.glob(self.path("out/own_robot/mine/drives/*")))
        self.assertTrue(os.path.exists(os.path.join(newest, "cfg", "localization.cfg")))
        evaluated = subprocess.run([os.path.join(BIN, "evaluate"), "--bag", newest, "--map", self.path("cfg/mine/map.csv"), "--out", self.path("again")],
                                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        self.assertEqual(evaluated.returncode, 0, evaluated.stdout)

        # A mirrored map is a map of another place.
        rows = [line.split(",") for line in self.read("cfg/mine/map.csv").splitlines()]
        with open(self.path("cfg/mine/map.csv"), "w", encoding="utf-8") as file:
            for row in rows:
                if re.fullmatch(r"[-0-9.]+", row[0]):
                    row[1], row[4] = (f"{-float(row[i])}" for i in (1, 4))
                file.write(",".join(row) + "\n")
        self.assertIn("next: scripts/own_robot mine localize", self.step())
        self.assertIn("mine is not localized", self.step("localize", code=1))
        # Of the whole drive: one image, such as the last, may be reliable at a place that looks alike.
        self.assertLess(mean_reliability(f"{results}/races.csv"), 0.3)
        self.assertNotIn("localize", self.steps_done())


class UncalibratedRobot(Wizard):
    """It differs from its description: the truth stands in simulator.cfg, which no step reads."""

    def truth(self, key):
        return [float(part) for part in value_of(self.path("cfg/mine/simulator.cfg"), f"Simulator.{key}").split()]

    def test_finds_the_lens_and_the_height(self):
        self.step("start", "--simulated", "room", "--seed", "3", "--uncalibrated")
        focal = self.truth("Camera.Pinhole_px")[0]
        self.assertGreater(abs(self.stated_focal() - focal), 2.0, "a data sheet is not exact")
        self.assertIn("next: scripts/own_robot mine ruler", self.step("target"))
        self.assertIn("next: scripts/own_robot mine lens", self.step("ruler"))
        ports = ("--port-offset", str(free_port_offset()))
        self.assertIn("lens comes first", self.step("body", "--write", *ports, code=1))
        self.assertIn("Written: out/own_robot/mine/lens/camera.yaml", self.step("lens", *ports))
        self.assertLess(abs(self.stated_focal() - focal), 1.0)
        self.assertEqual(self.steps_done(), {"start", "target", "ruler", "lens"})

        # Without driving, the tilt and the height are observable, the wheels are not.
        self.step("body", "--write", "--head-only", *ports)
        changed = self.read("cfg/mine/active_visual_memory.cfg")
        self.assertNotIn("Wheels.", changed)
        report = json.loads(self.read("out/own_robot/mine/body/report.json"))
        camera = true_camera(self.path("cfg/mine"))
        height = report["camera_at_zero"]["camera height"]
        self.assertLess(abs(1e-3 * height["value"] - camera[1][2]), 0.005)
        self.assertFalse(os.path.exists(self.path(f"out/mine+{ports[1]}/pids")), "the simulator has ended")

    def stated_focal(self):
        return float(re.search(r"data: \[([0-9.]+)", self.read("cfg/mine/camera.yaml")).group(1))

    def test_robots_differ_by_their_seed(self):
        self.assertNotEqual(draw(1), draw(2))
        self.assertEqual(draw(1), draw(1))
        self.assertIn("--uncalibrated needs --simulated", self.step("start", "--uncalibrated", code=2))


@unittest.skipUnless(os.path.isdir(os.path.join(DATA, "room_path_traced")), "no recording room_path_traced at AVM_DATA")
class Recording(Wizard):
    def test_a_recording_takes_the_place_of_a_drive(self):
        room = os.path.join(DATA, "room_path_traced")
        self.assertIn("150 images of 320 x 240", self.step("drive", "--bag", os.path.join(room, "wheels_b.bag")))
        self.step("colours", "--palette", os.path.join(room, "map.palette"))
        self.assertIn("Note: no place was found again", self.step("map"))
        self.assertTrue(self.read("cfg/mine/map.history").startswith("history 1\n"))
        self.assertIn("mine is localized", self.step("localize"))
        # Another drive: its map is still to be made, the drive before is not lost.
        said = self.step("drive", "--bag", os.path.join(room, "wheels_a.bag"))
        self.assertIn("next: scripts/own_robot mine map", said)
        map_before = self.read("cfg/mine/map.csv")
        self.assertIn("The one before: cfg/mine/map.csv.old", self.step("map"))
        self.assertEqual(self.read("cfg/mine/map.csv.old"), map_before)
        before = re.search(r"drive --bag (\S+) takes it again", said).group(1)
        self.assertIn("150 images", self.step("drive", "--bag", before))
        # Of the same room with other wheels.
        self.assertIn("mine is localized", self.step("localize", "--bag", os.path.join(room, "wheels_a.bag")))


    def test_a_recording_that_was_cut_off_is_said_to_be(self):
        room = os.path.join(DATA, "room_path_traced", "wheels_a.bag")
        if not os.path.exists(room):
            self.skipTest(f"{room} is not here: set AVM_DATA")
        with open(room, "rb") as whole, open(self.path("cut.bag"), "wb") as cut:
            cut.write(whole.read(300000))
        said = self.step("drive", "--bag", "cut.bag")
        self.assertIn("the index is missing or damaged, as of a recording that was cut off", said)
        self.assertIn("Drive: 2 s, 10 images", said)


class Verdict(unittest.TestCase):
    def setUp(self):
        self.folder = self.enterContext(tempfile.TemporaryDirectory())

    def verdict(self, poses, reliability=0.9, path=None):
        """Of a robot whose odometry says 0.3 m/s straight on for 30 s."""
        odometry = [(t / 10, 0.03 * t, 0.0, 0.0) for t in range(301)]
        for name, rows in (("odometry", odometry), ("trajectory", poses)):
            with open(os.path.join(self.folder, name + ".tum"), "w", encoding="utf-8") as file:
                file.writelines(f"{t} {x} {y} 0 0 0 {math.sin(a / 2)} {math.cos(a / 2)}\n" for t, x, y, a in rows)
        return judge({"reliability": reliability}, self.folder, path)

    @staticmethod
    def upwards(jump_s=None):
        """Along y; it jumps by a metre at this time."""
        return [(t / 10, 1.0 if jump_s is not None and t / 10 >= jump_s else 0.0, 0.03 * t, math.pi / 2) for t in range(301)]

    def test_a_pose_that_follows_the_odometry_is_localized(self):
        self.assertTrue(self.verdict(self.upwards())["localized"])

    def test_a_late_jump_is_not(self):
        self.assertTrue(self.verdict(self.upwards(15.0))["localized"])
        late = self.verdict(self.upwards(25.0))
        self.assertIn("jumped 5.0 s before the end (expected 10 s", late["reasons"][0])

    def test_an_uncertain_pose_is_not(self):
        self.assertIn("reliability at the end is 0.59", self.verdict(self.upwards(), 0.59)["reasons"][0])

    def test_a_twin_place_is_not(self):
        twin = [(t, -x, -y, turned(a + math.pi)) for t, x, y, a in self.upwards()]
        self.assertFalse(self.verdict(twin, path=self.upwards())["localized"])
        self.assertTrue(self.verdict(self.upwards(), path=self.upwards())["localized"])

    def test_no_pose_is_not(self):
        self.assertEqual(self.verdict([])["reasons"], ["no image has a pose"])


if __name__ == "__main__":
    unittest.main()
