"""The wizard as a page in the browser: a server on 127.0.0.1 that runs the steps as the command line does."""
import glob
import hmac
import http.server
import json
import mimetypes
import os
import re
import secrets
import signal
import threading
import time
import urllib.parse

from programs import running_components
from robot import missing_before, next_command, next_step, states_of
from setup_files import Failure, locked, read_text, reason_of, say, value_of, write_locked
from step_run import RUNS_ALREADY, StepRuns
from steps import STEPS, TABLE

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
PROGRAM = os.path.join(ROOT, "scripts", "own_robot")
PORT = 8790
MOST_BYTES = 1 << 20  # of a request
STREAM_S = 1.0  # files are looked at this often
MOST_STREAMS = 4  # a browser has 6 connections to a server: STOP needs one
FILES = {"": "page/index.html", "page.js": "page/page.js", "form.js": "page/form.js", "results.js": "page/results.js", "wizard.css": "page/wizard.css"}
LOOKS = os.path.join(ROOT, "components", "gui", "src", "style", "page.css")  # of the page that shows the robot
ICON = os.path.join(ROOT, "components", "gui", "public", "favicon.svg")
OWN_POLICY = ("default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self'; connect-src 'self'; base-uri 'none'; form-action 'none'; "
              "frame-ancestors 'none'")
# Files that a step made: a page of clicks has its script within; it reaches nothing of this server.
RESULT_POLICY = "sandbox allow-scripts allow-downloads; default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:"
TYPES = {".palette": "text/plain", ".csv": "text/plain", ".yaml": "text/plain", ".dxf": "text/plain", ".json": "application/json"}


class Refused(Exception):
    def __init__(self, status, text):
        super().__init__(text)
        self.status = status


def content_type(path):
    kind = TYPES.get(os.path.splitext(path)[1]) or mimetypes.guess_type(path)[0] or "application/octet-stream"
    return kind + "; charset=utf-8" if kind.startswith("text/") else kind


class Wizard:
    """What the page shows and may do. *Thread-safe.*"""

    def __init__(self, robot, port_offset):
        self.robot, self.port_offset = robot, port_offset
        self.runs = StepRuns(robot, PROGRAM)
        self.closing = threading.Event()
        self.streams = []  # one of each page that is open, the newest last

    def argument(self, argument):
        default = self.port_offset if argument.name == "--port-offset" else argument.default
        if isinstance(default, str):  # a proxy
            default = re.sub(r"(?<= -p )[0-9]+", lambda port: str(int(port[0]) + self.port_offset), default)
        is_default = default == argument.default
        if argument.kind == "key":
            file = self.robot.file_of(argument.name[2:])
            default, is_default = file and value_of(file, argument.name[2:]), True
        found = sorted({path for pattern in argument.found for path in glob.glob(pattern)})
        return {"name": argument.name, "label": argument.label, "kind": argument.kind, "about": argument.about, "default": default,
                "is_default": is_default, "choices": argument.listed(), "goes_with": argument.goes_with, "minor": argument.minor,
                "found": found[-50:]}

    def results(self, step):
        """Files of a step that exist: number, name, caption and age."""
        found = []
        for number, (path, caption) in enumerate(step.results.items()):
            place = self.robot.place(path)
            if os.path.isfile(place):
                found.append({"number": number, "name": os.path.basename(place), "path": place, "caption": caption,
                              "at": os.stat(place).st_mtime_ns // 1000000})
        return found

    def step(self, step, states):
        state, how = states.get(step.name, ("any", self.robot.how(step)))
        arguments = [argument for argument in step.arguments if argument.when(self.robot)]
        names = {argument.name for argument in arguments}
        if step.name == "robot":
            running = sorted(running_components(self.robot.state_name(self.port_offset)))
            state, how = ("on", ", ".join(running)) if running else ("any", "nothing")
        last = self.runs.last_of(step.name)
        return {"name": step.name, "title": step.title, "state": state, "does": step.does.replace("cfg/NAME", self.robot.setup),
                "needs": "" if self.robot.simulated else step.needs, "how": how, "notes": "" if self.robot.simulated else step.notes,
                "after": step.after, "missing": missing_before(self.robot, step), "unless": step.unless,
                "otherwise": {name: text for name, text in step.otherwise.items() if not name or name in names},
                "arguments": [self.argument(argument) for argument in arguments], "results": self.results(step),
                "ctrl_c": step.ctrl_c, "apply": step.apply, "is_once": step.is_once,
                "leads_to": "" if self.robot.simulated else step.leads_to,
                "wants_robot": () if self.robot.simulated else step.wants_robot,
                "last": last and {key: last[key] for key in ("number", "command", "began", "seconds", "code")}}

    def state(self):
        states = {name: (state, how) for name, state, how in states_of(self.robot)}
        run, robot = self.runs.running, self.robot
        running = self.runs.is_running() and {"step": run.step, "number": run.number, "began": run.began, "progress": run.progress, "stops": run.stops}
        kind = ("none" if not os.path.exists(robot.setup) else "uncalibrated" if robot.uncalibrated else
                "simulated" if robot.simulated else "own")
        return {"name": robot.name, "kind": kind, "next": next_step(robot), "next_command": next_command(robot), "running": running or None,
                "steps": [self.step(step, states) for step in TABLE if step.name != "page"]}

    def begin(self, order):
        name = order.get("step")
        step = STEPS.get(name) if isinstance(name, str) else None
        if step is None or step.name == "page":
            raise Refused(400, f"unknown step {name!r}")
        if not isinstance(order.get("arguments", {}), dict):
            raise Refused(400, "arguments (expected an object of names and values)")
        try:
            return {"number": self.runs.begin(step, order.get("arguments", {})).number}
        except Failure as failure:
            raise Refused(409 if failure.code == RUNS_ALREADY else 400, str(failure)) from failure

    def keep(self, order):
        """A small file that the browser sends, for an argument. @return its path."""
        name, text = order.get("name"), order.get("text")
        if not isinstance(name, str) or not re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_. -]{0,99}", name) or not isinstance(text, str):
            raise Refused(400, f"file {name!r} (expected a name of letters, digits, blanks and . _ -, and its text)")
        path = f"{self.robot.out}/page/files/{name}"
        os.makedirs(os.path.dirname(path), exist_ok=True)
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        return {"path": path}


class Handler(http.server.BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"
    timeout = 60

    def log_message(self, *_):
        pass

    def do_GET(self):
        self.answer(self.get)

    def do_POST(self):
        body = self.body()
        self.answer(lambda path: self.act(path, body))

    def body(self):
        """What was sent, or None when it is too long; all is read, or the answer would be lost with the connection."""
        length = self.headers.get("Content-Length", "")
        left = int(length) if re.fullmatch(r"[0-9]{1,9}", length) else 0
        # Of an unknown length: what follows must not be read as another request.
        self.close_connection |= length != str(left) or "Transfer-Encoding" in self.headers
        read = b""
        while left > 0 and (part := self.rfile.read(min(left, 1 << 16))):
            left -= len(part)
            read += part if len(read) <= MOST_BYTES else b""
        return read if len(read) <= MOST_BYTES else None

    def answer(self, do):
        try:
            do(self.checked_path())
        except Refused as refused:
            self.send(refused.status, "application/json", json.dumps({"error": str(refused)}).encode())
        except (BrokenPipeError, ConnectionResetError, TimeoutError):
            self.close_connection = True
        except OSError as error:  # of the disk
            self.send(500, "application/json", json.dumps({"error": reason_of(error)}).encode())

    def checked_path(self):
        """The path behind the token. Another name of this machine, or none, may be that of a foreign page which was bound to 127.0.0.1."""
        hosts = [f"{name}:{self.server.server_port}" for name in ("127.0.0.1", "localhost")]
        if self.headers.get_all("Host") not in [[host] for host in hosts]:
            raise Refused(403, f"host {self.headers.get('Host')!r} (expected {hosts[0]})")
        origin = self.headers.get("Origin")
        if origin is not None and origin != f"http://{self.headers['Host']}":
            raise Refused(403, f"origin {origin!r}: only this server's own page may ask")
        parts = urllib.parse.urlsplit(self.path).path.split("/", 2)
        if len(parts) != 3 or not hmac.compare_digest(parts[1].encode(), self.server.token.encode()):
            raise Refused(403, f"open the address that scripts/own_robot {self.server.wizard.robot.name} page has printed: it holds a secret of this start")
        return urllib.parse.unquote(parts[2])

    def send(self, status, kind, body, policy=OWN_POLICY):
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(body)))
        if policy:
            self.send_header("Content-Security-Policy", policy)
        self.send_common()
        self.wfile.write(body)

    def send_common(self):
        for name, value in (("Cache-Control", "no-store"), ("X-Content-Type-Options", "nosniff"), ("Referrer-Policy", "no-referrer"),
                            ("Cross-Origin-Resource-Policy", "same-origin")):
            self.send_header(name, value)
        self.end_headers()

    def send_file(self, path, policy=OWN_POLICY):
        try:
            with open(path, "rb") as file:
                self.send(200, content_type(path), file.read(), policy)
        except OSError:
            raise Refused(404, f"{os.path.basename(path)}: no such file") from None

    def get(self, path):
        what, _, rest = path.partition("/")
        if path in FILES:
            self.send_file(os.path.join(HERE, FILES[path]))
        elif path == "page.css":
            self.send_file(LOOKS)
        elif path == "favicon.svg":
            self.send_file(ICON)
        elif path == "events":
            self.stream()
        elif what == "output" and rest in STEPS:
            self.send(200, "application/json", json.dumps(self.server.wizard.runs.last_of(rest)).encode())
        elif what == "result":
            self.send_result(*rest.split("/"))
        else:
            raise Refused(404, f"{path}: no such page")

    def send_result(self, *parts):
        """STEP/NUMBER/NAME: only files that the step's table names."""
        wizard = self.server.wizard
        found = [one for one in wizard.results(STEPS[parts[0]]) if [str(one["number"]), one["name"]] == list(parts[1:])] if parts[0] in STEPS else []
        if not found:
            raise Refused(404, f"{'/'.join(parts)}: no such file of a step")
        # Chromium shows no PDF in a sandbox.
        self.send_file(found[0]["path"], None if found[0]["name"].endswith(".pdf") else RESULT_POLICY)

    def stream(self):
        """Server-sent events: the state when it changes, or why it is not known, and the lines of the step that runs."""
        self.send_response(200)
        self.send_header("Content-Type", "text/event-stream")
        self.send_header("Connection", "close")
        self.close_connection = True
        self.send_common()
        streams, me = self.server.wizard.streams, object()
        streams.append(me)
        try:
            self.send_events(lambda: me in streams[-MOST_STREAMS:])
        finally:
            streams.remove(me)

    def send_events(self, is_wanted):
        wizard, sent, number, at = self.server.wizard, None, None, 0
        while not wizard.closing.is_set():
            if not is_wanted():
                self.event("elsewhere", {})
                return
            try:
                name, state = "state", wizard.state()
            except (OSError, Failure) as error:
                name, state = "trouble", {"text": reason_of(error) if isinstance(error, OSError) else str(error)}
            run, lines, begin = wizard.runs.lines_after(number, at)  # after the state: with its end all lines are there
            if lines:
                self.event("lines", {"number": run.number, "step": run.step, "from": begin, "lines": lines})
                number, at = run.number, begin + len(lines)
            if state != sent:
                self.event(name, {"now": time.time(), **state})
                sent = state
            elif not lines:
                self.wfile.write(b": still here\n\n")
            wizard.runs.wait_for_more(number, at, STREAM_S)
            time.sleep(0.05)  # lines come in bursts

    def event(self, name, value):
        self.wfile.write(f"event: {name}\ndata: {json.dumps(value)}\n\n".encode())
        self.wfile.flush()

    def act(self, path, body):
        if self.headers.get("Origin") is None or self.headers.get("Content-Type") != "application/json":
            raise Refused(403, "only this server's own page may ask")
        if body is None:
            raise Refused(413, f"too long (at most {MOST_BYTES} bytes)")
        try:
            order = json.loads(body)
        except ValueError:
            order = None
        if not isinstance(order, dict):
            raise Refused(400, "expected a JSON object")
        wizard = self.server.wizard
        actions = {"run": wizard.begin, "file": wizard.keep, "stop": lambda _: self.stop()}
        if path not in actions:
            raise Refused(404, f"{path}: no such action")
        self.send(200, "application/json", json.dumps(actions[path](order)).encode())

    def stop(self):
        runs = self.server.wizard.runs
        if not runs.is_running():
            raise Refused(409, "nothing runs")
        runs.running.stop()
        return {}


class Server(http.server.ThreadingHTTPServer):
    daemon_threads = True

    def __init__(self, port, wizard):
        self.wizard, self.token = wizard, secrets.token_urlsafe(18)
        super().__init__(("127.0.0.1", port), Handler)

    def handle_error(self, request, client_address):
        pass  # a browser that goes away


def bound(port, wizard):
    try:
        return Server(PORT if port is None else port, wizard)
    except OSError as error:
        if port is not None:
            raise Failure(f"--port {port}: {error.strerror}") from None
        return Server(0, wizard)


def serve(robot, port, port_offset):
    """Until Ctrl-C or SIGTERM; a step that runs is then stopped."""
    path = f"{robot.out}/page/address"
    lock = locked(path)
    if lock is None:
        say(f"page {read_text(path).strip()} (it runs already)")
        return 0
    wizard = Wizard(robot, port_offset)
    with lock, bound(port, wizard) as server:
        address = f"http://127.0.0.1:{server.server_port}/{server.token}/"
        write_locked(lock, address)
        thread = threading.Thread(target=server.serve_forever, daemon=True)
        thread.start()
        say(f"page {address}\nOnly this machine reaches it, and only with this address. Ctrl-C ends it, and a step that runs.")
        # Not as it was inherited: a step of a page in the background must not ignore Ctrl-C.
        end, begin = os.pipe()
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            signal.signal(number, lambda *_: os.write(begin, b"."))
        os.read(end, 1)
        wizard.closing.set()
        server.shutdown()
        if wizard.runs.is_running():
            wizard.runs.running.end()
    return 0
