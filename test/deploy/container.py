"""A container with systemd as its process 1: the image below an overlay, so that every run begins with the same files."""
import ctypes
import os
import shutil
import subprocess
import tempfile
import threading
import time

BOOT_S = 60


class Container:
    """Context manager. Needs root. `root` is the container's file system, as it is seen from outside."""

    def __init__(self, image, packages):
        self.image, self.packages = image, packages
        self.folder = tempfile.mkdtemp(prefix="vismem_deploy_")
        self.root = os.path.join(self.folder, "root")
        self.nspawn = None
        self.leader = None

    def __enter__(self):
        for name in ("root", "upper", "work"):
            os.mkdir(os.path.join(self.folder, name))
        layers = f"lowerdir={self.image},upperdir={self.folder}/upper,workdir={self.folder}/work"
        subprocess.run(["mount", "-t", "overlay", "overlay", "-o", layers, self.root], check=True)
        self.log = open(os.path.join(self.folder, "console"), "wb")
        self.nspawn = subprocess.Popen(
            ["systemd-nspawn", "--quiet", "--register=no", "--keep-unit", "--private-network", "--console=pipe",
             f"--bind-ro={self.packages}:/packages", f"--machine=vismem{os.getpid()}", "-D", self.root, "--boot"],
            stdin=subprocess.DEVNULL, stdout=self.log, stderr=subprocess.STDOUT, start_new_session=True)
        try:
            self._wait_for_boot()
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        if self.leader is not None:
            self.run("systemctl", "poweroff", "--force", check=False)
        try:
            self.nspawn.wait(20)
        except subprocess.TimeoutExpired:
            self.nspawn.kill()
            self.nspawn.wait()
        self.log.close()
        subprocess.run(["umount", "--lazy", self.root], check=True)
        shutil.rmtree(self.folder, ignore_errors=True)

    def _children(self, process):
        try:
            with open(f"/proc/{process}/task/{process}/children") as file:
                return [int(word) for word in file.read().split()]
        except OSError:
            return []

    def _wait_for_boot(self):
        end = time.monotonic() + BOOT_S
        while time.monotonic() < end and self.nspawn.poll() is None:
            children = self._children(self.nspawn.pid)
            if children:
                self.leader = children[0]
                state = self.run("systemctl", "is-system-running", check=False).stdout.strip()
                if state in ("running", "degraded"):
                    return
            time.sleep(0.1)
        with open(os.path.join(self.folder, "console"), errors="replace") as file:
            raise RuntimeError("the container did not boot: " + file.read()[-2000:])

    def command(self, *words, only_network=False):
        """The command line that runs a command in the container; only_network: this machine's programs there."""
        return ["nsenter", "-t", str(self.leader), "-n" if only_network else "-a", "--", *words]

    def run(self, *words, check=True, only_network=False, timeout=90):
        done = subprocess.run(self.command(*words, only_network=only_network), text=True, timeout=timeout,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                              env={"PATH": "/usr/sbin:/usr/bin:/sbin:/bin", "LC_ALL": "C.UTF-8",
                                   "DEBIAN_FRONTEND": "noninteractive", "SYSTEMD_PAGER": ""})
        if check and done.returncode != 0:
            raise RuntimeError(f"{' '.join(words)}: exit {done.returncode}\n{done.stdout}")
        return done

    def systemctl(self, *words, **options):
        return self.run("systemctl", *words, **options).stdout.strip()

    def property(self, unit, name):
        return self.systemctl("show", f"--property={name}", "--value", unit)

    def process_of(self, unit):
        """The unit's main process as this machine numbers it; None if it has none."""
        inside = self.property(unit, "MainPID")
        if inside in ("", "0"):
            return None
        for entry in os.listdir("/proc"):
            if not entry.isdigit():
                continue
            try:
                if os.readlink(f"/proc/{entry}/ns/pid") != os.readlink(f"/proc/{self.leader}/ns/pid"):
                    continue
                with open(f"/proc/{entry}/status") as file:
                    numbers = next(line for line in file if line.startswith("NSpid:")).split()
            except (OSError, StopIteration):
                continue
            if numbers[-1] == inside:
                return int(entry)
        return None


class FrozenThread:
    """Stops one thread of a process, as a deadlock would, until the process dies or the object is released."""

    SEIZE, INTERRUPT, DETACH = 0x4206, 0x4207, 17
    WALL = 0x40000000

    def __init__(self, thread):
        self.thread = thread
        self.libc = ctypes.CDLL(None, use_errno=True)
        self.libc.ptrace.argtypes = [ctypes.c_long, ctypes.c_long, ctypes.c_void_p, ctypes.c_void_p]
        for request in (self.SEIZE, self.INTERRUPT):
            if self.libc.ptrace(request, thread, None, None) != 0:
                raise OSError(ctypes.get_errno(), "ptrace")
        os.waitpid(thread, self.WALL)
        # The kernel keeps a process until its traced threads are reaped.
        threading.Thread(target=self._reap, daemon=True).start()

    def _reap(self):
        try:
            while os.WIFSTOPPED(os.waitpid(self.thread, self.WALL)[1]):
                pass
        except ChildProcessError:
            pass

    def release(self):
        self.libc.ptrace(self.DETACH, self.thread, None, None)


def busiest_thread(process, over_s=1.0):
    """Of all threads but the main one, that which takes the most processor time now: a process that has just begun owes most
    of its time to its start."""
    def ticks():
        taken = {}
        for name in os.listdir(f"/proc/{process}/task"):
            with open(f"/proc/{process}/task/{name}/stat") as file:
                fields = file.read().rsplit(")", 1)[1].split()
            taken[int(name)] = int(fields[11]) + int(fields[12])
        return taken
    before = ticks()
    time.sleep(over_s)
    after = ticks()
    return max((thread for thread in before.keys() & after.keys() if thread != process),
               key=lambda thread: after[thread] - before[thread])
