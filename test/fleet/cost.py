#!/usr/bin/python3
"""cost.py: processor time of a registry's lookups and registrations, and of IceStorm's deliveries, on this machine. Prints one
line each; the last line is JSON. For docs/deployment.md."""
import json
import os
import subprocess
import sys
import time

sys.dont_write_bytecode = True
sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from site_of_robots import DEPLOY, LOCATOR, ROOT, Site, cpu_s, enter_own_network  # noqa: E402

ADAPTERS, LOOKUPS = 2000, 20000
LISTENERS, RATE_HZ, SECONDS = (20, 100), 30, 10
MANAGER = "VismemStorm/TopicManager:tcp -h 127.0.0.1 -p 9980"


def per_call_us(process, count, call):
    """Processor time of the process and time that passed, for each of `count` calls."""
    before, begin = cpu_s(process.pid), time.monotonic()
    for i in range(count):
        call(i)
    return 1e6 * (cpu_s(process.pid) - before) / count, 1e6 * (time.monotonic() - begin) / count


def registry_costs(Ice):
    with Site() as site, Ice.initialize(["", f"--Ice.Default.Locator={LOCATOR}"]) as communicator:
        site.start_registry()
        master = site.processes["registry"]
        locator = communicator.getDefaultLocator()
        registry = locator.getRegistry()
        gateway = communicator.stringToProxy("dummy:tcp -h 10.1.2.3 -p 4064")
        registration = per_call_us(master, ADAPTERS, lambda i: registry.setAdapterDirectProxy(f"robot{i}.gateway", gateway))
        renewal = per_call_us(master, ADAPTERS, lambda i: registry.setAdapterDirectProxy(f"robot{i}.gateway", gateway))
        lookup = per_call_us(master, LOOKUPS, lambda i: locator.findAdapterById(f"robot{i % ADAPTERS}.gateway"))
        ping = per_call_us(master, LOOKUPS, lambda i: locator.ice_ping())
        return {"registration_us": registration, "renewal_us": renewal, "lookup_us": lookup, "ping_us": ping}


def listen(count):
    """Subscribes `count` listeners and counts their reports until the input ends."""
    import Ice
    Ice.loadSlice(f"--all -I{Ice.getSliceDir()} -I{ROOT}/interfaces {ROOT}/interfaces/avm/fleet.ice")
    Ice.loadSlice(f"--all -I{Ice.getSliceDir()} {Ice.getSliceDir()}/IceStorm/IceStorm.ice")
    import avm
    import IceStorm

    class Listener(avm.FleetListener):
        seen = 0

        def report(self, report, current=None):
            Listener.seen += 1

    with Ice.initialize([]) as communicator:
        topic = IceStorm.TopicManagerPrx.uncheckedCast(communicator.stringToProxy(MANAGER)).retrieve("robots")
        adapter = communicator.createObjectAdapterWithEndpoints("L", "tcp -h 127.0.0.1")
        adapter.activate()
        for i in range(count):
            # A connection each, as listeners on machines of their own have.
            topic.subscribeAndGetPublisher({"reliability": "ordered"}, adapter.addWithUUID(Listener()).ice_connectionId(str(i)))
        print("listening", flush=True)
        sys.stdin.read()
        time.sleep(0.5)
        print(Listener.seen, flush=True)


def storm_costs(Ice):
    Ice.loadSlice(f"--all -I{Ice.getSliceDir()} -I{ROOT}/interfaces {ROOT}/interfaces/avm/fleet.ice")
    Ice.loadSlice(f"--all -I{Ice.getSliceDir()} {Ice.getSliceDir()}/IceStorm/IceStorm.ice")
    import avm
    import IceStorm
    costs = {}
    report = avm.RobotReport()
    report.robot, report.hasPose = "robot1234", True
    report.parts = [avm.PartReport(name, avm.ComponentState.Running, "") for name in
                    ("active_visual_memory", "base_server", "camera_server", "localization", "pantilt_server")]
    with Site() as site, Ice.initialize([]) as communicator:
        icebox = site.start("icebox", "icebox", f"--Ice.Config={DEPLOY}/icestorm/icebox.cfg")
        manager = IceStorm.TopicManagerPrx.uncheckedCast(communicator.stringToProxy(MANAGER))
        for _ in range(100):
            try:
                topic = manager.create("robots")
                break
            except Ice.Exception:
                time.sleep(0.1)
        publisher = avm.FleetListenerPrx.uncheckedCast(topic.getPublisher())
        for count in LISTENERS:
            process = subprocess.Popen([sys.executable, os.path.abspath(__file__), "listen", str(count)],
                                       stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
            process.stdout.readline()
            before, begin = cpu_s(icebox.pid), time.monotonic()
            for i in range(RATE_HZ * SECONDS):
                publisher.report(report)
                time.sleep(max(0.0, begin + (i + 1) / RATE_HZ - time.monotonic()))
            process.stdin.close()
            delivered = int(process.stdout.readline())
            process.wait()
            process.stdout.close()
            costs[count] = {"delivered_share": delivered / (count * RATE_HZ * SECONDS),
                            "delivery_us": 1e6 * (cpu_s(icebox.pid) - before) / delivered}
    return costs


def main():
    import Ice
    with open("/proc/loadavg") as file:
        load = float(file.read().split()[0])
    registry, storm = registry_costs(Ice), storm_costs(Ice)
    for name, (cpu, passed) in registry.items():
        print(f"{name[:-3]}: {cpu:.0f} us of the registry's processor time, {passed:.0f} us until the answer")
    for count, cost in storm.items():
        print(f"{count} listeners at {RATE_HZ} Hz: {cost['delivery_us']:.0f} us of icebox's processor time a delivery, "
              f"{100 * cost['delivered_share']:.1f} % delivered")
    print(json.dumps({"load": load, "registry": {name: round(cpu, 1) for name, (cpu, _) in registry.items()},
                      "storm": {str(count): round(cost["delivery_us"], 1) for count, cost in storm.items()}}))


if __name__ == "__main__":
    if sys.argv[1:2] == ["listen"]:
        listen(int(sys.argv[2]))
    elif not enter_own_network():
        sys.exit("cost.py: the kernel allows no network of its own")
    else:
        main()
