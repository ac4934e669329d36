#!/usr/bin/python3
"""What TLS and the gateway cost: the time of a call that returns an image of 320x240 RGB, over tcp, ssl and the operators' router, in
turns. Ratios of medians to tcp in the same run; and, as a figure that other work on the machine hardly changes, ratios of the processor
time of client, server and router together. Needs no root. Prints what it measured.
"""
import glob
import os
import statistics
import subprocess
import sys
import tempfile
import time
import unittest

import Ice

sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
from processes import ROOT, Process, component  # noqa: E402

PORT, SSL_PORT, ACCESS_PORT, ROUTER_PORT = 21901, 21902, 21903, 21904
ROUNDS, CALLS = 25, 20
MOST = {"ssl": 3.5, "gateway": 5.0}
PASSWORD = "open sesame"


def loaded():
    slices = Ice.getSliceDir()
    Ice.loadSlice(f"-I{slices} {slices}/Glacier2/Router.ice")
    import Glacier2
    return Glacier2


def processor_s(processes):
    """Processor time of all threads of some processes."""
    total = 0
    for process in processes:
        for schedule in glob.glob(f"/proc/{process}/task/*/schedstat"):
            with open(schedule) as file:
                total += int(file.read().split()[0])
    return total / 1e9


class Cost(unittest.TestCase):
    def setUp(self):
        self.folder = self.enterContext(tempfile.TemporaryDirectory(prefix="vismem_cost_"))
        for name, role in (("robot", "robot"), ("station", "station"), ("gateway", "gateway")):
            subprocess.run([os.path.join(ROOT, "deploy/pki/certificates"), self.folder, "make", name, role, "127.0.0.1"], check=True)
        for role in ("operator", "viewer"):
            subprocess.run([os.path.join(ROOT, "deploy/gateway/gateway_user"), role, "add", "ana"], input=PASSWORD + "\n", text=True,
                           check=True, env={**os.environ, "VISMEM_GATEWAY": self.folder})
        # No further images are rendered, so that the calls have the machine.
        simulator = self.enterContext(component(
            "simulator", "cfg/sim/simulator.cfg", "--Simulator.Paused=yes",
            f"--Simulator.Endpoints=tcp -h 127.0.0.1 -p {PORT}:ssl -h 127.0.0.1 -p {SSL_PORT}", "--Ice.Plugin.IceSSL=IceSSL:createIceSSL",
            f"--IceSSL.DefaultDir={self.folder}", "--IceSSL.CAs=ca.pem", "--IceSSL.CertFile=robot.pem", "--IceSSL.VerifyPeer=2",
            '--IceSSL.TrustOnly.Server=OU="station"'))
        simulator.wait_for("simulator ready")
        self.enterContext(component(
            "gateway_access", "deploy/gateway/gateway_access.cfg", f"--GatewayAccess.Endpoints=tcp -h 127.0.0.1 -p {ACCESS_PORT}",
            f"--GatewayAccess.Operators={self.folder}/operators",
            f"--GatewayAccess.Viewers={self.folder}/viewers")).wait_for("gateway_access ready")
        router = self.enterContext(Process([
            "glacier2router", "--Ice.Config=deploy/gateway/operator.cfg", f"--Glacier2.Client.Endpoints=ssl -h 127.0.0.1 -p {ROUTER_PORT}",
            f"--Glacier2.PermissionsVerifier=operators:tcp -h 127.0.0.1 -p {ACCESS_PORT}",
            f"--Glacier2.SessionManager=sessions:tcp -h 127.0.0.1 -p {ACCESS_PORT}",
            f"--Glacier2.Filter.Address.Accept=127.0.0.1:{PORT}", f"--IceSSL.DefaultDir={self.folder}"]))
        self.processes = [os.getpid(), simulator.child.pid, router.child.pid]

    def session(self, communicator, router_type):
        end = time.monotonic() + 30
        while True:
            router = router_type.uncheckedCast(communicator.stringToProxy(f"Operator/router:ssl -h 127.0.0.1 -p {ROUTER_PORT}"))
            try:
                router.createSession("ana", PASSWORD)
                return router
            except Ice.ConnectFailedException:
                self.assertLess(time.monotonic(), end, "the router does not serve")
                time.sleep(0.1)

    def time_of(self, camera, parameters):
        begin = time.perf_counter()
        ok, result = camera.ice_invoke("getImageData", Ice.OperationMode.Idempotent, parameters)
        took = time.perf_counter() - begin
        self.assertTrue(ok)
        self.assertGreater(len(result), 230_000)
        return took

    def test_ratios(self):
        glacier2 = loaded()
        options = ["", "--Ice.MessageSizeMax=16384", "--Ice.Plugin.IceSSL=IceSSL:createIceSSL", f"--IceSSL.DefaultDir={self.folder}",
                   "--IceSSL.CAs=ca.pem", "--IceSSL.CertFile=station.pem", "--IceSSL.CheckCertName=1"]
        with Ice.initialize(options) as communicator:
            router = self.session(communicator, glacier2.RouterPrx)
            behind = communicator.stringToProxy(f"cameraA:tcp -h 127.0.0.1 -p {PORT}")
            cameras = {"tcp": behind, "ssl": communicator.stringToProxy(f"cameraA:ssl -h 127.0.0.1 -p {SSL_PORT}"),
                       "gateway": behind.ice_router(router)}
            # An encapsulation with the string "RGB8": 6 bytes of header, its length, its bytes.
            parameters = bytes([11, 0, 0, 0, 1, 1, 4]) + b"RGB8"
            times = {name: [] for name in cameras}
            processor = dict.fromkeys(cameras, 0.0)
            for turn in range(ROUNDS + 1):
                for name, camera in cameras.items():
                    before = processor_s(self.processes)
                    took = [self.time_of(camera, parameters) for _ in range(CALLS)]
                    if turn > 0:  # the first one connects
                        times[name] += took
                        processor[name] += processor_s(self.processes) - before
        medians = {name: statistics.median(values) for name, values in times.items()}
        for name, median in medians.items():
            print(f"network: image of 320x240 over {name}: {1e6 * median:.0f} us, {median / medians['tcp']:.2f} of tcp "
                  f"(limit {MOST.get(name, 1)}); processor {1e6 * processor[name] / ROUNDS / CALLS:.0f} us, "
                  f"{processor[name] / processor['tcp']:.2f} of tcp", flush=True)
        for name, most in MOST.items():
            self.assertLessEqual(medians[name] / medians["tcp"], most, name)


if __name__ == "__main__":
    unittest.main(verbosity=2)
