"""A site in a network of its own: the registry pair and a node of deploy/icegrid, as the files stand."""
import ctypes
import fcntl
import os
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import time

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))
DEPLOY = os.path.join(ROOT, "deploy")
LOCATOR = "Vismem/Locator:tcp -h 127.0.0.1 -p 4061:tcp -h 127.0.0.1 -p 4062"
CLONE_NEWUSER, CLONE_NEWNET = 0x10000000, 0x40000000
SIOCGIFFLAGS, SIOCSIFFLAGS, IFF_UP = 0x8913, 0x8914, 1
UP_S = 20


def enter_own_network():
    """Moves this process, and what it starts, into a network that has nothing but 127.0.0.1: ports are free, and nobody
    reaches them. @return whether the kernel allows it."""
    libc = ctypes.CDLL(None, use_errno=True)
    if libc.unshare(CLONE_NEWNET) != 0 and libc.unshare(CLONE_NEWUSER | CLONE_NEWNET) != 0:
        return False
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        request = struct.pack("16sh", b"lo", 0)
        flags = struct.unpack("16sh", fcntl.ioctl(sock, SIOCGIFFLAGS, request))[1]
        fcntl.ioctl(sock, SIOCSIFFLAGS, struct.pack("16sh", b"lo", flags | IFF_UP))
    return True


def wait_for(condition, limit_s, what):
    end = time.monotonic() + limit_s
    while True:
        found = condition()
        if found:
            return found
        if time.monotonic() > end:
            raise AssertionError(f"not within {limit_s} s: {what}")
        time.sleep(0.1)


def children_of(pid):
    """Process ids of the running children of a process."""
    children = []
    for name in os.listdir("/proc"):
        if not name.isdigit():
            continue
        try:
            with open(f"/proc/{name}/stat") as file:
                fields = file.read().rsplit(")", 1)[1].split()
        except OSError:
            continue
        if int(fields[1]) == pid and fields[0] != "Z":
            children.append(int(name))
    return children


def cpu_s(pid):
    """Processor time of a process so far."""
    with open(f"/proc/{pid}/stat") as file:
        fields = file.read().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


class Site:
    """Context manager; a process that is asked to end leaves it, too."""

    def __init__(self):
        self.folder = tempfile.TemporaryDirectory(prefix="vismem_site_")
        # A node that is root runs its servers as nobody.
        os.chmod(self.folder.name, 0o755)
        for name in ("registry", "replica", "node"):
            os.mkdir(os.path.join(self.folder.name, name))
        hashed = subprocess.run(["openssl", "passwd", "-6", "secret"], check=True, capture_output=True, text=True).stdout
        with open(os.path.join(self.folder.name, "passwords"), "w") as file:
            file.write("admin " + hashed)
        self.processes = {}
        signal.signal(signal.SIGTERM, lambda *_: sys.exit(1))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        for process in reversed(list(self.processes.values())):
            process.terminate()
        for process in self.processes.values():
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
        self.folder.cleanup()

    def start(self, name, *command):
        """Starts a program in the site's folder; its output is in NAME.log there."""
        with open(os.path.join(self.folder.name, name + ".log"), "ab") as log:
            self.processes[name] = subprocess.Popen(command, cwd=self.folder.name, stdout=log, stderr=subprocess.STDOUT)
        return self.processes[name]

    def log(self, name):
        with open(os.path.join(self.folder.name, name + ".log"), errors="replace") as file:
            return file.read()

    def start_registry(self):
        self.start("registry", "icegridregistry", f"--Ice.Config={DEPLOY}/icegrid/registry.cfg")
        wait_for(lambda: self.admin("registry list").returncode == 0, UP_S, "the registry answers\n" + self.log("registry"))

    def start_replica(self):
        self.start("replica", "icegridregistry", f"--Ice.Config={DEPLOY}/icegrid/replica.cfg")
        wait_for(lambda: "Replica1" in self.admin("registry list").stdout, UP_S, "the replica is there")

    def start_node(self):
        node = self.start("node", "icegridnode", f"--Ice.Config={DEPLOY}/icegrid/node.cfg")
        wait_for(lambda: "farm1" in self.admin("node list").stdout, UP_S, "the node is there\n" + self.log("node"))
        return node

    def admin(self, command, check=False):
        return subprocess.run(["icegridadmin", f"--Ice.Default.Locator={LOCATOR}", "-u", "admin", "-p", "secret", "-e",
                               command], check=check, capture_output=True, text=True, timeout=60)

    def kill(self, name):
        process = self.processes.pop(name)
        os.kill(process.pid, signal.SIGKILL)
        process.wait()
