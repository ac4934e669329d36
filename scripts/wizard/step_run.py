"""A step of the wizard as a child process: its command from declared arguments, its lines as they come, its end."""
import contextlib
import json
import math
import os
import re
import signal
import subprocess
import threading
import time

from setup_files import Failure, read_text, reason_of
from steps import STEPS, is_number

RUNS_ALREADY = 409  # the code of a Failure: a step runs
MOST_LINES = 4000  # of one step; older ones are left out
LONGEST = 1024  # characters of a value
DOUBLE_CLICK_S = 2.0
COLOURS = re.compile(r"\x1b\[[0-9;]*[A-Za-z]")
# "images: 57 of 150, 20 s left" of ProgressLine, "recording: 57 s, 1710 images", and "[57/150, 9.5s] ..." of scripts/build.
PROGRESS = (re.compile(r"(?P<what>[a-z%][^:]*): (?P<done>\d+) of (?P<all>\d+)\b"), re.compile(r"(?P<what>recording): (?P<done>\d+) s, "),
            re.compile(r"\[(?P<done>\d+)/(?P<all>\d+), "))
SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGKILL)  # first as Ctrl-C does: what was started is ended, and kept


def progress_of(line):
    """What a line says of how far the work is, or None."""
    found = next(filter(None, (pattern.match(line) for pattern in PROGRESS)), None)
    if not found:
        return None
    numbers = {key: int(value) for key, value in found.groupdict().items() if key != "what" and value is not None}
    return {"text": line, "done": numbers["done"], "all": numbers.get("all")}


def checked_value(argument, value):
    """As a text. @throws Failure for another than the argument takes."""
    text = value if isinstance(value, str) else str(value) if isinstance(value, (int, float)) and not isinstance(value, bool) else None
    what = {"whole": "a whole number", "number": "a number of 0 or more", "choice": "one of " + ", ".join(map(str, argument.listed()))}
    what["key"] = f"a text of one line, without #, of at most {LONGEST} characters"
    fits = text is not None and len(text) <= LONGEST and text.isprintable() and text.strip() and {
        "whole": lambda: re.fullmatch(r"[0-9]{1,9}", text), "number": lambda: is_number(text),
        "choice": lambda: text in argument.listed(), "key": lambda: "#" not in text}.get(argument.kind, lambda: True)()
    if not fits:
        found = repr(value)
        found = found if len(found) <= 100 else f"{found[:100]}... of {len(found) - 2} characters"
        raise Failure(f"{argument.name}: found {found} (expected {what.get(argument.kind, f'a text of one line, of at most {LONGEST} characters')})", 2)
    return text


def arguments_of(step, robot, given):
    """The command line of declared arguments. A value is never an argument of its own: it stands behind its name, or is a number.
    @param given names to values. @throws Failure for names that the step does not declare for this robot."""
    declared = {argument.name: argument for argument in step.arguments if argument.when(robot)}
    unknown = sorted(set(given) - set(declared))
    if unknown:
        raise Failure(f"{step.name}: unknown argument {unknown[0]!r} (expected {', '.join(declared) or 'none'})", 2)
    words = []
    for name, argument in declared.items():
        value = given.get(name)
        if argument.kind == "flag":
            if value not in (None, True, False):
                raise Failure(f"{name}: found {value!r} (expected true or false)", 2)
            words += [name] if value else []
        elif value is not None:
            text = checked_value(argument, value)
            words.append(f"{name}={text}" if argument.is_named else text)
    return words


class StepRun:
    """*Thread-safe*: everything under `condition`, which is notified of each change."""

    def __init__(self, step, command, file, condition):
        self.step, self.command, self.file, self.condition = step, command, file, condition
        self.number = time.time_ns() // 1000000
        self.began, self.seconds, self.code = time.time(), None, None
        self.lines, self.left_out, self.progress = [], 0, None
        self.stops, self.stopped = 0, -math.inf
        # A session of its own: signals reach the step and its programs, not the page.
        self.process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                        errors="replace", start_new_session=True)
        self.reader = threading.Thread(target=self.read, daemon=True)
        threading.Thread(target=self.end_what_is_left, daemon=True).start()

    def end_what_is_left(self):
        """When the step has ended, a program of it may be left that was just being started. Components of a robot have sessions of their own."""
        with contextlib.suppress(ChildProcessError, ProcessLookupError):
            os.waitid(os.P_PID, self.process.pid, os.WEXITED | os.WNOWAIT)  # not reaped yet: its number is still that of its group
            os.killpg(self.process.pid, signal.SIGTERM)

    def read(self):
        for line in self.process.stdout:
            self.take(COLOURS.sub("", line).rstrip("\n").split("\r")[-1])
        code = self.process.wait()
        with self.condition:
            self.code, self.seconds, self.progress = code, time.time() - self.began, None
            try:
                self.save()
            except OSError as error:
                self.lines.append(f"warning: {reason_of(error)}: the next page will not know of this run")
            self.condition.notify_all()

    def take(self, line):
        with self.condition:
            progress = progress_of(line)
            if progress:
                self.progress = progress
            else:
                self.lines.append(line)
                if len(self.lines) > MOST_LINES:
                    del self.lines[0]
                    self.left_out += 1
            self.condition.notify_all()

    def stop(self):
        """As Ctrl-C does; again, but for a double click: more firmly."""
        with self.condition:
            if self.code is None and time.monotonic() - self.stopped > DOUBLE_CLICK_S:
                self.stopped = time.monotonic()
                with contextlib.suppress(ProcessLookupError):  # it has just ended
                    os.killpg(self.process.pid, SIGNALS[min(self.stops, len(SIGNALS) - 1)])
                self.stops += 1
                self.condition.notify_all()

    def end(self, wait_s=(30.0, 10.0, 5.0)):
        """Stops it and waits until it has ended."""
        for seconds in wait_s:
            if self.reader.is_alive():
                self.stop()
                self.reader.join(seconds)

    def as_object(self):
        return {"number": self.number, "step": self.step, "command": self.command, "began": self.began, "seconds": self.seconds, "code": self.code,
                "lines": list(self.lines), "left_out": self.left_out}

    def save(self):
        os.makedirs(os.path.dirname(self.file), exist_ok=True)
        with open(self.file, "w", encoding="utf-8") as file:
            json.dump(self.as_object(), file)


class StepRuns:
    """The runs of one robot: at most one at a time, and the last of each step, also of an earlier page."""

    def __init__(self, robot, program):
        self.robot, self.program = robot, program
        self.condition = threading.Condition()
        self.running, self.last = None, {}
        for step in STEPS:
            with contextlib.suppress(OSError, ValueError):
                self.last[step] = json.loads(read_text(self.file(step)))

    def file(self, step):
        return f"{self.robot.out}/page/{step}.json"

    def begin(self, step, given):
        """@throws Failure when another step runs or the arguments are wrong."""
        words = arguments_of(step, self.robot, given)
        with self.condition:
            if self.is_running():
                raise Failure(f"{self.running.step} runs: one step at a time", RUNS_ALREADY)
            run = StepRun(step.name, [self.program, self.robot.name, step.name, *words], self.file(step.name), self.condition)
            self.running = self.last[step.name] = run
            run.reader.start()
            self.condition.notify_all()
        return run

    def is_running(self):
        return self.running is not None and self.running.code is None

    def last_of(self, step):
        """The newest run of a step as a dictionary, or None."""
        with self.condition:
            run = self.last.get(step)
            return run.as_object() if isinstance(run, StepRun) else run

    def lines_after(self, number, at):
        """@return the newest run, its lines from `at` on (all, of another run than `number`), and the first one's place."""
        with self.condition:
            run = self.running
            if run is None:
                return None, [], 0
            begin = max(at if run.number == number else 0, run.left_out)
            return run, run.lines[begin - run.left_out:], begin

    def wait_for_more(self, number, at, seconds):
        with self.condition:
            if not self.lines_after(number, at)[1]:
                self.condition.wait(seconds)
