#!/usr/bin/python3
"""Reports of robots over the IceStorm of deploy/icestorm to listeners, some of which freeze. Tests C3."""
import json
import os
import re
import signal
import subprocess
import sys
import threading
import time
import unittest

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from site_of_robots import DEPLOY, ROOT, Site, enter_own_network, wait_for  # noqa: E402

BIN = os.environ.get("VISMEM_BIN", os.path.join(ROOT, "build/release/bin"))
MANAGER = "VismemStorm/TopicManager:tcp -h 127.0.0.1 -p 9980"
RATE_HZ = 10
FROZEN_S = 5


class Listener:
    """watch_fleet.py, its reports read by a thread."""

    def __init__(self):
        self.process = subprocess.Popen(
            [sys.executable, f"{DEPLOY}/examples/watch_fleet.py", "--slices", f"{ROOT}/interfaces", "--json"],
            stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        self.reports = []
        self.reader = threading.Thread(target=self._read)
        self.reader.start()

    def _read(self):
        for line in self.process.stdout:
            self.reports.append((time.monotonic(), json.loads(line)))

    def numbers(self, robot):
        return [report["number"] for _, report in self.reports if report["robot"] == robot]

    def latest(self, robot):
        return next((report for _, report in reversed(self.reports) if report["robot"] == robot), None)

    def close(self):
        self.process.send_signal(signal.SIGCONT)
        self.process.kill()
        self.process.wait()
        self.reader.join()
        self.process.stdout.close()


def localization_at(port, pose):
    """A server in a thread that gives always new estimates of one pose, as localization does."""
    import Ice
    Ice.loadSlice(f"--all -I{Ice.getSliceDir()} -I{ROOT}/interfaces {ROOT}/interfaces/avm/localization.ice")
    import avm

    class Localization(avm.Localization):
        revision = 0

        def latest(self, current=None):
            self.revision += 1
            estimate = avm.PoseEstimate()
            estimate.revision, estimate.hasPose, estimate.reliability = self.revision, True, 0.9
            estimate.robotInWorld = avm.Pose2(*pose)
            return estimate

    communicator = Ice.initialize([])
    adapter = communicator.createObjectAdapterWithEndpoints("L", f"tcp -h 127.0.0.1 -p {port}")
    adapter.add(Localization(), Ice.Identity("Localization", ""))
    adapter.activate()
    return communicator


def memory_kB(process):
    with open(f"/proc/{process.pid}/status") as file:
        return int(re.search(r"VmRSS:\s+(\d+)", file.read()).group(1))


class Storm(unittest.TestCase):
    def setUp(self):
        self.site = self.enterContext(Site())
        self.start_icebox()

    def start_icebox(self):
        return self.site.start("icebox", "icebox", f"--Ice.Config={DEPLOY}/icestorm/icebox.cfg")

    def start_agent(self, name, *keys):
        return self.site.start(name, os.path.join(BIN, "fleet_agent"), f"--Robot.Name={name}",
                               "--FleetAgent.Endpoints=tcp -h 127.0.0.1 -p 0", f"--FleetAgent.Rate_hz={RATE_HZ}",
                               f"--FleetAgent.TopicManager.Proxy={MANAGER}", *keys)

    def listener(self):
        listener = Listener()
        self.addCleanup(listener.close)
        return listener

    def test_every_listener_gets_the_reports_of_every_robot_in_order(self):
        with localization_at(7001, (1.5, -2.0, 0.25)):
            self.start_agent("robot1", "--FleetAgent.Localization.Proxy=Localization:tcp -h 127.0.0.1 -p 7001",
                             "--FleetAgent.Components.localization.Proxy=localization/component:tcp -h 127.0.0.1 -p 7002")
            self.start_agent("robot2")
            listeners = [self.listener() for _ in range(3)]
            for listener in listeners:
                wait_for(lambda: len(listener.numbers("robot1")) > 20 and len(listener.numbers("robot2")) > 20, 20,
                         "20 reports of both robots\n" + self.site.log("robot1"))
                for robot in ("robot1", "robot2"):
                    numbers = listener.numbers(robot)
                    self.assertEqual(numbers, list(range(numbers[0], numbers[0] + len(numbers))), robot)
            self.assertEqual(listeners[0].latest("robot1")["pose"], [1.5, -2.0, 0.25])
            self.assertIn(listeners[0].latest("robot1")["away"],
                          ({"localization": "connection refused"}, {"localization": "no answer in time"}))
            self.assertIsNone(listeners[0].latest("robot2")["pose"])
        # Its localization has gone: no pose rather than an old one.
        wait_for(lambda: listeners[0].latest("robot1")["pose"] is None, 5, "robot1 has no pose")

    def test_a_frozen_listener_delays_nobody_and_fills_no_memory(self):
        self.start_agent("robot1")
        good, frozen = self.listener(), self.listener()
        for listener in (good, frozen):
            wait_for(lambda: len(listener.numbers("robot1")) > 5, 20, "reports")
        before = memory_kB(self.site.processes["icebox"])
        os.kill(frozen.process.pid, signal.SIGSTOP)
        begin = time.monotonic()
        time.sleep(FROZEN_S)
        os.kill(frozen.process.pid, signal.SIGCONT)
        times = [at for at, _ in good.reports if at >= begin - 1]
        gap = max(b - a for a, b in zip(times, times[1:]))
        grown = memory_kB(self.site.processes["icebox"]) - before
        newest = good.numbers("robot1")[-1]
        wait_for(lambda: frozen.numbers("robot1")[-1] > newest, 10, "the listener that was frozen is up to date")
        numbers = frozen.numbers("robot1")
        lost = newest - numbers[0] + 1 - len([n for n in numbers if n <= newest])
        print(f"fleet: a listener frozen for {FROZEN_S} s: the other's longest pause {gap:.2f} s, icebox grew by {grown} kB, "
              f"the frozen one lost {lost} of {FROZEN_S * RATE_HZ} reports", flush=True)
        self.assertLess(gap, 1.0)
        self.assertLess(grown, 2000)
        self.assertEqual(numbers, sorted(numbers))
        self.assertGreater(lost, 0, "the queue is bounded")

    def test_reports_come_again_after_a_restart_of_icestorm(self):
        self.start_agent("robot1")
        listener = self.listener()
        wait_for(lambda: len(listener.numbers("robot1")) > 5, 20, "reports")
        self.site.kill("icebox")
        time.sleep(1)
        begin, seen = time.monotonic(), len(listener.reports)
        self.start_icebox()
        wait_for(lambda: len(listener.reports) > seen + 5, 20, "reports")
        print(f"fleet: reports come {listener.reports[seen][0] - begin:.1f} s after the restart of icebox", flush=True)


if __name__ == "__main__":
    if subprocess.run(["which", "icebox"], capture_output=True).returncode != 0:
        print("fleet: skipped, no icebox: scripts/setup fleet")
        sys.exit(77)
    if not enter_own_network():
        print("fleet: skipped, the kernel allows no network of its own (needs root or user namespaces)")
        sys.exit(77)
    unittest.main(verbosity=2)
