"""Network namespaces as machines, on one wire that can be cut. Needs root and iproute2."""
import os
import subprocess

NAMES = ("robot", "station", "people")
ADDRESSES = {"robot": "10.77.0.1", "station": "10.77.0.2", "people": "10.77.0.3"}


def ip(*words):
    subprocess.run(["ip", *words], check=True, stdin=subprocess.DEVNULL)


class Network:
    """Context manager: the machines robot, station and people, each with its address and its own loopback."""

    def __init__(self):
        self.prefix = f"avm{os.getpid()}"

    def space(self, name):
        return f"{self.prefix}-{name}"

    def __enter__(self):
        wire = self.space("wire")
        try:
            ip("netns", "add", wire)
            ip("-n", wire, "link", "add", "bridge0", "type", "bridge")
            ip("-n", wire, "link", "set", "bridge0", "up")
            for name in NAMES:
                space = self.space(name)
                ip("netns", "add", space)
                ip("-n", space, "link", "set", "lo", "up")
                ip("link", "add", "eth0", "netns", space, "type", "veth", "peer", "name", name, "netns", wire)
                ip("-n", space, "address", "add", f"{ADDRESSES[name]}/24", "dev", "eth0")
                ip("-n", space, "link", "set", "eth0", "up")
                ip("-n", wire, "link", "set", name, "master", "bridge0", "up")
        except BaseException:
            self.__exit__()
            raise
        return self

    def __exit__(self, *_):
        for name in (*NAMES, "wire"):
            subprocess.run(["ip", "netns", "delete", self.space(name)], stderr=subprocess.DEVNULL, check=False)

    def cut(self, name):
        """Packets of a machine vanish; its interface stays up, as behind a switch."""
        ip("-n", self.space("wire"), "link", "set", name, "nomaster")

    def join(self, name):
        ip("-n", self.space("wire"), "link", "set", name, "master", "bridge0")

    def command(self, name, *words):
        return ["ip", "netns", "exec", self.space(name), *words]

    def run(self, name, *words, **options):
        return subprocess.run(self.command(name, *words), text=True, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, **options)
