#!/usr/bin/python3
"""clients_test.py BUILD_DIR: the examples of deploy/examples work as docs/clients.md says, and wrong use gets one line.
Tests C4."""
import os
import re
import socket
import subprocess
import sys
import tempfile
import unittest
from pathlib import Path

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BUILD = os.path.abspath(sys.argv.pop(1))
EXAMPLES = os.path.join(ROOT, "deploy", "examples")
COMPONENTS = ("simulator", "active_visual_memory", "localization")
START_S = 60


def ports_of(text):
    return [int(port) for port in re.findall(r"-p (\d+)", text)]


def free_offset(ports):
    """For all ports of a setup together."""
    for offset in range(20000 + os.getpid() % 500, 45000, 500):
        sockets = [socket.socket() for _ in ports]
        try:
            for port, one in zip(ports, sockets):
                one.bind(("127.0.0.1", port + offset))
            return offset
        except OSError:
            continue
        finally:
            for one in sockets:
                one.close()
    raise AssertionError("no free ports")


class Clients(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = cls.enterClassContext(tempfile.TemporaryDirectory(prefix="vismem_clients_"))
        texts = {name: Path(ROOT, "cfg", "sim", name + ".cfg").read_text() for name in COMPONENTS}
        cls.ports = sorted({port for text in texts.values() for port in ports_of(text)})
        cls.offset = free_offset(cls.ports)
        for name, text in texts.items():
            with open(os.path.join(cls.folder, name + ".cfg"), "w") as file:
                file.write(re.sub(r"-p (\d+)", lambda found: f"-p {int(found[1]) + cls.offset}", text))
            process = subprocess.Popen(
                [os.path.join(BUILD, "bin", name), os.path.join(cls.folder, name + ".cfg")], cwd=ROOT,
                stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
            cls.addClassCleanup(cls.end, process)
            assert "ready" in process.stdout.readline(), name

    @staticmethod
    def end(process):
        process.terminate()
        process.wait(START_S)
        process.stdout.close()

    def client(self, *arguments, offset=None):
        shift = self.offset if offset is None else offset
        return subprocess.run(["/usr/bin/python3", os.path.join(EXAMPLES, "robot_client.py"), "--port-offset", str(shift),
                               *arguments], capture_output=True, text=True, timeout=START_S)

    def good(self, *arguments):
        done = self.client(*arguments)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def refused(self, *arguments, offset=None):
        done = self.client(*arguments, offset=offset)
        self.assertEqual(done.returncode, 1, done.stdout)
        self.assertNotIn("Traceback", done.stderr)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        return done.stderr

    def test_pose_memory_and_image(self):
        self.assertIn("accepted", self.good("set-pose", "3", "2.25", "180"))
        self.assertRegex(self.good("pose", "--seconds", "2"), r"(?m)^ +\d+\.\d\d +[23]\.\d{3} +2\.\d{3} ")
        self.assertRegex(self.good("memory"), r"(?m)^\d+ segments, \d+ primitives$")
        file = os.path.join(self.folder, "image.jpg")
        self.assertIn("320x240", self.good("image", file))
        with open(file, "rb") as image:
            self.assertEqual(image.read(2), b"\xff\xd8")

    def test_gaze_base_and_parameters(self):
        self.assertRegex(self.good("look", "1.5", "0"), r"asked for \(1\.5, 0\)")
        self.assertEqual(self.good("drive", "0.1", "0", "0.3"), "done\n")
        self.assertIn("speed 9 m/s to 0.6", self.good("drive", "9", "0", "0.1"))
        self.assertIn("Overlay.Rate_hz = 10 Hz   # 0.1..120; ", self.good("parameters", "active_visual_memory"))
        self.assertIn("accepted", self.good("set", "active_visual_memory", "Overlay.Rate_hz", "5"))
        self.assertIn("Overlay.Rate_hz = 5 Hz", self.good("parameters", "active_visual_memory"))
        self.assertRegex(self.good("status", "localization"), r"^localization \S+: \w+")

    def test_wrong_use_gets_the_reason(self):
        self.assertIn("outside the map", self.refused("set-pose", "300", "2", "0"))
        self.assertIn("must be 0.1..120", self.refused("set", "active_visual_memory", "Overlay.Rate_hz", "500"))
        self.assertIn('no parameter is called "foo"', self.refused("set", "localization", "foo", "1"))
        self.assertIn("nobody has the name cameraB", self.refused("image", "x.jpg", "--camera", "cameraB"))
        self.assertIn("component foo (must be one of", self.refused("status", "foo"))
        self.assertIn("No such file or directory", self.refused("image", os.path.join(self.folder, "no", "x.jpg")))
        self.assertIn("is the setup started", self.refused("pose", offset=free_offset(self.ports)))

    def test_the_shortest_client_of_the_page(self):
        with open(os.path.join(ROOT, "docs", "clients.md")) as page:
            program = re.search(r"(?s)```python\n(.*?)```", page.read())[1]
        self.good("pose", "--seconds", "1")  # there is an estimate
        done = subprocess.run(["/usr/bin/python3", "-c", program.replace("9971", str(9971 + self.offset))], cwd=ROOT,
                              capture_output=True, text=True, timeout=START_S)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertIn("theta", done.stdout)

    def test_the_client_in_cpp(self):
        build = os.path.join(self.folder, "cpp")
        for command in (["cmake", "-S", os.path.join(EXAMPLES, "cpp_client"), "-B", build, f"-DSLICES={ROOT}/interfaces",
                         "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Werror"], ["cmake", "--build", build]):
            done = subprocess.run(command, capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        program = os.path.join(build, "robot_client")
        done = subprocess.run([program, "2", str(self.offset)], capture_output=True, text=True, timeout=START_S)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertRegex(done.stdout, r"(?m)^x \S+ m, y \S+ m, heading \S+ rad, reliability \S+, \d+ segments$")
        done = subprocess.run([program, "2", str(self.offset + 250)], capture_output=True, text=True, timeout=START_S)
        self.assertEqual(done.returncode, 1)

    def test_a_whole_proxy_in_place_of_name_and_port(self):
        proxy = f"Localization:tcp -h 127.0.0.1 -p {9971 + self.offset}"
        done = self.client("--proxy", proxy, "pose", "--seconds", "2", offset=self.offset + 250)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertGreater(len(done.stdout.splitlines()), 1)
        self.assertIn("nobody has the name", self.refused("--proxy", proxy.replace("Localization", "Nobody"), "pose"))
        self.assertIn("--proxy", self.refused("--proxy", "Localization:tcp -p x", "pose"))


if __name__ == "__main__":
    unittest.main()
