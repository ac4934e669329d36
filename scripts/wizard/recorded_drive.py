"""A drive of the robot, recorded by its component recorder."""
import contextlib
import json
import os
import signal
import subprocess
import sys
import time

from programs import BIN, running_components
from setup_files import Failure, say, value_of


SPEED_MPS = 0.3  # of the simulated drive
OVERLAP_M = 10.0  # beyond one round: a place counts as found again by two closings a metre apart
TURNS = 1.25  # a drive takes this many times its length at SPEED_MPS: it slows down to turn
SILENCE_S = 30.0  # without an image a drive fails


class Drive:
    """A recording of the robot while it drives. Components that run already go on afterwards."""

    def __init__(self, robot, folder, options, arguments):
        self.robot, self.folder, self.options = robot, folder, options
        self.arguments = list(arguments)
        self.state = robot.state_name(options.port_offset)
        self.rate_hz = 0.0
        self.started = []

    def components(self, localizes):
        names = ["simulator", "camera_server", "pantilt_server", "base_server", "active_visual_memory"]
        names += ["localization"] if localizes else []
        names += [] if self.robot.simulated or self.options.no_gui else ["gui_server"]
        return [name for name in names if os.path.exists(f"{self.robot.setup}/{name}.cfg")]

    def start(self, localizes):
        running = running_components(self.state)
        if "recorder" in running or (self.robot.simulated and running):
            raise Failure(f"{', '.join(sorted(running))} of {self.state} runs already: scripts/stop {self.state} first")
        if not os.path.exists(f"{self.robot.setup}/recorder.cfg"):
            raise Failure(f"{self.robot.setup}/recorder.cfg: no such file (expected as in cfg/robot: it records the drive)")
        names = [name for name in self.components(localizes) if name not in running] + ["recorder"]
        arguments = [f"--Recorder.Folder={os.path.dirname(self.folder)}", f"--Recorder.Name={os.path.basename(self.folder)}",
                     "--Recorder.Map=", *self.simulated_drive(), *self.arguments]
        if self.options.port_offset:
            arguments += ["--port-offset", str(self.options.port_offset)]
        # The server of the page does not show whether the page is built.
        if "gui_server" not in names and all(os.access(os.path.join(BIN, name), os.X_OK) for name in names):
            arguments.append("--no-build")
        self.started = names
        done = subprocess.run(["scripts/start", self.robot.name, *names, *arguments], stdout=subprocess.PIPE, text=True)
        if done.returncode != 0:
            self.started = []  # scripts/start ends what it began
            raise Failure("the robot did not start: see above", done.returncode)
        for line in done.stdout.splitlines():
            if line.startswith("page "):
                say(line)

    def simulated_drive(self):
        """A simulated operator drives along the route of the world. Time waits for memory and recorder, so that a busy
        computer takes longer and loses nothing."""
        if not self.robot.simulated:
            return []
        way, points, length_m = self.robot.route()
        if self.options.seconds is None:
            self.options.seconds = TURNS * (length_m + OVERLAP_M) / SPEED_MPS
        scenario = os.path.join(self.robot.out, "drive.scenario")
        with open(scenario, "w", encoding="utf-8") as file:
            file.write(f"scenario 1\nat 0 drive way={way} speed_mps={SPEED_MPS} points_m={';'.join(points)}\n")
        rate = [a.split("=")[1] for a in self.arguments if a.startswith("--Simulator.Camera.Rate_hz=")]
        self.rate_hz = float(rate[-1] if rate else value_of(f"{self.robot.setup}/simulator.cfg", "Simulator.Camera.Rate_hz") or 30)
        # No truth in the recording: it is the world's, and the map will have a frame of its own.
        return ["--Simulator.LockStep=2", f"--Simulator.Scenario={os.path.abspath(scenario)}", "--Recorder.Simulation.Proxy="]

    def report(self):
        """Images, megabytes and lost messages so far. @throws Failure when a component is gone."""
        command = [os.path.join(BIN, "show_status"), self.state, "--json"]
        answer = subprocess.run(command, stdout=subprocess.PIPE, text=True).stdout.strip()
        components = json.loads(answer.splitlines()[-1])["components"] if answer else []
        for component in components:
            if component["name"] in self.started and component["state"] == "absent":
                raise Failure(f"{component['name']} has ended: {component['reason']} (see out/{self.state}/{component['name']}.log)")
        recorder = next((c for c in components if c["name"] == "recorder"), {})
        gauges = {gauge["name"]: gauge["value"] for gauge in recorder.get("gauges", [])}
        images = sum(rate["total"] for rate in recorder.get("rates", []) if rate["name"] in self.robot.cameras())
        waiting = "; ".join(f"{c['name']}: {c['reason']}" for c in components if c["reason"] and c["name"] != "recorder")
        return images, gauges.get("recorded", 0.0), gauges.get("messages dropped", 0.0), waiting

    def watch(self):
        """Until the time is over or Ctrl-C."""
        began = newest = shown = time.monotonic()
        images = 0
        while True:
            before = images
            images, megabytes, dropped, waiting = self.report()
            now = time.monotonic()
            newest = now if images != before else newest
            if now - newest > SILENCE_S:
                raise Failure(f"no image came for {SILENCE_S:.0f} s" + (f": {waiting}" if waiting else ""))
            done_s = images / self.rate_hz if self.rate_hz else now - began
            is_over = self.options.seconds and done_s >= self.options.seconds
            if is_over or now - shown > 5:
                shown = now
                end = f" of {self.options.seconds:.0f}" if self.options.seconds else ""
                lost = f", {dropped:.0f} messages lost: the disk is too slow" if dropped else ""
                left_s = (now - began) * (self.options.seconds / done_s - 1) if end and done_s > 0 else 0
                end += f" s, {left_s / 60:.0f} min left" if left_s >= 100 else " s"
                print(f"recording: {done_s:.0f}{end}, {images} images, {megabytes:.0f} MB{lost}", file=sys.stderr, flush=True)
            if is_over:
                return
            time.sleep(1)

    def record(self, localizes=False):
        os.makedirs(os.path.dirname(self.folder), exist_ok=True)
        try:
            self.start(localizes)  # Ctrl-C meanwhile: what began is ended, too
            say(f"Recording into {self.folder}" + ("." if self.robot.simulated else ": drive now; Ctrl-C ends it."))
            with contextlib.suppress(KeyboardInterrupt):
                self.watch()
        finally:
            # The recorder first: it writes the index of its bag. A second Ctrl-C must not cut that off.
            signal.signal(signal.SIGINT, signal.SIG_IGN)
            others = [name for name in self.started if name != "recorder"]
            for names in filter(None, (["recorder"], others)):
                subprocess.run(["scripts/stop", self.state, *names], stdout=sys.stderr)
            signal.signal(signal.SIGINT, signal.default_int_handler)
