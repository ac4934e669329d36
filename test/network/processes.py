"""Components of the build, and programs beside them, as child processes."""
import os
import queue
import subprocess
import threading
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
PROGRAMS = os.environ.get("VISMEM_BIN", os.path.join(ROOT, "build/release/bin"))
PATIENCE_S = 30


class Process:
    """Context manager. Keeps what the child writes on both streams, line by line with the time."""

    def __init__(self, command, environment=None):
        self.command = command
        self.environment = {**os.environ, **(environment or {})}

    def __enter__(self):
        self.child = subprocess.Popen(self.command, cwd=ROOT, env=self.environment, text=True, errors="replace",
                                      stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
        self.lines = []
        self.new = queue.Queue()
        self.reader = threading.Thread(target=self._read)
        self.reader.start()
        return self

    def _read(self):
        for line in self.child.stdout:
            self.lines.append((time.monotonic(), line.rstrip("\n")))
            self.new.put(self.lines[-1])
        self.new.put(None)

    def __exit__(self, *_):
        self.child.terminate()
        try:
            self.child.wait(10)
        except subprocess.TimeoutExpired:
            self.child.kill()
            self.child.wait()
        self.reader.join()
        self.child.stdout.close()

    def text(self):
        return "\n".join(line for _, line in self.lines)

    def wait_for(self, text, limit_s=PATIENCE_S):
        """The first line with the text; raises after the time or when the child has ended without it."""
        end = time.monotonic() + limit_s
        while True:
            for _, line in list(self.lines):
                if text in line:
                    return line
            if self.child.poll() is not None and not self.reader.is_alive():
                raise AssertionError(f"{self.command}: ended with {self.child.returncode} without {text!r}:\n{self.text()}")
            if time.monotonic() > end:
                raise AssertionError(f"{self.command}: no {text!r} within {limit_s} s:\n{self.text()}")
            time.sleep(0.02)


def component(name, configuration, *options, prefix=(), environment=None):
    """A component as context manager; wait for "NAME ready"."""
    return Process([*prefix, os.path.join(PROGRAMS, name), f"--Ice.Config={configuration}", *options], environment)
