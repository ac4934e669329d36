#!/usr/bin/python3
"""Robot and station over mutual TLS, as deploy/two_machines makes their setups, in network namespaces: rate, cut links, wrong
certificates, renewal, a clock that is off, and what a third machine reaches. Needs root. Prints what it measured.
"""
import json
import os
import re
import subprocess
import sys
import tempfile
import time
import unittest

sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
from namespaces import ADDRESSES, Network  # noqa: E402
from processes import ROOT, Process, component  # noqa: E402

CERTIFICATES = os.path.join(ROOT, "deploy/pki/certificates")
MAKE_SETUP = os.path.join(ROOT, "deploy/two_machines/make_setup")
FAKETIME = "/usr/lib/x86_64-linux-gnu/faketime/libfaketimeMT.so.1"
RATE_HZ = 29.0
DEGRADED_WITHIN_S = 1.0
RUNNING_WITHIN_S = 2.0
RENEWAL_GAP_S = 1.0
CLOCK_NAMED_WITHIN_S = 5.0
MEMORY, PLACE = 9970, 9971
ROBOT_PORT = 9999


def report(text):
    print("network: " + text, flush=True)


def certificates(folder, *words, days=None, shifted=None):
    """deploy/pki/certificates; `shifted`: as if it were another day."""
    environment = dict(os.environ)
    if shifted:
        environment |= {"LD_PRELOAD": FAKETIME, "FAKETIME": shifted}
    subprocess.run([CERTIFICATES, *(["--days", str(days)] if days else []), folder, *words], check=True, env=environment,
                   stdout=subprocess.DEVNULL)


class Watch(Process):
    """watch.py on the station."""

    def __init__(self, network, *components):
        super().__init__(network.command("station", "/usr/bin/python3", os.path.join(HERE, "watch.py"), *components))

    def seen(self):
        return [json.loads(line) for _, line in list(self.lines) if line.startswith("{")]

    def wait_until(self, condition, since, limit_s, what):
        """Seconds from `since` until a line after it fulfils the condition."""
        known = 0
        while True:
            lines = self.seen()
            for line in lines[known:]:
                if line["t"] > since and condition(line):
                    return line["t"] - since
            known = len(lines)
            if time.monotonic() > since + limit_s + 1 or self.child.poll() is not None:
                raise AssertionError(f"{what}: not within {limit_s} s; last: {lines[-1] if lines else self.text()}")
            time.sleep(0.02)


def all_running(line):
    return all(part["state"] == "Running" for name, part in line.items() if name != "t")


class TwoMachines(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        if not os.path.exists(FAKETIME):
            # The loader would go on without it, and certificates that should have ended would be good ones.
            raise FileNotFoundError(f"{FAKETIME} is missing: scripts/setup network")
        cls.folder = cls.enterClassContext(tempfile.TemporaryDirectory(prefix="vismem_network_"))
        cls.network = cls.enterClassContext(Network())
        cls.pki = os.path.join(cls.folder, "pki")
        for name, role in (("robot", "robot"), ("station", "station")):
            certificates(cls.pki, "make", name, role, ADDRESSES[name])
        for source in ("sim", "files"):
            subprocess.run([MAKE_SETUP, "--robot", ADDRESSES["robot"], "--from", os.path.join(ROOT, "cfg", source), "--out",
                            os.path.join(cls.folder, source), "--pki", cls.pki], check=True)

    def start(self, side, name, *options, setup="sim", environment=None):
        process = self.enterContext(component(
            name, os.path.join(self.folder, setup, side, name + ".cfg"), *options,
            prefix=self.network.command(side), environment=environment))
        return process

    def start_all(self):
        self.start("robot", "simulator").wait_for("simulator ready")
        self.start("station", "active_visual_memory").wait_for("active_visual_memory ready")
        self.start("station", "localization").wait_for("localization ready")
        watch = self.enterContext(Watch(self.network, f"active_visual_memory={MEMORY}", f"localization={PLACE}"))
        watch.wait_until(all_running, time.monotonic(), 20, "all running")
        return watch

    def ask(self, proxy, *options, machine="station"):
        done = self.network.run(machine, "/usr/bin/python3", os.path.join(HERE, "ask.py"), proxy, *options)
        return done.stdout.strip().splitlines()[-1]

    def tls(self, certificate=None, folder=None, ca="ca.pem"):
        options = ["--Ice.Plugin.IceSSL=IceSSL:createIceSSL", f"--IceSSL.DefaultDir={folder or self.pki}", f"--IceSSL.CAs={ca}",
                   "--IceSSL.VerifyPeer=2", "--IceSSL.CheckCertName=1", '--IceSSL.TrustOnly.Client=OU="robot"']
        return options + ([f"--IceSSL.CertFile={certificate}"] if certificate else [])

    def test_1_images_come_at_their_rate(self):
        watch = self.start_all()
        time.sleep(2)
        first = watch.seen()[-1]
        time.sleep(10)
        last = watch.seen()[-1]
        frames = (last["active_visual_memory"]["totals"]["frames"] - first["active_visual_memory"]["totals"]["frames"])
        rate = frames / (last["t"] - first["t"])
        report(f"images at the station: {rate:.1f} Hz (at least {RATE_HZ})")
        self.assertGreaterEqual(rate, RATE_HZ)
        days = last["active_visual_memory"]["gauges"]["certificate days left"]
        self.assertTrue(89 < days <= 90, days)

    def test_2_a_cut_link_is_named_and_comes_back(self):
        watch = self.start_all()
        for cut_s in (3, 12):
            self.network.cut("robot")
            begin = time.monotonic()
            took = watch.wait_until(lambda line: line["active_visual_memory"]["state"] == "Degraded", begin, 10, "degraded")
            report(f"link cut for {cut_s} s: degraded after {took:.2f} s (limit {DEGRADED_WITHIN_S})")
            self.assertLessEqual(took, DEGRADED_WITHIN_S)
            time.sleep(max(0.0, begin + cut_s - time.monotonic()))
            self.network.join("robot")
            begin = time.monotonic()
            took = watch.wait_until(all_running, begin, 20, "running again")
            report(f"link back after {cut_s} s: running after {took:.2f} s (limit {RUNNING_WITHIN_S})")
            self.assertLessEqual(took, RUNNING_WITHIN_S)
            time.sleep(2)

    def test_3_no_wrong_certificate_is_accepted(self):
        simulator = self.start("robot", "simulator")
        simulator.wait_for("simulator ready")
        wrong = os.path.join(self.folder, "wrong")
        certificates(wrong, "make", "station", "station", ADDRESSES["station"])
        certificates(self.pki, "make", "thief", "robot", ADDRESSES["station"])
        certificates(self.pki, "make", "expired", "station", ADDRESSES["station"], days=1, shifted="-10d")
        certificates(self.pki, "make", "early", "station", ADDRESSES["station"], shifted="+10d")
        proxy = f"cameraA:ssl -h {ADDRESSES['robot']} -p {ROBOT_PORT}"
        self.assertEqual(self.ask(proxy, *self.tls("station.pem")), "accepted")
        calls = {
            "of another authority": self.tls("station.pem", folder=wrong, ca=os.path.join(self.pki, "ca.pem")),
            "of another role": self.tls("thief.pem"),
            "expired": self.tls("expired.pem"),
            "not yet valid": self.tls("early.pem"),
            "none": self.tls(),
        }
        answers = {name: self.ask(proxy, *options) for name, options in calls.items()}
        plain = f"cameraA:tcp -h {ADDRESSES['robot']} -p {ROBOT_PORT}"
        answers["no TLS"] = self.ask(plain)
        for name, answer in answers.items():
            report(f"caller's certificate {name}: {answer}")
        self.assertNotIn("accepted", answers.values())
        self.assertEqual(self.ask(proxy, *self.tls("station.pem")), "accepted")

    def test_4_the_station_follows_no_wrong_robot(self):
        certificates(self.pki, "make", "elsewhere", "robot", "10.77.0.99")
        certificates(self.pki, "make", "impostor", "station", ADDRESSES["robot"])
        proxy = f"cameraA:ssl -h {ADDRESSES['robot']} -p {ROBOT_PORT}"
        for name, certificate in (("of another host", "elsewhere.pem"), ("of another role", "impostor.pem"),
                                  ("expired", "old.pem")):
            if certificate == "old.pem":
                certificates(self.pki, "make", "old", "robot", ADDRESSES["robot"], days=1, shifted="-10d")
            with component("simulator", os.path.join(self.folder, "sim/robot/simulator.cfg"), f"--IceSSL.CertFile={certificate}",
                           prefix=self.network.command("robot")) as simulator:
                simulator.wait_for("simulator ready")
                answer = self.ask(proxy, *self.tls("station.pem"))
                report(f"robot's certificate {name}: {answer}")
                self.assertNotEqual(answer, "accepted")
                if certificate == "old.pem":
                    simulator.wait_for("certificate: has ended on", 5)

    def serial(self):
        """Of the certificate that the robot shows now."""
        shown = self.network.run("station", "openssl", "s_client", "-connect", f"{ADDRESSES['robot']}:{ROBOT_PORT}", "-cert",
                                 os.path.join(self.pki, "station.pem"), "-CAfile", os.path.join(self.pki, "ca.pem")).stdout
        certificate = re.search(r"-----BEGIN CERTIFICATE-----.*?-----END CERTIFICATE-----", shown, re.DOTALL).group(0)
        return subprocess.run(["openssl", "x509", "-noout", "-serial"], input=certificate, text=True, check=True,
                              stdout=subprocess.PIPE).stdout

    def test_5_a_renewal_interrupts_nothing(self):
        certificates(self.pki, "make", "robot", "robot", ADDRESSES["robot"], days=20)
        watch = self.start_all()
        said = watch.seen()[-1]
        robot = self.start("station", "active_visual_memory", "--ActiveVisualMemory.Endpoints=tcp -h 127.0.0.1 -p 21970",
                           "--IceSSL.CertFile=robot.pem")
        robot.wait_for("the certificate ends in 19 days")
        before = self.serial()
        begin = time.monotonic()
        certificates(self.pki, "renew", "robot", "station")
        renewed = time.monotonic()
        while self.serial() == before:
            self.assertLess(time.monotonic(), renewed + 5, "the new certificate is not shown")
            time.sleep(0.1)
        report(f"renewed certificates are shown after {time.monotonic() - renewed:.1f} s")
        time.sleep(3)
        frames = [(line["t"], line["active_visual_memory"]["totals"]["frames"]) for line in watch.seen()
                  if line["t"] > begin - 1 and line["active_visual_memory"]["state"] != "absent"]
        arrivals = [t for (t, n), (_, before_n) in zip(frames[1:], frames) if n > before_n]
        gap = max(b - a for a, b in zip(arrivals, arrivals[1:]))
        report(f"longest gap between images: {gap:.2f} s (limit {RENEWAL_GAP_S})")
        self.assertLessEqual(gap, RENEWAL_GAP_S)
        # Connections of the renewed certificates on both sides, after a cut that closes the old ones.
        self.network.cut("robot")
        time.sleep(12)
        self.network.join("robot")
        watch.wait_until(all_running, time.monotonic(), 20, "running with the new certificates")
        self.assertGreater(watch.seen()[-1]["active_visual_memory"]["gauges"]["certificate days left"], 89)
        self.assertEqual([error for error in said["active_visual_memory"]["errors"] if "certificate" in error], [])

    def test_6_a_clock_that_is_off_is_named(self):
        for name in ("camera_server", "pantilt_server", "base_server"):
            self.start("robot", name, setup="files").wait_for(f"{name} ready")
        for offset in ("+0.5", "-0.5", "+2"):
            with component("active_visual_memory", os.path.join(self.folder, "files/station/active_visual_memory.cfg"),
                           prefix=self.network.command("station"),
                           environment={"LD_PRELOAD": FAKETIME, "FAKETIME": offset + "s", "FAKETIME_DONT_FAKE_MONOTONIC": "1"}) as memory:
                memory.wait_for("active_visual_memory ready")
                begin = time.monotonic()
                line = memory.wait_for("this host's clock", 15)
                took = time.monotonic() - begin
                report(f"station's clock off by {offset} s: named after {took:.1f} s (limit {CLOCK_NAMED_WITHIN_S}): {line}")
                self.assertLessEqual(took, CLOCK_NAMED_WITHIN_S)
                number = re.search(r"stamps are ([\d.]+) s (behind|ahead of)", line)
                self.assertAlmostEqual(float(number.group(1)), abs(float(offset)), delta=0.2)
                self.assertEqual(number.group(2), "behind" if offset.startswith("+") else "ahead of")
        with component("active_visual_memory", os.path.join(self.folder, "files/station/active_visual_memory.cfg"),
                       prefix=self.network.command("station")) as memory:
            memory.wait_for("active_visual_memory ready")
            time.sleep(6)
            self.assertNotIn("this host's clock", memory.text())

    def listening(self, name):
        """Ports that a machine serves beyond its loopback, from the kernel's tables."""
        found = set()
        for line in self.network.run(name, "cat", "/proc/net/tcp", "/proc/net/tcp6").stdout.splitlines():
            words = line.split()
            if len(words) > 3 and words[3] == "0A" and not words[1].startswith(("0100007F:", "0" * 24 + "01000000:")):
                found.add(int(words[1].rsplit(":", 1)[1], 16))
        return found

    def connects(self, address, port):
        script = "import socket,sys; socket.create_connection((sys.argv[1], int(sys.argv[2])), 3)"
        return self.network.run("people", "/usr/bin/python3", "-c", script, address, str(port)).returncode == 0

    def start_gateway(self):
        """The files of deploy/gateway as they are, on the station."""
        folder = os.path.join(self.folder, "gateway")
        certificates(folder, "make", "gateway", "gateway", ADDRESSES["station"])
        for role in ("operator", "viewer"):
            subprocess.run([os.path.join(ROOT, "deploy/gateway/gateway_user"), role, "add", "ana"], input="open sesame\n", text=True,
                           check=True, env={**os.environ, "VISMEM_GATEWAY": folder})
        self.enterContext(component(
            "gateway_access", "deploy/gateway/gateway_access.cfg", f"--GatewayAccess.Operators={folder}/operators",
            f"--GatewayAccess.Viewers={folder}/viewers", prefix=self.network.command("station"))).wait_for("gateway_access ready")
        for role in ("operator", "viewer"):
            self.enterContext(Process(self.network.command(
                "station", "glacier2router", f"--Ice.Config=deploy/gateway/{role}.cfg", f"--IceSSL.DefaultDir={folder}")))
        return folder

    def test_7_a_third_machine_reaches_the_gateway_alone(self):
        self.start("robot", "simulator").wait_for("simulator ready")
        for name in ("active_visual_memory", "localization"):
            self.start("station", name).wait_for(f"{name} ready")
        authority = self.start_gateway()
        router = f"Operator/router:ssl -h {ADDRESSES['station']} -p 4064"
        browser = self.tls(folder=authority)[:-1]
        end = time.monotonic() + 20
        while self.ask(router, *browser, machine="people") != "accepted":
            self.assertLess(time.monotonic(), end, "the gateway does not answer")
        served = {name: self.listening(name) for name in ("robot", "station")}
        report(f"ports beyond loopback: {served}")
        self.assertEqual(served["station"], {4064, 4065, 4066, 4067})
        with open(os.path.join(self.folder, "sim/robot/simulator.cfg")) as file:
            secured = {int(port) for port in re.findall(r"ssl -h \S+ -p (\d+)", file.read())}
        self.assertEqual(served["robot"], secured)
        for port in sorted(served["robot"]):
            self.assertTrue(self.connects(ADDRESSES["robot"], port), "the wire carries it")
            for transport in ("tcp", "ssl"):
                answer = self.ask(f"cameraA:{transport} -h {ADDRESSES['robot']} -p {port}", *self.tls(), machine="people")
                self.assertNotEqual(answer, "accepted", f"{transport} {port}")
        for port in (MEMORY, PLACE, 4069):
            self.assertFalse(self.connects(ADDRESSES["station"], port), port)


if __name__ == "__main__":
    if os.geteuid() != 0:
        print("network: skipped, network namespaces need root")
        sys.exit(77)
    unittest.main(verbosity=2)
