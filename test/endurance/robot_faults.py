"""Faults for endurance: each hurts the application and brings everything back. Returns what was wrong meanwhile."""
import math
import os
import signal
import socket
import struct
import subprocess
import sys
import time

import Ice

from robot_application import HERE, Application, avm

# Of simulated time: this long after its last command the base stands, and the head turns to nowhere but that command's goal.
BRAKED_S, WATCH_S = 0.5, 3.0
STILL_M, STILL_RAD = 0.001, 0.001
WALL_LIMIT_S = 60


class Faults:
    """The kinds by name, with their weights. *draw* is a random.Random."""

    WEIGHTS = {"kill": 40, "freeze": 25, "cut link": 15, "garbage": 10, "slow client": 7, "full disk": 3}

    def __init__(self, application: Application, draw, disk_is_own):
        self.app, self.draw = application, draw
        self.weights = {kind: weight for kind, weight in self.WEIGHTS.items() if kind != "full disk" or disk_is_own}

    def one(self):
        """@return (kind, victim, problems)."""
        kind = self.draw.choices(list(self.weights), list(self.weights.values()))[0]
        method = {"kill": self._kill, "freeze": self._freeze, "cut link": self._cut, "garbage": self._garbage,
                  "slow client": self._slow_client, "full disk": self._full_disk}[kind]
        victim, problems = method()
        return kind, victim, problems

    # ---- processes ----

    def _without(self, victim):
        """The motors while a process is away: nobody commands the base without the commander, or the head without the
        memory. The other one of the two is what time waits for."""
        if victim in ("commander", "active_visual_memory"):
            return self._motors_stand(victim)
        time.sleep(self.draw.uniform(0.2, 3.0))
        return []

    def _kill(self):
        victim = self.draw.choice(self.app.names())
        self.app.kill(victim)
        problems = self._without(victim)
        self.app.start(victim)
        return victim, problems + self._all_follow()

    def _freeze(self):
        victim = self.draw.choice(self.app.names())
        self.app.freeze(victim)
        problems = self._without(victim)
        if self.draw.random() < 0.25:
            time.sleep(5.0)  # longer than all timeouts
        self.app.go_on(victim)
        return victim, problems + self._all_follow()

    def _all_follow(self):
        end = time.monotonic() + WALL_LIMIT_S
        while time.monotonic() < end:
            try:
                self.app.follow(2)
                return []
            except Ice.Exception:
                time.sleep(0.2)
        return ["the simulator takes no command"]

    def _motors_stand(self, victim):
        """Lets time go on without the victim and looks at the motor that it commands."""
        head = victim != "commander"
        # What the victim had sent arrives; time stands still meanwhile, because it waits for two consumers.
        time.sleep(0.3)
        try:
            begin = self.app.now_s()
            goal = self.app.head_goal()
            self.app.follow(1)
            samples = self._samples(victim, begin)
            other_goal = self.app.head_goal()
        except Ice.Exception as problem:
            return [f"no look at the motors: {type(problem).__name__}"]
        if len(samples) < 10:
            return [f"only {len(samples)} samples of the motors"]
        late = [values for stamp, values in samples if stamp > begin + BRAKED_S]
        if not head:
            moved = max((max(math.dist(late[0][:2], one[:2]), abs(one[2] - late[0][2])) for one in late), default=0.0)
            return [f"base moved by {moved:.4f} (m or rad) without {victim}"] if moved > max(STILL_M, STILL_RAD) else []
        if math.dist(goal, other_goal) > STILL_RAD:
            return [f"head was sent from {goal} to {other_goal} without {victim}"]
        return [f"head turned from {a:.4f} to {b:.4f}, away from its last command's {end:.4f}, without {victim}"
                for axis, end in enumerate(goal) for (a, b) in ((one[axis], two[axis]) for one, two in zip(late, late[1:]))
                if abs(b - end) > abs(a - end) + STILL_RAD][:1]

    def _samples(self, victim, begin):
        """(stamp [s], three values) of the base or the head, until WATCH_S after `begin`."""
        samples, newest, end = [], int(begin * 1e6), time.monotonic() + WALL_LIMIT_S
        while newest < (begin + WATCH_S) * 1e6 and time.monotonic() < end:
            if victim == "commander":
                new = self.app.simulation.truthSince(newest).samples
                samples += [(one.stampUs / 1e6, (one.robotInWorld.x, one.robotInWorld.y, one.robotInWorld.theta)) for one in new]
            else:
                new = self.app.pantilt.samplesSince(newest).samples
                samples += [(one.stampUs / 1e6, (one.panRad, one.tiltRad, 0.0)) for one in new]
            if new:
                newest = new[-1].stampUs
        return samples

    # ---- links and clients ----

    def _cut(self):
        name = self.draw.choice(list(self.app.relays))
        relay = self.app.relays[name]
        relay.cut = True
        problems = []
        if name == "simulator":
            problems = self._motors_stand("active_visual_memory")
        time.sleep(self.draw.uniform(0.5, 6.0))
        relay.cut = False
        return "link to " + name, problems + self._all_follow()

    def _garbage(self):
        name = self.draw.choice(list(self.app.ports))
        ice = b"IceP\x01\x00\x01\x00"
        message = self.draw.choice([
            self.draw.randbytes(self.draw.randrange(1, 4096)), b"GET / HTTP/1.1\r\nHost: x\r\n\r\n",
            ice + b"\x00\x00" + struct.pack("<i", 0x7fffffff), ice + b"\x00\x00" + struct.pack("<i", -5),
            ice + b"\x00\x00" + struct.pack("<i", 64) + self.draw.randbytes(50),
            ice + b"\x00\x00" + struct.pack("<i", 14 + 200) + self.draw.randbytes(20)])
        try:
            with socket.create_connection(("127.0.0.1", self.app.ports[name]), 2) as connection:
                connection.sendall(message)
                connection.settimeout(1)
                connection.recv(64)
                connection.recv(64)
        except OSError:
            pass
        return name, []

    def _slow_client(self):
        client = subprocess.Popen([sys.executable, os.path.join(HERE, "slow_client.py"), str(self.app.ports["camera"])],
                                  stdout=subprocess.PIPE, text=True)
        client.stdout.readline()
        client.send_signal(signal.SIGSTOP)
        time.sleep(self.draw.uniform(2.0, 12.0))
        client.kill()
        client.wait()
        client.stdout.close()
        return "simulator", []

    # ---- disk ----

    def _full_disk(self):
        ballast = os.path.join(self.app.disk, "ballast")
        subprocess.run(["dd", "if=/dev/zero", f"of={ballast}", "bs=64k"], stderr=subprocess.DEVNULL)
        failed, end = False, time.monotonic() + 20
        while time.monotonic() < end and not failed:
            try:
                failed = self.app.recorder.status().state == avm.RecorderState.Failed
            except Ice.Exception:
                pass
            time.sleep(0.2)
        os.remove(ballast)
        self.make_room()
        if not failed:
            return "recorder", ["the recorder does not say that its disk is full"]
        end = time.monotonic() + 20
        while time.monotonic() < end:
            try:
                self.app.recorder.start("")
                return "recorder", []
            except Ice.Exception as problem:
                last = problem
                time.sleep(0.5)
        return "recorder", [f"the recorder does not begin anew: {last}"]

    def rotate(self):
        """Begins another recording when half of the disk is full."""
        disk = os.statvfs(self.app.disk)
        if disk.f_bavail > 0.5 * disk.f_blocks:
            return
        try:
            self.app.recorder.stop()
            time.sleep(1.1)  # recordings are called by the second in which they begin
            self.app.recorder.start("")
        except Ice.Exception:
            return  # away, for now
        self.make_room()

    def make_room(self):
        """Removes all but the newest recording."""
        folders = sorted((os.path.join(self.app.disk, name) for name in os.listdir(self.app.disk)), key=os.path.getmtime)
        for folder in folders[:-1]:
            subprocess.run(["rm", "-rf", folder])
