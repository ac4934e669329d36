"""A robot of one's own: where its files are, and how far its steps are."""
import contextlib
import json
import math
import os
import re
import shutil

from setup_files import Failure, key_of, locked, read_text, say, value_of, write_locked
from steps import TABLE

NOT_NEEDED = "not for a simulated robot: its lens and mounting are those of its setup"


def bags_in(folder):
    """The parts of a recording; .active: one that a power failure cut off."""
    return [os.path.join(folder, file) for file in sorted(os.listdir(folder)) if file.endswith((".bag", ".bag.active"))]


class Robot:
    def __init__(self, name):
        self.name = name
        self.setup, self.out = f"cfg/{name}", f"out/own_robot/{name}"
        self.board = f"{self.out}/board/board.json"
        self.drive, self.palette, self.map = f"{self.out}/drive", f"{self.out}/colours/colours.palette", f"{self.out}/map"
        self.verdict = f"{self.out}/localize/verdict.json"

    @property
    def simulated(self):
        return os.path.exists(f"{self.setup}/simulator.cfg")

    @property
    def uncalibrated(self):
        """A simulated robot that differs from its description."""
        return self.simulated and bool(value_of(f"{self.setup}/simulator.cfg", "Simulator.Camera.Calibration"))

    @property
    def not_needed(self):
        """Steps that are left out."""
        return ("target", "ruler", "lens", "body") if self.simulated and not self.uncalibrated else ()

    @property
    def lens(self):
        """The file of a lens that was measured; that in the setup may be a data sheet's."""
        return f"{self.out}/lens/camera.yaml" if self.uncalibrated else f"{self.setup}/camera.yaml"

    def place(self, text):
        """A text of the steps' table with the folders of this robot."""
        return text.format(setup=self.setup, out=self.out)

    def how(self, step):
        return self.place(step.how) + ("" if self.simulated else step.how_real)

    @contextlib.contextmanager
    def alone(self, step):
        """One step of a robot at a time, of the page and of all terminals: they write the same files."""
        path = f"{self.out}/running"
        file = locked(path)
        if file is None:
            raise Failure(f"{read_text(path).strip()} of {self.name} runs already, in a terminal or on the page: one step at a time")
        with file:
            write_locked(file, f"{step} (process {os.getpid()})")
            yield

    def comes_first(self, step):
        return Failure(f"{step} comes first: scripts/own_robot {self.name} {step}")

    def file_of(self, key):
        """The file of the setup that has a key of this component."""
        files = os.listdir(self.setup) if os.path.isdir(self.setup) else []
        name = key.split(".")[0].lower()
        return next((f"{self.setup}/{file}" for file in files if file.endswith(".cfg") and file[:-4].replace("_", "") == name), None)

    def state_name(self, port_offset):
        """Of what runs, as scripts/start calls it."""
        return self.name + (f"+{port_offset}" if port_offset else "")

    def make_setup(self, source="robot"):
        if os.path.exists(self.setup):
            return
        shutil.copytree(f"cfg/{source}", self.setup)
        for file in sorted(os.listdir(self.setup)):
            path = os.path.join(self.setup, file)
            text = read_text(path).replace(f"cfg/{source}/", f"{self.setup}/")
            with open(path, "w", encoding="utf-8") as stream:
                stream.write(text.replace(f"GuiServer.Setup = {source}\n", f"GuiServer.Setup = {self.name}\n"))
        say(f"{self.setup} is a copy of cfg/{source}.")

    def cameras(self):
        keys = map(key_of, read_text(f"{self.setup}/recorder.cfg").splitlines())
        return {key.split(".")[2] for key in keys if key and re.fullmatch(r"Recorder\.Cameras\.\w+\.Proxy", key)}

    def route(self, world=None):
        """Of a simulated world: "closed" or "open", its points as X,Y, and its length, of an open one to and fro."""
        world = world or value_of(f"{self.setup}/simulator.cfg", "Simulator.World")
        file = os.path.splitext(world)[0] + ".route"
        if not os.path.isfile(file):
            raise Failure(f"{file}: no such file (expected the route of the world {world})", 2)
        lines = [line.strip() for line in read_text(file).splitlines() if line.strip() and not line.startswith("#")]
        way, points = lines[0], [line for line in lines[1:] if not line.startswith("x_m")]
        at = [tuple(map(float, point.split(","))) for point in points]
        legs = list(zip(at, at[1:]))
        legs += [(at[-1], at[0])] if way == "closed" else list(legs)
        return way, points, sum(math.dist(a, b) for a, b in legs)

    def bags(self):
        """The parts of the drive, as one argument. By file: a folder would bring the configuration of its time along."""
        if not os.path.exists(self.drive):
            raise self.comes_first("drive")
        return ",".join(bags_in(self.drive))


def age(path):
    """When a file, or a link, was made; 0 if there is none."""
    return os.lstat(path).st_mtime if os.path.lexists(path) else 0


def is_localized(robot):
    with contextlib.suppress(OSError, ValueError):  # none, or one that a full disk cut off
        return json.loads(read_text(robot.verdict)).get("localized", False)
    return False


def states_of(robot):
    """Of each step: its name, "done", "old" (what it was made from is newer), "none" (it is not needed) or "-", and what it is about."""
    ruler = os.path.exists(robot.board) and "ruler_mm" in read_text(robot.board)
    own_map = age(f"{robot.setup}/map.csv")
    old = {"map": own_map < max(age(robot.drive), age(robot.palette)), "localize": age(robot.verdict) < own_map}
    done = {"start": os.path.exists(robot.setup), "target": os.path.exists(robot.board), "ruler": ruler, "lens": os.path.exists(robot.lens),
            "body": os.path.exists(f"{robot.out}/body/report.json"), "drive": os.path.exists(robot.drive),
            "colours": os.path.exists(robot.palette), "map": own_map, "localize": is_localized(robot)}
    return [(step.name, "none", NOT_NEEDED) if step.name in robot.not_needed else
            (step.name, "-" if not done[step.name] else "old" if old.get(step.name) else "done", robot.how(step))
            for step in TABLE if step.is_step]


def next_step(robot):
    """The first step that is not done, or old; or None. With a drive, such as a recording, nobody calibrates any more."""
    steps = states_of(robot)
    names, states = [step for step, _, _ in steps], {step: state for step, state, _ in steps}
    first = names.index("drive") if states["drive"] == "done" else 0
    return next((step for step in names[first:] if states[step] in ("-", "old")), None)


def next_command(robot):
    following = next_step(robot)
    if following:
        return f"scripts/own_robot {robot.name} {following}" + (" ACROSS UP" if following == "ruler" and not robot.uncalibrated else "")
    return f"scripts/run --setup {robot.name}" if robot.simulated else f"scripts/start {robot.name}"


def missing_before(robot, step, given=()):
    """Steps that come first and are not done. @param given arguments of this one."""
    if set(step.unless) & set(given):
        return []
    states = {name: state for name, state, _ in states_of(robot)}
    lens = ("lens",) if step.name == "body" and robot.uncalibrated else ()
    return [before for before in (*step.after, *lens) if states[before] == "-"]
