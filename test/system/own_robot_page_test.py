#!/usr/bin/python3
"""own_robot_page_test.py BIN_DIR: the server of scripts/own_robot NAME page: whom it answers, what it runs, how that is stopped.
The programs behind the steps are shell scripts. Tests B5, B6."""
import concurrent.futures
import contextlib
import filecmp
import functools
import http.client
import json
import os
import re
import resource
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
BIN = os.path.abspath(sys.argv.pop(1))
sys.path.insert(0, os.path.join(ROOT, "scripts", "wizard"))
sys.dont_write_bytecode = True
from programs import run  # noqa: E402
from step_run import progress_of  # noqa: E402
from steps import TABLE  # noqa: E402


class Page(unittest.TestCase):
    def setUp(self):
        self.root = self.enterContext(tempfile.TemporaryDirectory(prefix="vismem_own_robot_page_"))
        shutil.copytree(os.path.join(ROOT, "cfg"), self.path("cfg"))
        for name in ("scripts", "components"):
            os.symlink(os.path.join(ROOT, name), self.path(name))
        os.makedirs(self.path("build/release/bin"))
        self.page = None
        self.open()

    def path(self, name):
        return os.path.join(self.root, name)

    def write(self, name, text):
        os.makedirs(os.path.dirname(self.path(name)), exist_ok=True)
        with open(self.path(name), "w", encoding="utf-8") as file:
            file.write(text)

    def program(self, name, script):
        """What takes the place of a program of the build."""
        self.write(f"build/release/bin/{name}", "#!/bin/sh\n" + script)
        os.chmod(self.path(f"build/release/bin/{name}"), 0o755)

    def open(self, *arguments, **options):
        self.page = subprocess.Popen([self.path("scripts/own_robot"), "mine", "page", "--port", "0", *arguments], stdout=subprocess.PIPE, text=True, **options)
        self.addCleanup(self.close, self.page)
        self.address = re.match(r"page (\S+)", self.page.stdout.readline()).group(1)
        self.port, self.token = re.fullmatch(r"http://127\.0\.0\.1:(\d+)/([\w-]{24})/", self.address).groups()
        self.host = f"127.0.0.1:{self.port}"

    @staticmethod
    def close(page):
        if page.poll() is None:
            page.terminate()
        page.wait(30)
        page.stdout.close()

    def ask(self, path, order=None, token=None, **headers):
        """@return status and body. Headers by name, with _ for -; None leaves one out."""
        given = {"Host": self.host}
        if order is not None:
            given.update({"Origin": f"http://{self.host}", "Content-Type": "application/json"})
        given.update({name.replace("_", "-"): value for name, value in headers.items()})
        body = None if order is None else order if isinstance(order, str) else json.dumps(order)
        connection = http.client.HTTPConnection("127.0.0.1", int(self.port), timeout=20)
        place = f"/{self.token if token is None else token}/{path}"
        connection.putrequest("GET" if order is None else "POST", place, skip_host=True, skip_accept_encoding=True)
        for name, value in {**given, **({} if body is None else {"Content-Length": str(len(body.encode()))})}.items():
            if value is not None:
                connection.putheader(name, value)
        connection.endheaders(None if body is None else body.encode())
        answer = connection.getresponse()
        self.headers = answer.headers
        text = answer.read().decode()
        connection.close()
        return answer.status, text

    def run_step(self, step, **arguments):
        return self.ask("run", {"step": step, "arguments": {f"--{name.replace('_', '-')}": value for name, value in arguments.items()}})

    def output(self, step):
        """Of its newest run, once that has ended."""
        for _ in range(300):
            found = json.loads(self.ask(f"output/{step}")[1])
            if found and found["code"] is not None:
                return found
            time.sleep(0.05)
        raise AssertionError(f"{step} did not end")

    def wait_for(self, name):
        for _ in range(300):
            if os.path.exists(self.path(name)):
                return
            time.sleep(0.05)
        raise AssertionError(f"{name} did not come")

    def state(self, event="state"):
        """The first state, or other event, of the stream of events."""
        with socket.create_connection(("127.0.0.1", int(self.port)), timeout=20) as stream:
            stream.sendall(f"GET /{self.token}/events HTTP/1.1\r\nHost: {self.host}\r\n\r\n".encode())
            with stream.makefile(encoding="utf-8") as lines:
                for line in lines:
                    if line == f"event: {event}\n":
                        return json.loads(next(lines)[len("data: "):])

    def step(self, name):
        return next(step for step in self.state()["steps"] if step["name"] == name)


class Refusals(Page):
    def test_other_hosts_are_refused(self):
        self.assertEqual(self.ask("")[0], 200)
        self.assertEqual(self.ask("", Host=f"localhost:{self.port}")[0], 200)
        for host in ("rebound.example", f"rebound.example:{self.port}", "127.0.0.1", "127.0.0.1:1", f"127.0.0.1.example:{self.port}", "", None):
            for path in ("", "events", "output/map"):
                status, said = self.ask(path, Host=host)
                self.assertEqual(status, 403, f"{host} {path} {said}")
            self.assertEqual(self.ask("run", {"step": "start"}, Host=host)[0], 403)
        self.assertFalse(os.path.exists(self.path("cfg/mine")))

    def test_other_sites_are_refused(self):
        for origin in ("http://evil.example", "null", f"https://{self.host}", f"http://{self.host}.evil.example", f"http://localhost:{self.port}", None):
            self.assertEqual(self.ask("run", {"step": "start"}, Origin=origin)[0], 403, origin)
            self.assertEqual(self.ask("stop", {}, Origin=origin)[0], 403, origin)
        self.assertEqual(self.ask("", Origin="http://evil.example")[0], 403)
        # A form of another site can send these without a question to this server.
        for kind in ("text/plain", "application/x-www-form-urlencoded", "multipart/form-data", None):
            self.assertEqual(self.ask("run", {"step": "start"}, Content_Type=kind)[0], 403, kind)
        self.assertFalse(os.path.exists(self.path("cfg/mine")))

    def test_the_token_is_needed_for_everything(self):
        for token in ("", "x", self.token[:-1], self.token + "x", self.token.swapcase(), "%00"):
            for path in ("", "page.js", "events", "output/map", "result/map/0/map.png"):
                status, said = self.ask(path, token=token)
                self.assertEqual(status, 403, f"{token} {path}")
                self.assertNotIn(self.token, said)
            self.assertEqual(self.ask("run", {"step": "start"}, token=token)[0], 403)
        for target in ("*", f"/{self.token}", "/\xe4/", f"http://{self.host}/"):
            with socket.create_connection(("127.0.0.1", int(self.port)), timeout=20) as plain:
                plain.sendall(f"GET {target} HTTP/1.1\r\nHost: {self.host}\r\nConnection: close\r\n\r\n".encode("latin-1"))
                self.assertIn(b" 403 ", plain.recv(200), target)
        os.chmod(self.path("out/own_robot/mine/page/address"), 0o644)
        self.close(self.page)
        self.open()
        self.assertEqual(os.stat(self.path("out/own_robot/mine/page/address")).st_mode & 0o777, 0o600)

    def test_only_loopback_is_served(self):
        with open("/proc/net/tcp", encoding="ascii") as table:
            listening = [line.split()[1] for line in table if line.split()[3] == "0A"]
        self.assertEqual([place for place in listening if place.endswith(f":{int(self.port):04X}")], [f"0100007F:{int(self.port):04X}"])

    def test_what_follows_an_order_of_unknown_length_is_no_request(self):
        within = f"GET /{self.token}/ HTTP/1.1\r\nHost: {self.host}\r\n\r\n"
        for length in ("Content-Length: 12345678901", "Content-Length: +5", "Transfer-Encoding: chunked", "X: y"):
            with socket.create_connection(("127.0.0.1", int(self.port)), timeout=20) as plain:
                plain.sendall(f"POST /x/run HTTP/1.1\r\nHost: {self.host}\r\n{length}\r\n\r\n{within}".encode())
                with plain.makefile("rb") as said, contextlib.suppress(ConnectionResetError):
                    self.assertNotIn(b" 200 ", said.read(), length)

    def test_unknown_steps_and_orders_are_refused(self):
        for step in ("jump", "page", "", None, "../start", "start --simulated", ["start"], {"a": 1}):
            status, said = self.ask("run", {"step": step})
            self.assertEqual(status, 400, said)
            self.assertIn("unknown step", said)
        for order in ("", "[]", "3", "{", '{"step": "start", "arguments": []}'):
            self.assertEqual(self.ask("run", order)[0], 400, order)
        self.assertEqual(self.ask("shell", {})[0], 404)
        self.assertEqual(self.ask("stop", {})[0], 409)
        self.assertEqual(self.ask("run", json.dumps({"step": "x" * (1 << 20)}))[0], 413)
        self.assertEqual(self.ask("run", "{}", Content_Length=None)[0], 400)

    def test_undeclared_arguments_are_refused(self):
        for step, name, value in (("target", "--out", "/tmp/x"), ("start", "--bag", "x"), ("ruler", "THIRD", 3), ("map", "--config", "x"),
                                  ("drive", "--Recorder.Folder", "/tmp"), ("drive", "--Simulator.Camera.Rate_hz", 5), ("lens", "", "x")):
            status, said = self.ask("run", {"step": step, "arguments": {name: value}})
            self.assertEqual(status, 400, said)
            self.assertIn(f"{step}: unknown argument {name!r}", json.loads(said)["error"])

    def test_values_of_another_kind_are_refused(self):
        for step, name, value, expected in (
                ("start", "--seed", "1 --uncalibrated", "a whole number"), ("start", "--seed", -1, "a whole number"), ("start", "--seed", True, "a whole number"),
                ("start", "--simulated", "../../etc/passwd", "one of alike_wings, corridor"), ("start", "--uncalibrated", "yes", "true or false"),
                ("ruler", "ACROSS", "--write", "a number"), ("ruler", "ACROSS", "1e3", "a number"), ("ruler", "ACROSS", "", "a number"),
                ("lens", "--images", "views\n--out=/tmp", "a text of one line"), ("lens", "--images", "a\0b", "a text of one line"),
                ("start", "--seed", "\u0663", "a whole number"), ("lens", "--images", "x" * 5000, "a text of one line, of at most 1024 characters"),
                ("lens", "--images", ["a"], "a text of one line"), ("lens", "--images", " ", "a text of one line"), ("target", "--paper", "A9", "one of A4, A3")):
            status, said = self.ask("run", {"step": step, "arguments": {name: value}})
            self.assertEqual(status, 400, said)
            self.assertIn(f"expected {expected}", json.loads(said)["error"])
            self.assertLess(len(said), 500)
        self.assertFalse(os.path.exists(self.path("cfg/mine")))

    def test_a_value_is_never_an_argument_or_a_command(self):
        self.write("out/own_robot/mine/board/board.json", "{}")
        self.program("calibrate", 'for word; do echo "word: $word"; done; exit 3\n')
        for value in ("--out=/tmp/x", "--write", "$(touch mine)", "; touch mine", "a b 'c' \"d\"", "../../x"):
            self.assertEqual(self.run_step("lens", images=value)[0], 200)
            found = self.output("lens")
            self.assertEqual(found["code"], 3)
            self.assertEqual([line for line in found["lines"] if line.startswith("word: ")][-1], f"word: --images={value}")
        self.assertFalse(os.path.exists(self.path("mine")))

    def test_only_files_of_steps_are_served(self):
        self.write("out/own_robot/mine/map/map.png", "a picture")
        self.write("out/own_robot/mine/colours/shown/clicks.html", "<script>1</script>")
        self.assertEqual(self.ask("result/map/0/map.png"), (200, "a picture"))
        self.assertEqual(self.ask("result/colours/1/clicks.html")[0], 200)
        self.assertIn("sandbox allow-scripts", self.headers["Content-Security-Policy"])
        for path in ("result/map/0/other.png", "result/map/9/map.png", "result/map/0/../../../cfg/sim/simulator.cfg", "result/nothing/0/map.png", "result/map",
                     "result", "result/map/0/map.png/..", "../own_robot", "..%2f..%2fown_robot", "page_server.py", "output/nothing", "output/../x", "cfg"):
            self.assertEqual(self.ask(path)[0], 404, path)

    def test_files_that_a_browser_sends_stay_in_their_folder(self):
        status, said = self.ask("file", {"name": "place.clicks", "text": "floor 1.ppm 3 4\n"})
        self.assertEqual((status, json.loads(said)["path"]), (200, "out/own_robot/mine/page/files/place.clicks"))
        for name in ("../place", "/etc/x", "a/b", "", ".hidden", "-x", "a\nb", None, "x" * 200):
            self.assertEqual(self.ask("file", {"name": name, "text": ""})[0], 400, name)
        self.assertEqual(self.ask("file", {"name": "x"})[0], 400)
        self.assertEqual(os.listdir(self.path("out/own_robot/mine/page/files")), ["place.clicks"])


    def test_pages_that_are_open_leave_a_connection_for_stop(self):
        streams = []
        for _ in range(6):
            stream = self.enterContext(socket.create_connection(("127.0.0.1", int(self.port)), timeout=20))
            stream.sendall(f"GET /{self.token}/events HTTP/1.1\r\nHost: {self.host}\r\n\r\n".encode())
            streams.append(stream.makefile(encoding="utf-8"))
            self.assertIn("event: state\n", streams[-1])
        self.assertTrue(all("event: elsewhere\n" in list(stream) for stream in streams[:2]), "they end")
        for stream in streams[2:]:
            self.assertIn(": still here\n", (stream.readline() for _ in range(20)))


class Runs(Page):
    LONG = "trap 'kill $!; echo stopped by $1; exit 1' INT TERM\necho began; touch began\nsleep 60 & wait $!\n"

    def test_a_step_is_run_as_by_the_command_line(self):
        self.assertEqual(self.state()["kind"], "none")
        self.assertEqual(self.run_step("start", simulated="room", seed=3)[0], 200)
        found = self.output("start")
        self.assertEqual(found["code"], 0, found)
        self.assertIn("cfg/mine is a copy of cfg/sim.", found["lines"])
        self.assertIn("+Simulator.Seed = 3", found["lines"])
        state = self.state()
        self.assertEqual((state["kind"], state["next"], state["running"]), ("simulated", "drive", None))
        self.assertEqual({step["name"]: step["state"] for step in state["steps"]},
                         {"start": "done", "devices": "any", "target": "none", "ruler": "none", "lens": "none", "body": "none", "drive": "-", "colours": "-",
                          "map": "-", "localize": "-", "robot": "any"})
        self.assertEqual([argument["name"] for argument in self.step("drive")["arguments"]],
                         ["--seconds", "--bag", "--topics", "--port-offset", "--Simulator.Camera.Rate_hz"])

    def test_keys_of_devices_are_set(self):
        self.program("list_devices", 'echo "asked: $*"\n')
        self.run_step("start")
        self.output("start")
        keys = {argument["name"]: argument["default"] for argument in self.step("devices")["arguments"]}
        self.assertEqual((len(keys), keys["--BaseServer.Driver"]), (5, "pioneer"))
        self.assertEqual(self.ask("run", {"step": "devices", "arguments": {"--BaseServer.Port": "/dev/tty #x"}})[0], 400)
        self.ask("run", {"step": "devices", "arguments": {"--BaseServer.Port": "/dev/tty USB0"}})
        found = self.output("devices")
        self.assertEqual((found["code"], found["lines"][-1]), (0, "asked: "))
        self.assertIn("+BaseServer.Port = /dev/tty USB0", found["lines"])
        self.assertEqual(next(a for a in self.step("devices")["arguments"] if a["name"] == "--BaseServer.Port")["default"], "/dev/tty USB0")

    def test_the_robot_that_runs_is_shown_and_stopped(self):
        self.run_step("start")
        self.output("start")
        self.assertEqual(self.step("robot")["state"], "any")
        self.program("base_server", "trap 'kill $!; exit 0' TERM\ntouch began\nsleep 60 & wait\n")
        with subprocess.Popen([self.path("build/release/bin/base_server")], cwd=self.root) as server:
            self.wait_for("began")
            self.write("out/mine/pids", f"{server.pid} base_server\n")
            self.assertEqual((self.step("robot")["state"], self.step("robot")["how"]), ("on", "base_server"))
            self.run_step("robot", stop=True)
            self.assertEqual(self.output("robot")["lines"], ["stop: base_server ended"])
            self.assertEqual(server.wait(10), 0)
        self.assertEqual(self.step("robot")["state"], "any")

    def test_all_is_stopped_although_nobody_reads(self):
        self.program("base_server", "trap 'kill $!; exit 0' TERM\ntouch began$1\nsleep 60 & wait\n")
        servers = [subprocess.Popen([self.path("build/release/bin/base_server"), str(number)], cwd=self.root) for number in range(2)]
        for number in range(2):
            self.wait_for(f"began{number}")
        self.write("out/mine/pids", "".join(f"{server.pid} base_server\n" for server in servers))
        nobody, writes = os.pipe()
        os.close(nobody)  # as after a kill of the page
        with open(writes, "wb") as gone:
            self.assertEqual(subprocess.run([self.path("scripts/stop"), "mine"], stdout=gone, stderr=gone).returncode, 0)
        self.assertEqual([server.wait(10) for server in servers], [0, 0])

    def test_an_error_is_in_the_programs_own_words(self):
        self.assertEqual(self.run_step("map")[0], 200)
        found = self.output("map")
        self.assertEqual((found["code"], found["lines"][-1]), (1, "own_robot: drive comes first: scripts/own_robot mine drive"))
        self.assertEqual(self.step("map")["missing"], ["drive", "colours"])

    def test_one_step_at_a_time(self):
        self.program("list_devices", self.LONG)
        with concurrent.futures.ThreadPoolExecutor(8) as pool:
            answers = list(pool.map(lambda _: self.run_step("devices"), range(8)))
        self.assertEqual(sorted(status for status, _ in answers), [200] + [409] * 7)
        self.assertIn("devices runs: one step at a time", self.run_step("start")[1])
        self.assertEqual(self.state()["running"]["step"], "devices")
        self.assertEqual(self.ask("stop", {})[0], 200)
        self.output("devices")
        self.assertEqual(self.run_step("start")[0], 200)

    def own_robot(self, *arguments, **options):
        """On the command line."""
        return subprocess.run([self.path("scripts/own_robot"), "mine", *arguments], capture_output=True, text=True, **options)

    def test_neither_does_the_command_line_run_another_step(self):
        self.program("list_devices", self.LONG)
        self.run_step("devices")
        self.wait_for("began")
        done = self.own_robot("start")
        self.assertRegex(done.stderr, r"^own_robot: devices \(process \d+\) of mine runs already, in a terminal or on the page: one step at a time\n$")
        self.assertEqual((done.returncode, os.path.exists(self.path("cfg/mine"))), (1, False))
        self.ask("stop", {})
        self.output("devices")
        os.remove(self.path("began"))
        with subprocess.Popen([self.path("scripts/own_robot"), "mine", "devices"], stdout=subprocess.PIPE) as terminal:
            self.wait_for("began")
            self.run_step("start")
            found = self.output("start")
            self.assertEqual(found["code"], 1)
            self.assertIn("of mine runs already, in a terminal", found["lines"][-1])
            terminal.terminate()
        self.assertEqual(self.own_robot("start").returncode, 0)

    def test_files_that_cannot_be_written_or_read_are_named(self):
        self.write("out/own_robot/mine/page/files", "in the way")
        self.assertEqual(self.ask("file", {"name": "x", "text": ""}), (500, '{"error": "out/own_robot/mine/page/files: File exists"}'))
        os.makedirs(self.path("out/own_robot/mine/page/devices.json"))
        self.program("list_devices", "echo found\n")
        shutil.copytree(self.path("cfg/robot"), self.path("cfg/mine"))
        before, after = self.path("cfg/robot/base_server.cfg"), self.path("cfg/mine/base_server.cfg")
        limit = functools.partial(resource.setrlimit, resource.RLIMIT_FSIZE, 2 * (os.path.getsize(before),))
        done = self.own_robot("devices", "--BaseServer.Port=" + "x" * 99, preexec_fn=limit)
        self.assertEqual((done.returncode, done.stderr), (1, "own_robot: File too large\n"))
        self.assertTrue(filecmp.cmp(before, after, shallow=False), "a full disk empties no file")
        shutil.rmtree(self.path("cfg/mine"))
        self.run_step("devices")
        self.assertEqual(self.output("devices")["lines"],
                         ["found", "warning: out/own_robot/mine/page/devices.json: Is a directory: the next page will not know of this run"])
        self.run_step("start", simulated="room")
        self.output("start")
        self.write("out/own_robot/mine/localize/verdict.json", "")  # cut off by a full disk
        self.assertEqual(self.step("localize")["state"], "-")
        with open(self.path("cfg/mine/simulator.cfg"), "ab") as file:
            file.write(b"# gr\xfc\xdfe\n")
        self.assertRegex(self.state("trouble")["text"], r"^cfg/mine/simulator\.cfg: byte \d+ is not UTF-8 \(expected a text in UTF-8\)$")
        done = self.own_robot()
        self.assertEqual((done.returncode, done.stderr), (1, f"own_robot: {self.state('trouble')['text']}\n"))
        shutil.rmtree(self.path("cfg/mine"))
        os.rename(self.path("out"), self.path("before"))
        self.write("out", "in the way")
        self.assertEqual((done := self.own_robot("devices")).stderr, "own_robot: out/own_robot: Not a directory\n", done)

    def test_the_pages_port_offset_is_suggested(self):
        self.close(self.page)
        self.open("--port-offset", "700")
        self.run_step("start")
        self.output("start")
        defaults = {argument["name"]: argument["default"] for step in ("lens", "drive") for argument in self.step(step)["arguments"]}
        self.assertEqual((defaults["--camera"], defaults["--port-offset"]), ("cameraA:tcp -h 127.0.0.1 -p 10699", 700))

    def test_stop_reaches_the_program_and_leaves_nothing(self):
        self.program("list_devices", self.LONG + "echo not reached\n")
        self.run_step("devices")
        self.wait_for("began")
        self.assertEqual(self.ask("stop", {})[0], 200)
        found = self.output("devices")
        self.assertEqual(found["code"], 130, found)
        self.assertIn("own_robot: devices was stopped before its end and can be repeated", found["lines"])
        self.assertNotIn("not reached", found["lines"])
        self.assertEqual(self.running_here(), [])

    def test_what_a_step_leaves_behind_is_ended(self):
        self.program("list_devices", "sleep 60 &\necho found\n")
        self.run_step("devices")
        found = self.output("devices")
        self.assertEqual((found["code"], found["lines"]), (0, ["found"]))
        self.assertEqual(self.running_here(), [])

    def test_a_step_that_does_not_listen_is_stopped_more_firmly(self):
        self.program("list_devices", "trap '' INT TERM\ntouch began\nsleep 60\n")
        self.run_step("devices")
        self.wait_for("began")
        for stops in (1, 2, 3):
            self.assertEqual(self.ask("stop", {})[0], 200)
            if stops < 3:
                self.assertEqual(self.ask("stop", {})[0], 200)  # a double click
                self.assertEqual(self.state()["running"]["stops"], stops)
                time.sleep(2.1)
        self.assertEqual(self.output("devices")["code"], -signal.SIGKILL)
        self.assertEqual(self.running_here(), [])

    def test_the_end_of_the_page_stops_its_step(self):
        # As a shell starts what is in the background: with SIGINT ignored.
        self.close(self.page)
        self.open(preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_IGN))
        self.program("list_devices", self.LONG)
        self.run_step("devices")
        self.wait_for("began")
        self.page.send_signal(signal.SIGINT)
        self.assertEqual(self.page.wait(20), 0)
        self.assertEqual(self.running_here(), [])
        self.open()
        self.assertEqual(self.output("devices")["code"], 130)

    def test_a_page_that_is_opened_again_knows_the_run(self):
        self.program("list_devices", "echo found; echo 'images: 3 of 12, 20 s left' >&2; touch began; while [ ! -e go ]; do sleep 0.1; done; echo end\n")
        self.run_step("devices")
        self.wait_for("began")
        time.sleep(0.2)
        running = self.state()["running"]
        self.assertEqual((running["progress"]["done"], running["progress"]["all"]), (3, 12))
        # The same command gives the address again, and starts no other server.
        again = subprocess.run([self.path("scripts/own_robot"), "mine", "page"], stdout=subprocess.PIPE, text=True)
        self.assertEqual((again.returncode, again.stdout), (0, f"page {self.address} (it runs already)\n"))
        self.write("go", "")
        self.assertEqual(self.output("devices")["lines"], ["found", "end"])
        # Nor does a new page forget it; its address is another one.
        self.close(self.page)
        before = self.token
        self.open()
        self.assertNotEqual(before, self.token)
        self.assertEqual(self.output("devices")["lines"], ["found", "end"])
        self.assertEqual(self.step("devices")["last"]["code"], 0)

    def running_here(self):
        found = []
        for pid in filter(str.isdigit, os.listdir("/proc")):
            try:
                with open(f"/proc/{pid}/cmdline", "rb") as file:
                    command = file.read().split(b"\0")
                if os.readlink(f"/proc/{pid}/cwd") == self.root and int(pid) != self.page.pid:
                    found.append(command)
            except OSError:
                continue
        return found


class Programs(unittest.TestCase):
    def test_ctrl_c_while_a_program_is_being_started_stops_it(self):
        for number, stopped in ((signal.SIGINT, KeyboardInterrupt), (signal.SIGTERM, SystemExit)):
            before = signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
            self.addCleanup(signal.signal, signal.SIGTERM, before)

            def interrupt():  # in the child, before its program: the parent waits within Popen
                os.write(writes, b"%d" % os.getpid())
                os.kill(os.getppid(), number)

            reads, writes = os.pipe()
            with self.assertRaises(stopped):
                run(["sleep", "60"], preexec_fn=interrupt)
            pid = int(os.read(reads, 20))
            list(map(os.close, (reads, writes)))
            with self.assertRaises(ProcessLookupError, msg="it runs on"):
                os.kill(pid, 0)


class Table(unittest.TestCase):
    def test_progress_is_read_from_the_lines_of_programs(self):
        self.assertEqual(progress_of("steps: 57 of 199, 4 min left"), {"text": "steps: 57 of 199, 4 min left", "done": 57, "all": 199})
        self.assertEqual(progress_of("% of the drive searched for places seen before: 7 of 100")["all"], 100)
        self.assertEqual((progress_of("recording: 10 of 90 s, 97 images, 87 MB")["all"], progress_of("recording: 10 s, 97 images, 87 MB")["all"]), (90, None))
        self.assertEqual(progress_of("[12/325, 9.5s] Building CXX object a.o")["done"], 12)
        for line in ("Drive: 90 s, 903 images of 640 x 480 in out/x", "Map of 23.0 m of way: 73 edges (1 blue_foot).", "image: accepted (15 corners), view 1.", "{}"):
            self.assertIsNone(progress_of(line), line)

    def test_defaults_are_those_of_the_programs(self):
        program = os.path.join(BIN, "calibrate")
        if not os.access(program, os.X_OK):
            self.skipTest(f"{program} is not built")
        for step in TABLE:
            if step.name not in ("target", "lens", "body"):
                continue
            said = subprocess.run([program, step.name, "--help"], stdout=subprocess.PIPE, text=True).stdout
            for argument in step.arguments:
                if not argument.to_program:
                    continue
                self.assertIn(f"  {argument.name} " if argument.kind != "flag" else f"  {argument.name}", said)
                if argument.default is not None and argument.kind in ("number", "choice"):
                    self.assertRegex(said, rf"  {argument.name} \S+( in \[[^]]*\])?={argument.default}\s")


if __name__ == "__main__":
    unittest.main()
