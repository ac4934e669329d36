"""The whole application in lock-step as processes that are killed, frozen and started again; the relays between them."""
import os
import re
import selectors
import signal
import socket
import subprocess
import sys
import threading
import time

import Ice

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
HERE = os.path.dirname(os.path.abspath(__file__))
READY_S = 60
CAMERA_HZ = 10

for slice_file in ("base", "camera", "component", "localization", "pantilt", "recorder", "simulation", "visual_memory"):
    Ice.loadSlice(f"--all -I{Ice.getSliceDir()} -I{ROOT}/interfaces {ROOT}/interfaces/avm/{slice_file}.ice")
import avm  # noqa: E402


def make_communicator():
    return Ice.initialize(["", "--Ice.MessageSizeMax=16384", "--Ice.Default.InvocationTimeout=3000",
                           "--Ice.Override.ConnectTimeout=2000", "--Ice.RetryIntervals=0 200 500"])


class Relay(threading.Thread):
    """Passes the bytes of all connections to a port on; cut, it keeps them and passes nothing, as a lost link does."""

    def __init__(self, port, target):
        super().__init__(daemon=True)
        self.target, self.cut, self.ended = target, False, False
        self.listener = socket.create_server(("127.0.0.1", port), backlog=64)
        self.selector = selectors.DefaultSelector()
        self.selector.register(self.listener, selectors.EVENT_READ)
        self.start()

    def run(self):
        while not self.ended:
            if self.cut:
                time.sleep(0.05)
                continue
            for key, _ in self.selector.select(0.1):
                if self.cut:
                    break
                if key.fileobj is self.listener:
                    self._accept()
                else:
                    self._pass_on(key.fileobj, key.data)

    def close(self):
        """Ends the relay and frees its port for the next one."""
        self.ended = True
        self.join()
        for key in list(self.selector.get_map().values()):
            key.fileobj.close()
        self.selector.close()

    def _accept(self):
        client, _ = self.listener.accept()
        try:
            server = socket.create_connection(("127.0.0.1", self.target), 2)
        except OSError:
            client.close()
            return
        for one, other in ((client, server), (server, client)):
            one.settimeout(10)
            self.selector.register(one, selectors.EVENT_READ, other)

    def _pass_on(self, source, target):
        if source.fileno() < 0:
            return  # closed with its other end, a moment ago
        try:
            data = source.recv(1 << 18)
            if data:
                target.sendall(data)
                return
        except OSError:
            pass
        for one in (source, target):
            self.selector.unregister(one)
            one.close()


class Application:
    """Context manager. Programs run in `folder`; ports are those of cfg/sim plus an offset."""

    def __init__(self, binaries, folder, offset, seed):
        self.binaries, self.folder, self.offset, self.seed = binaries, folder, offset, seed
        self.ports = {"camera": 9999 + offset, "motors": 9990 + offset, "pantilt": 9977 + offset, "simulation": 9972 + offset,
                      "memory": 9970 + offset, "localization": 9971 + offset, "recorder": 9992 + offset}
        self.relays = {"simulator": Relay(9950 + offset, self.ports["camera"]), "memory": Relay(9951 + offset, self.ports["memory"])}
        self.processes, self.frozen = {}, set()
        self.disk = os.path.join(folder, "disk")
        self.communicator = make_communicator()
        at = lambda kind, name, port: kind.uncheckedCast(  # noqa: E731
            self.communicator.stringToProxy(f"{name}:tcp -h 127.0.0.1 -p {self.ports[port]}"))
        self.simulation = at(avm.SimulationPrx, "Simulation", "simulation")
        self.pantilt = at(avm.PanTiltPrx, "PanTilt", "pantilt")
        self.localization = at(avm.LocalizationPrx, "Localization", "localization")
        self.recorder = at(avm.RecorderPrx, "Recorder", "recorder")
        self.status = {name: at(avm.ComponentPrx, f"{name}/component", port) for name, port in
                       (("simulator", "simulation"), ("active_visual_memory", "memory"), ("localization", "localization"),
                        ("recorder", "recorder"))}

    def __enter__(self):
        os.makedirs(self.disk, exist_ok=True)
        for name in self.names():
            self.start(name)
        return self

    def __exit__(self, *_):
        for name in list(self.processes):
            self.go_on(name)
            self.processes[name].terminate()
        for process in self.processes.values():
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        for relay in self.relays.values():
            relay.close()
        self.communicator.destroy()

    @staticmethod
    def names():
        """All processes; the commander drives the base and is the second consumer of images that time waits for."""
        return ["simulator", "active_visual_memory", "localization", "recorder", "commander"]

    def _command(self, name):
        port, relay = self.ports, self.offset
        through = f"-h 127.0.0.1 -p {9950 + relay}"
        keys = {
            "simulator": [f"--Simulator.Endpoints=" + ":".join(f"tcp -h 127.0.0.1 -p {port[one]}" for one in
                                                              ("camera", "motors", "pantilt", "simulation")),
                          f"--Simulator.Camera.Rate_hz={CAMERA_HZ}", "--Simulator.LockStep=2", f"--Simulator.Seed={self.seed}"],
            "active_visual_memory": [f"--ActiveVisualMemory.Endpoints=tcp -h 127.0.0.1 -p {port['memory']}",
                                     f"--ActiveVisualMemory.Camera.Proxy=cameraA:tcp {through}",
                                     f"--ActiveVisualMemory.PanTilt.Proxy=PanTilt:tcp {through}",
                                     f"--ActiveVisualMemory.Odometry.Proxy=Encoders:tcp {through}"],
            "localization": [f"--Localization.Endpoints=tcp -h 127.0.0.1 -p {port['localization']}",
                             f"--Localization.VisualMemory.Proxy=VisualMemory:tcp -h 127.0.0.1 -p {9951 + relay}",
                             f"--Localization.Gaze.Proxy=Gaze:tcp -h 127.0.0.1 -p {9951 + relay}"],
            # Without images: the disk of the test is small.
            "recorder": [f"--Recorder.Endpoints=tcp -h 127.0.0.1 -p {port['recorder']}", f"--Recorder.Folder={self.disk}",
                         f"--Recorder.Odometry.Proxy=Encoders:tcp -h 127.0.0.1 -p {port['camera']}",
                         f"--Recorder.PanTilt.Proxy=PanTilt:tcp -h 127.0.0.1 -p {port['camera']}",
                         f"--Recorder.VisualMemory.Proxy=VisualMemory:tcp -h 127.0.0.1 -p {port['memory']}",
                         f"--Recorder.Localization.Proxy=Localization:tcp -h 127.0.0.1 -p {port['localization']}",
                         "--Recorder.Split.Size_MB=4"],
        }
        if name == "commander":
            return [sys.executable, os.path.join(HERE, "commander.py"), str(port["camera"])]
        # The recorder's own file would record images.
        file = [] if name == "recorder" else [f"--Ice.Config={ROOT}/cfg/sim/{name}.cfg"]
        return [os.path.join(self.binaries, name), *file, *keys[name]]

    def start(self, name):
        log = os.path.join(self.folder, name + ".log")
        with open(log, "ab") as stream:
            # In a session of its own: the end of a terminal ends the series or nothing, never its processes alone.
            process = subprocess.Popen(self._command(name), cwd=ROOT, stdout=subprocess.PIPE, stderr=stream, text=True,
                                       start_new_session=True)
        self.processes[name] = process
        line = process.stdout.readline()
        threading.Thread(target=process.stdout.read, daemon=True).start()
        if "ready" not in line:
            raise RuntimeError(f"{name} is not ready: see {log}")

    def kill(self, name):
        process = self.processes.pop(name)
        self.frozen.discard(name)
        process.kill()
        process.wait()

    def freeze(self, name):
        self.processes[name].send_signal(signal.SIGSTOP)
        self.frozen.add(name)

    def go_on(self, name):
        if name in self.frozen:
            self.processes[name].send_signal(signal.SIGCONT)
            self.frozen.discard(name)

    def follow(self, consumers):
        """Simulated time waits for so many consumers of images."""
        self.simulation.setLockStep(consumers)

    def now_s(self):
        return self.simulation.status().stampUs / 1e6

    def head_goal(self):
        """(pan, tilt) of the last position command [rad]."""
        goal = self.pantilt.getPanTiltStatus().goal
        return goal.panRad, goal.tiltRad

    def memory_kB(self, name):
        with open(f"/proc/{self.processes[name].pid}/status") as file:
            return int(re.search(r"VmRSS:\s+(\d+)", file.read()).group(1))

    def _progress(self):
        """Counters that rise while the application works; raises while something does not answer."""
        memory = {rate.name: rate.total for rate in self.status["active_visual_memory"].getStatus().rates}
        return [self.simulation.status().stampUs, memory.get("iterations", memory.get("frames", 0)),
                self.localization.latest().revision, self.recorder.status().messages]

    def why_not_whole(self, patience_s):
        """Waits until every process runs and the work of all goes on. @return (seconds, empty) or (None, what is missing)."""
        begin, before, why = time.monotonic(), None, "nothing answers"
        while time.monotonic() < begin + patience_s:
            try:
                ended = [name for name in self.names() if name not in self.processes or self.processes[name].poll() is not None]
                states = {name: proxy.getStatus() for name, proxy in self.status.items()}
                bad = {name: status.reason for name, status in states.items() if status.state != avm.ComponentState.Running}
                now = self._progress()
                rises = before is not None and all(b > a for a, b in zip(before, now))
                why = f"ended: {ended}, not running: {bad}, progress {before} -> {now}"
                if not ended and not bad and rises:
                    return time.monotonic() - begin, ""
                before = before if before is not None and not rises and all(b >= a for a, b in zip(before, now)) else now
            except Ice.Exception as problem:
                why, before = f"{type(problem).__name__}: {problem}", None
            time.sleep(0.1)
        return None, why
