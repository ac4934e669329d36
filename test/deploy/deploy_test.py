#!/usr/bin/python3
"""The Debian packages on a robot: installed in a fresh container with systemd as its process 1, started, hurt, stopped,
purged. Tests C2, C3. `scripts/test --deploy` makes what it needs, in the folder that VISMEM_DEPLOY names:
packages/*.deb and image/. Prints what it measured.
"""
import glob
import json
import os
import re
import signal
import subprocess
import sys
import tempfile
import threading
import time
import unittest

sys.dont_write_bytecode = True
HERE = os.path.dirname(os.path.abspath(__file__))
sys.path.insert(0, HERE)
from container import Container, FrozenThread, busiest_thread  # noqa: E402

SETUP = "sim"
PORTS = {"simulator": 9999, "active_visual_memory": 9970, "localization": 9971, "gui_server": 9975}
ALL = ("active_visual_memory", "base_server", "camera_server", "fleet_agent", "gui_server", "localization", "pantilt_server",
       "recorder", "replay_server", "simulator")
TARGET = f"vismem@{SETUP}.target"
POSE_WITHIN_S = 10
KILLED_WITHIN_S = 2
STOPPED_WITHIN_S = 7
FROZEN_WITHIN_S = 13
STOP_WITHIN_S = 2
EXPOSURE = 1.5
GATEWAY_EXPOSURE = 2.5
# What the system itself writes meanwhile.
SYSTEMS_OWN = ("/var/log/", "/var/cache/", "/var/lib/dpkg/", "/var/lib/systemd/", "/var/lib/private", "/run/", "/tmp/",
               "/var/tmp/", "/proc/", "/sys/", "/dev/", "/packages", "/etc/.pwd.lock", "/etc/machine-id")


def unit(component):
    return f"vismem-{component}@{SETUP}.service"


class Watch:
    """The lines of watch.py, read by a thread."""

    def __init__(self, container, slices):
        words = [f"{name}={port}" for name, port in PORTS.items()]
        self.process = subprocess.Popen(
            container.command("/usr/bin/python3", os.path.join(HERE, "watch.py"), slices, *words, only_network=True),
            text=True, stdout=subprocess.PIPE)
        self.lines = []
        self.reader = threading.Thread(target=self._read)
        self.reader.start()

    def _read(self):
        for line in self.process.stdout:
            self.lines.append(json.loads(line))

    def close(self):
        self.process.kill()
        self.process.wait()
        self.reader.join()
        self.process.stdout.close()

    def _whole(self, i, restarted, since):
        """Whether all run and poses come at line i, and all `restarted` are processes begun after `since`."""
        line = self.lines[i]
        if any(line["up"].get(name, ["absent"])[0] != "Running" for name in PORTS):
            return False
        if any(line["up"][name][1] > line["t"] - since for name in restarted):
            return False
        return i >= 5 and line["pose"] > self.lines[i - 5]["pose"]

    def wait_until_whole(self, since, limit_s, restarted=()):
        """Seconds from `since` until all components run and poses come; raises after `limit_s`."""
        seen = max(len(self.lines) - 1, 0)
        while True:
            while seen < len(self.lines):
                line = self.lines[seen]
                if line["t"] > since and self._whole(seen, restarted, since):
                    return line["t"] - since
                if line["t"] > since + limit_s:
                    raise AssertionError(f"not whole after {limit_s} s: {line}")
                seen += 1
            if self.process.poll() is not None:
                raise AssertionError("the watch has ended")
            time.sleep(0.01)


class InContainer(unittest.TestCase):
    """Steps in the order of their names, in one container."""

    @classmethod
    def setUpClass(cls):
        folder = os.environ["VISMEM_DEPLOY"]
        cls.begin = time.monotonic()
        cls.packages = os.path.join(folder, "packages")
        cls.slices = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.slices.cleanup)
        dev, = glob.glob(os.path.join(cls.packages, "vismem-dev_*.deb"))
        subprocess.run(["dpkg-deb", "-x", dev, cls.slices.name], check=True)
        cls.dev = os.path.join(cls.slices.name, "usr")
        cls.container = cls.enterClassContext(Container(os.path.join(folder, "image"), cls.packages))
        cls.report(f"container booted after {time.monotonic() - cls.begin:.1f} s")
        cls.before = cls.files()
        cls.watch = None

    @classmethod
    def tearDownClass(cls):
        if cls.watch:
            cls.watch.close()
        cls.report(f"in all {time.monotonic() - cls.begin:.1f} s")

    @staticmethod
    def report(text):
        print("deploy: " + text, flush=True)

    @classmethod
    def files(cls):
        listing = cls.container.run("find", "/", "-xdev", "-not", "-type", "d").stdout.split("\n")
        return {path for path in listing if not path.startswith(SYSTEMS_OWN)}

    def journal(self, *words):
        return self.container.run("journalctl", "--no-pager", "--output=json", *words, check=False).stdout

    def messages(self, name, **fields):
        """The messages of a unit whose fields have these values."""
        entries = [json.loads(line) for line in self.journal(f"--unit={unit(name)}").splitlines()
                   if line.startswith("{")]
        return [entry["MESSAGE"] for entry in entries
                if all(entry.get(field) == value for field, value in fields.items())]

    def wait_for(self, condition, limit_s, what):
        end = time.monotonic() + limit_s
        while not condition():
            self.assertLess(time.monotonic(), end, what)
            time.sleep(0.1)

    def install(self):
        debs = [f"/packages/{os.path.basename(path)}" for path in glob.glob(os.path.join(self.packages, "*.deb"))
                if "vismem-dev_" not in path]
        self.container.run("dpkg", "--force-unsafe-io", "--install", *debs)

    def test_01_installs_and_starts_nothing(self):
        self.install()
        self.assertEqual(self.container.systemctl("list-units", "--plain", "--no-legend", "vismem*"), "")
        self.assertEqual(self.container.systemctl("--failed", "--plain", "--no-legend"), "")

    def test_02_publishes_a_pose_soon_after_the_start(self):
        type(self).watch = Watch(self.container, os.path.join(self.dev, "share/vismem/slice"))
        begin = time.monotonic()
        self.container.systemctl("start", TARGET)
        self.report(f"systemctl start returned after {time.monotonic() - begin:.1f} s")
        took = self.watch.wait_until_whole(begin, POSE_WITHIN_S)
        self.report(f"all run and poses come {took:.1f} s after the start (limit {POSE_WITHIN_S})")
        for name in PORTS:
            self.assertEqual(self.container.property(unit(name), "NRestarts"), "0", name)
        self.wait_for(lambda: self.container.property(unit("localization"), "StatusText") == "running", 3,
                      "the state in `systemctl status`")

    def pose(self, *options):
        return self.container.run("/usr/bin/python3", os.path.join(self.dev, "share/doc/vismem-dev/examples/robot_client.py"),
                                  "--slices", os.path.join(self.dev, "share/vismem/slice"), *options, "pose", "--seconds", "1",
                                  only_network=True)

    def test_03_the_clients_of_the_packages_work(self):
        pose = self.pose()
        self.assertGreater(len(pose.stdout.splitlines()), 5, pose.stdout)
        status = self.container.run("vismem", "status", SETUP, "--json")
        self.assertEqual(status.stdout.count('"state":"running"'), len(PORTS), status.stdout)

    def test_04_each_component_has_a_user_of_its_own(self):
        users = {}
        for name in PORTS:
            with open(f"/proc/{self.container.process_of(unit(name))}/status") as file:
                fields = dict(line.split(":", 1) for line in file)
            users[name] = fields["Uid"].split()[0]
            self.assertEqual(fields["CapBnd"].strip(), "0" * 16, name)
        self.assertNotIn("0", users.values())
        self.assertEqual(len(set(users.values())), len(PORTS), users)

    def test_05_the_page_gets_the_secret_of_the_components(self):
        script = ("import json, sys, urllib.request as u; g = lambda p: u.urlopen('http://127.0.0.1:8770' + p).read(); "
                  "assert b'<html' in g('/').lower(); print(json.loads(g('/config.json'))['proxies']['Localization'])")
        proxy = self.container.run("/usr/bin/python3", "-c", script, only_network=True).stdout.strip()
        self.assertRegex(proxy, r"^robot\.[0-9a-f]{32}/Localization:ws ")
        token = proxy.split("/")[0].split(".")[1]
        pose = self.pose("--proxy", proxy)
        self.assertGreater(len(pose.stdout.splitlines()), 5, pose.stdout)
        for name in PORTS:
            with open(f"/proc/{self.container.process_of(unit(name))}/cmdline") as file:
                self.assertNotIn(token, file.read(), "other users see arguments")
        self.assertNotIn(token, self.journal())

    def hurt(self, number, limit_s, *names):
        processes = [self.container.process_of(unit(name)) for name in names]
        begin = time.monotonic()
        for process in processes:
            os.kill(process, number)
        took = self.watch.wait_until_whole(begin, limit_s, restarted=names)
        self.report(f"{signal.Signals(number).name} of {' and '.join(names)}: whole after {took:.2f} s (limit {limit_s})")

    def test_06_is_whole_soon_after_the_death_of_any_component(self):
        for name in PORTS:
            self.hurt(signal.SIGKILL, KILLED_WITHIN_S, name)

    def test_07_is_whole_soon_after_any_component_was_stopped(self):
        # Two at a time take half as long; each of them loses what it depends on, or a client.
        self.hurt(signal.SIGSTOP, STOPPED_WITHIN_S, "simulator", "localization")
        self.hurt(signal.SIGSTOP, STOPPED_WITHIN_S, "active_visual_memory", "gui_server")

    def test_08_restarts_a_component_whose_loop_is_frozen(self):
        name = "active_visual_memory"
        process = self.container.process_of(unit(name))
        busiest = busiest_thread(process)
        begin = time.monotonic()
        frozen = FrozenThread(busiest)
        try:
            took = self.watch.wait_until_whole(begin, FROZEN_WITHIN_S, restarted=[name])
        except BaseException:
            frozen.release()
            raise
        self.report(f"one frozen thread of {name}: whole after {took:.2f} s (limit {FROZEN_WITHIN_S})")
        self.assertIn("watchdog", "".join(self.messages(name, PRIORITY="3", _PID="1")).lower())

    def test_09_logs_have_levels(self):
        errors = self.messages("active_visual_memory", PRIORITY="3", _COMM="active_visual_m")
        self.assertTrue(any("no progress for" in text for text in errors), errors)
        everything = self.messages("localization")
        self.assertFalse([text for text in everything if text.startswith("<")], "a level is no part of a message")
        lost = self.messages("localization", PRIORITY="4")
        self.assertTrue(any("lost" in text for text in lost), lost)

    def test_10_components_are_closed_in(self):
        units = [unit(name) for name in ALL] + [TARGET, f"vismem-token@{SETUP}.service", "vismem-retry@x.service",
                                               "vismem-gateway.target", "vismem-gateway@viewer.service"]
        said = self.container.run("systemd-analyze", "verify", "--man=no", *units).stdout
        self.assertFalse([line for line in said.splitlines() if "vismem" in line], said)
        limits = {unit(name): EXPOSURE for name in ALL}
        limits |= {"vismem-gateway_access.service": EXPOSURE, "vismem-gateway@operator.service": GATEWAY_EXPOSURE}
        for name, limit in limits.items():
            answer = self.container.run("systemd-analyze", "security", "--no-pager", name, check=False).stdout
            exposure = float(answer.strip().splitlines()[-1].split(":")[1].split()[0])
            self.report(f"exposure of {name}: {exposure} (limit {limit})")
            self.assertLessEqual(exposure, limit, answer)

    def test_11_a_wrong_configuration_is_tried_once(self):
        name = "localization"
        file = f"/etc/vismem/{SETUP}/{name}.cfg"
        inside = self.container.root + file
        with open(inside) as source:
            text = source.read()
        with open(inside, "w") as target:
            target.write(text + "Localization.Mutaton.Heading_deg = 3\n")
        line = len(text.splitlines()) + 1
        known = len(self.messages(name))
        self.container.systemctl("restart", unit(name), check=False)
        time.sleep(1)  # five times RestartSec
        new = self.messages(name)[known:]
        self.assertEqual(len([text for text in new if text.startswith("Starting ")]), 1, new)
        self.assertEqual(self.container.property(unit(name), "ActiveState"), "failed")
        self.assertEqual(self.container.property(unit(name), "ExecMainStatus"), "2")
        said = [text for text in self.messages(name, PRIORITY="3") if f"{file}:{line}: unknown key" in text]
        self.assertEqual(len(said), 1, new)
        self.report(f"a typo: one start, and in the journal: {said[0]}")
        with open(inside, "w") as target:
            target.write(text)
        begin = time.monotonic()
        self.container.systemctl("start", unit(name))
        self.watch.wait_until_whole(begin, POSE_WITHIN_S)

    def test_12_a_component_that_fails_again_and_again_gets_pauses(self):
        name = "localization"
        system = self.container.root + "/etc/systemd/system"
        drop_ins = {f"{system}/{unit(name)}.d": "[Service]\nExecStart=\nExecStart=/bin/false\n",
                    f"{system}/vismem-retry@.service.d":
                        "[Service]\nExecStart=\nExecStart=/usr/libexec/vismem/retry_unit %i 2\n"}
        for folder, text in drop_ins.items():
            os.mkdir(folder)
            with open(folder + "/test.conf", "w") as file:
                file.write(text)
        broken, quick = drop_ins
        self.container.systemctl("daemon-reload")
        known = len(self.messages(name))
        self.container.systemctl("restart", unit(name), check=False)
        self.wait_for(lambda: self.container.property(unit(name), "ActiveState") == "failed", 10,
                      "it is started for ever")
        starts = [text for text in self.messages(name)[known:] if text.startswith("Starting ")]
        self.assertLessEqual(len(starts), 10)
        os.remove(broken + "/test.conf")
        begin = time.monotonic()
        self.container.systemctl("daemon-reload")
        took = self.watch.wait_until_whole(begin, POSE_WITHIN_S)
        self.report(f"a component that failed ten times is tried again: whole {took:.1f} s later (pause of 2 s)")
        os.remove(quick + "/test.conf")
        os.rmdir(broken)
        os.rmdir(quick)
        self.container.systemctl("daemon-reload")

    def test_13_an_upgrade_restarts_nothing_by_itself(self):
        before = [self.container.process_of(unit(name)) for name in PORTS]
        self.install()
        self.assertEqual([self.container.process_of(unit(name)) for name in PORTS], before)
        begin = time.monotonic()
        self.container.systemctl("restart", TARGET)
        self.watch.wait_until_whole(begin, POSE_WITHIN_S, restarted=["simulator"])
        after = [self.container.process_of(unit(name)) for name in PORTS]
        self.assertFalse(set(before) & set(after), "restarting the target restarts every component")

    def test_14_stops_at_once(self):
        processes = [self.container.process_of(unit(name)) for name in PORTS]
        begin = time.monotonic()
        self.container.systemctl("stop", TARGET)
        # The command returns with the end of the target; its components end after it.
        self.wait_for(lambda: not any(os.path.exists(f"/proc/{process}") for process in processes), STOP_WITHIN_S,
                      "all processes have ended")
        self.report(f"stopped after {time.monotonic() - begin:.2f} s (limit {STOP_WITHIN_S})")
        self.assertEqual(self.container.systemctl("--failed", "--plain", "--no-legend"), "")
        self.assertEqual(self.container.property(unit("localization"), "Result"), "success")

    def test_15_the_recorder_writes_where_it_may(self):
        self.container.systemctl("start", unit("recorder"))
        # With a dynamic user the folder is below private; the other path leads there.
        self.wait_for(lambda: glob.glob(self.container.root + "/var/lib/private/vismem/recordings/*/*"), 10,
                      "a recording")
        self.container.systemctl("stop", unit("recorder"))
        self.assertEqual(self.container.property(unit("recorder"), "Result"), "success")

    def test_16_a_setup_of_ones_own_runs(self):
        own = "my-robot_2.b"
        self.container.run("cp", "-r", f"/etc/vismem/{SETUP}", f"/etc/vismem/{own}")
        self.container.systemctl("daemon-reload")
        self.container.systemctl("enable", "--now", f"vismem@{own}.target")
        states = {name: self.container.property(f"vismem-{name}@{own}.service", "ActiveState") for name in PORTS}
        self.assertEqual(states, dict.fromkeys(PORTS, "active"))

    def test_17_people_come_in_through_the_gateway(self):
        gateway = "/etc/vismem/gateway"
        self.container.systemctl("start", "vismem-gateway.target")
        self.assertEqual(self.container.property("vismem-gateway@operator.service", "ActiveState"), "inactive",
                         "without users and a certificate nothing starts")
        for role, user in (("operator", "ana"), ("viewer", "vera")):
            self.container.run("sh", "-c", f"echo 'open sesame' | vismem gateway_user {role} add {user}")
        self.container.run("vismem", "certificates", "--group", "vismem-gateway", "/root/pki", "make", "gateway", "gateway",
                           "127.0.0.1")
        self.container.run("cp", "-a", "/root/pki/ca.pem", "/root/pki/gateway.pem", gateway)
        self.container.run("sed", "-i", "s/-p 9990/-p 9999/; s/-p 9977/-p 9999/", gateway + "/gateway_access.cfg")
        begin = time.monotonic()
        self.container.systemctl("restart", "vismem-gateway.target")
        routers = ("operator", "viewer")
        self.wait_for(lambda: all(self.container.property(f"vismem-gateway@{role}.service", "ActiveState") == "active"
                                  for role in routers), 10, "both routers run")
        self.report(f"the gateway serves {time.monotonic() - begin:.1f} s after its start")
        for role, user in (("operator", "ana"), ("viewer", "vera")):
            said = self.container.run("/usr/bin/python3", os.path.join(HERE, "log_in.py"), role, user, "open sesame",
                                      self.container.root + gateway, only_network=True).stdout.split()
            self.assertEqual(said, ["read", "drove"] if role == "operator" else ["read", "refused"], said)
        self.container.run("rm", "-r", "/root/pki")

    def test_18_leaves_no_file(self):
        names = self.container.run("dpkg-query", "--show", "--showformat=${Package} ", "vismem-*").stdout.split()
        self.container.run("dpkg", "--purge", *names)
        self.assertEqual(self.files() - self.before, set())
        self.assertEqual(self.container.systemctl("list-units", "--plain", "--no-legend", "vismem*"), "")
        self.report("purged: no file is left")


class Contents(unittest.TestCase):
    """What needs no container."""

    def test_the_packages_are_built_with_what_setup_installs(self):
        root = os.path.dirname(os.path.dirname(HERE))
        with open(os.path.join(root, "scripts/setup")) as setup, open(os.path.join(root, "debian/control")) as control:
            installed = set(re.findall(r"\blib[a-z0-9.+-]+-dev\b", setup.read()))
            needed = set(re.findall(r"\blib[a-z0-9.+-]+-dev\b", control.read().split("\n\n")[0]))
        self.assertEqual(needed, installed - {"libclang-rt-14-dev"}, "that one is for fuzzing only")

    def test_the_command_works_below_a_folder_with_blanks(self):
        with tempfile.TemporaryDirectory() as folder:
            prefix = folder + "/pre fix"
            script = os.path.join(os.path.dirname(os.path.dirname(HERE)), "deploy/install_command.cmake")
            subprocess.run(["cmake", f"-DCMAKE_INSTALL_PREFIX={prefix}", "-P", script], check=True, capture_output=True)
            os.makedirs(prefix + "/libexec/vismem")
            with open(prefix + "/libexec/vismem/show_status", "w") as program:
                program.write('#!/bin/sh\nprintf "%s\\n" "$@"\n')
            os.chmod(program.name, 0o755)
            run = lambda *arguments: subprocess.run([prefix + "/bin/vismem", *arguments], check=True, capture_output=True, text=True).stdout
            self.assertEqual(run("status", "sim").splitlines(), ["--setups", prefix + "/etc/vismem", "sim"])
            self.assertTrue(run("--help").endswith("Programs:\n  show_status\n"), run("--help"))

    def test_names_of_users_have_the_same_letters_in_every_language(self):
        with tempfile.TemporaryDirectory() as folder:
            program = os.path.join(os.path.dirname(os.path.dirname(HERE)), "deploy/gateway/gateway_user")
            for language, user, code in (("tr_TR", "ali", 0), ("de_DE", "j\u00fcrgen", 2)):
                if subprocess.run(["localedef", "-i", language, "-f", "UTF-8", f"{folder}/{language}.UTF-8"], capture_output=True).returncode:
                    self.skipTest(f"no sources of the locale {language} (package locales)")
                done = subprocess.run([program, "viewer", "add", user], input="a long secret\n", text=True, capture_output=True,
                                      env=dict(os.environ, LOCPATH=folder, LC_ALL=language + ".UTF-8", VISMEM_GATEWAY=folder))
                self.assertEqual(done.returncode, code, done.stderr)

    def test_the_headers_for_drivers_compile(self):
        with tempfile.TemporaryDirectory() as folder:
            dev, = glob.glob(os.path.join(os.environ["VISMEM_DEPLOY"], "packages/vismem-dev_*.deb"))
            subprocess.run(["dpkg-deb", "-x", dev, folder], check=True)
            root = folder + "/usr/include/vismem"
            headers = [os.path.relpath(path, root) for path in glob.glob(root + "/**/*.h", recursive=True)]
            self.assertIn("common/robot/control_ports.h", headers)
            source = "".join(f'#include "{header}"\n' for header in headers)
            others = [word for name in ("eigen3", "opencv4", "libusb-1.0") for word in ("-isystem", "/usr/include/" + name)]
            done = subprocess.run(["c++", "-std=c++20", "-Wall", "-Wextra", "-fsyntax-only",
                                   "-DICE_CPP11_MAPPING", "-I", root, *others, "-x", "c++", "-"],
                                  input=source, text=True, stderr=subprocess.PIPE, cwd=folder)
            self.assertEqual(done.stderr, "")


if __name__ == "__main__":
    if "VISMEM_DEPLOY" not in os.environ:
        print("deploy: skipped, VISMEM_DEPLOY names no folder: run scripts/test --deploy")
        sys.exit(77)
    unittest.main(failfast=True, verbosity=2)
