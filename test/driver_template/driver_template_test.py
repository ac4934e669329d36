#!/usr/bin/python3
"""driver_template_test.py BUILD_DIR: the driver template builds outside the sources against an installation, and serves
its images. Tests C1."""
import os
import re
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BUILD = os.path.abspath(sys.argv.pop(1))
SERVER_S = 20


class DriverTemplate(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = cls.enterClassContext(tempfile.TemporaryDirectory(prefix="vismem_driver_"))
        cls.prefix = os.path.join(cls.folder, "usr")
        cls.run_checked("cmake", "--install", BUILD, "--prefix", cls.prefix, "--component", "dev")
        sources = os.path.join(cls.prefix, "share/vismem/driver_template")
        cls.build = os.path.join(cls.folder, "build")
        cls.run_checked("cmake", "-S", sources, "-B", cls.build, f"-DCMAKE_PREFIX_PATH={cls.prefix}",
                        "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_CXX_FLAGS=-Wall -Wextra -Werror")
        cls.run_checked("cmake", "--build", cls.build)
        cls.server = os.path.join(cls.build, "template_camera_server")

    @staticmethod
    def run_checked(*command):
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if done.returncode != 0:
            raise AssertionError(" ".join(command) + "\n" + done.stdout)
        return done.stdout

    def test_nothing_of_the_sources_is_needed(self):
        for folder, _, names in os.walk(self.prefix):
            for name in names:
                if name.endswith((".cmake", ".h")):
                    with open(os.path.join(folder, name)) as file:
                        self.assertNotIn(ROOT, file.read(), name)

    def test_its_images_come_over_ice(self):
        import Ice
        slices = os.path.join(self.prefix, "share/vismem/slice")
        Ice.loadSlice(f"--all -I{Ice.getSliceDir()} -I{slices} {slices}/avm/camera.ice")
        import avm
        process = subprocess.Popen(
            [self.server, f"--Ice.Config={self.prefix}/share/vismem/driver_template/camera_server.cfg",
             "--CameraServer.Endpoints=tcp -h 127.0.0.1 -p 0"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
        try:
            port = re.search(r"-p (\d+)", process.stdout.readline()).group(1)
            with Ice.initialize(["", "--Ice.MessageSizeMax=16384", "--Ice.Default.InvocationTimeout=5000"]) as communicator:
                camera = avm.CameraPrx.checkedCast(communicator.stringToProxy(f"cameraA:tcp -h 127.0.0.1 -p {port}"))
                image = self.first_image(camera)
                self.assertEqual((image.description.width, image.description.height), (320, 240))
                self.assertEqual(set(bytes(image.pixelData)), {90})
        finally:
            process.terminate()
            self.assertEqual(process.wait(SERVER_S), 0)
            process.stdout.close()

    @staticmethod
    def first_image(camera):
        """A camera serves before its first image, and says "no frame yet" until then."""
        import jderobot
        end = time.monotonic() + SERVER_S
        while True:
            try:
                return camera.getImageData("RGB8")
            except jderobot.HardwareFailedException:
                if time.monotonic() > end:
                    raise
                time.sleep(0.02)

    def test_wrong_keys_are_named_like_those_of_built_in_drivers(self):
        done = subprocess.run([self.server, "--CameraServer.Camera.cameraA.Driver=template",
                               "--CameraServer.Camera.cameraA.Brightness=999"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2)
        self.assertIn("CameraServer.Camera.cameraA.Brightness = 999 (must be 0..255)", done.stderr)
        done = subprocess.run([self.server, "--CameraServer.Camera.cameraA.Driver=tamplate"], capture_output=True, text=True)
        self.assertIn("template", done.stderr)


if __name__ == "__main__":
    unittest.main(verbosity=2)
