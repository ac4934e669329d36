"""Programs of the build, and what scripts/start runs."""
import contextlib
import json
import os
import signal
import subprocess
import sys

from setup_files import Failure, read_text

BIN = "build/release/bin"


@contextlib.contextmanager
def signals_wait():
    """Ctrl-C and SIGTERM, unless they are ignored, count when the block has ended: a child that is being started is known by then."""
    came = []
    before = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM) if callable(signal.getsignal(number))}
    for number in before:
        signal.signal(number, lambda number, _: came.append(number))
    try:
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        for number in came[:1]:
            signal.raise_signal(number)


def run(command, **options):
    """@return exit code and output. A program is stopped along with this one and may end: it stops a robot, and keeps what it has."""
    child = None
    with contextlib.ExitStack() as ends:
        try:
            with signals_wait():
                child = ends.enter_context(subprocess.Popen(command, **options))
            output, _ = child.communicate()
        except BaseException:
            if child:
                child.terminate()
                child.wait()
            raise
        return child.returncode, output


def program(name, arguments, read=False):
    """Runs a program of the build, which is made if it is not there.
    @return exit code and, with `read`, the object in the last line of its output."""
    path = os.path.join(BIN, name)
    if not os.access(path, os.X_OK):
        if subprocess.run(["scripts/build", "release", name], stdout=sys.stderr).returncode != 0:
            raise Failure(f"the program {name} is missing and could not be built")
    command = [path, *map(str, arguments)]
    if not read:
        return run(command)[0], {}
    code, output = run(command, stdout=subprocess.PIPE, text=True)
    try:
        return code, json.loads(output.strip().splitlines()[-1])
    except (IndexError, ValueError):
        return code, {}


def running_components(state):
    """Names of what scripts/start runs under out/STATE."""
    names = set()
    with contextlib.suppress(OSError):
        for line in read_text(f"out/{state}/pids").splitlines():
            pid, name = line.split()
            with contextlib.suppress(OSError):
                if read_text(f"/proc/{pid}/comm").strip() == name[:15]:
                    names.add(name)
    return names
