#!/usr/bin/python3
"""watch_fleet.py [--slices DIR] [--manager TEXT] [--topic NAME] [--seconds S] [--json]: prints the reports of a site's robots.

A listener of IceStorm in Python, as an example: it subscribes with ordered delivery, subscribes again after a restart of
IceStorm, and withdraws at its end.

  robot   number   x [m]   y [m]   heading [deg]   reliability 0..1   components that do not run
"""
import argparse
import json
import math
import sys
import time

import Ice

RENEWAL_S = 2


def load_slices(folder):
    """Modules `avm` and `IceStorm`. Ice takes one text with the options of slice2py."""
    Ice.loadSlice(f"--all -I{Ice.getSliceDir()} -I{folder} {folder}/avm/fleet.ice")
    Ice.loadSlice(f"--all -I{Ice.getSliceDir()} {Ice.getSliceDir()}/IceStorm/IceStorm.ice")
    import avm
    import IceStorm
    return avm, IceStorm


def listener_of(avm, as_json):
    class Listener(avm.FleetListener):
        def report(self, report, current=None):
            pose = report.robotInWorld
            away = {part.name: part.reason for part in report.parts if part.state != avm.ComponentState.Running}
            if as_json:
                print(json.dumps({"robot": report.robot, "number": report.number, "away": away,
                                  "pose": [pose.x, pose.y, pose.theta] if report.hasPose else None}), flush=True)
                return
            place = (f"{pose.x:7.3f} {pose.y:7.3f} {math.degrees(pose.theta):8.2f} {report.reliability:5.2f}"
                     if report.hasPose else "      -       -        -     -")
            print(f"{report.robot:10} {report.number:8} {place}  {', '.join(f'{name}: {why}' for name, why in away.items())}",
                  flush=True)
    return Listener()


def subscribe(IceStorm, manager, name, listener):
    """Subscribes, if this listener is not subscribed."""
    try:
        try:
            topic = manager.retrieve(name)
        except IceStorm.NoSuchTopic:
            topic = manager.create(name)
        topic.subscribeAndGetPublisher({"reliability": "ordered"}, listener)
    except (IceStorm.AlreadySubscribed, IceStorm.TopicExists):
        pass
    except Ice.Exception as problem:
        print(f"no topic: {type(problem).__name__}", file=sys.stderr, flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--slices", default="/usr/share/vismem/slice", metavar="DIR")
    parser.add_argument("--manager", default="VismemStorm/TopicManager:tcp -h 127.0.0.1 -p 9980", metavar="TEXT")
    parser.add_argument("--topic", default="robots", metavar="NAME")
    parser.add_argument("--endpoints", default="tcp -h 127.0.0.1", metavar="TEXT", help="where IceStorm reaches this listener")
    parser.add_argument("--seconds", type=float, default=math.inf, metavar="S")
    parser.add_argument("--json", action="store_true", help="one JSON object a line")
    options = parser.parse_args()
    avm, IceStorm = load_slices(options.slices)
    end = time.monotonic() + options.seconds
    with Ice.initialize(["", "--Ice.Default.InvocationTimeout=3000"]) as communicator:
        manager = IceStorm.TopicManagerPrx.uncheckedCast(communicator.stringToProxy(options.manager))
        adapter = communicator.createObjectAdapterWithEndpoints("Listener", options.endpoints)
        listener = adapter.addWithUUID(listener_of(avm, options.json))
        adapter.activate()
        while time.monotonic() < end:
            subscribe(IceStorm, manager, options.topic, listener)
            time.sleep(min(RENEWAL_S, max(0.0, end - time.monotonic())))
        try:
            manager.retrieve(options.topic).unsubscribe(listener)
        except Ice.Exception:
            pass  # IceStorm is away, or has forgotten this listener


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        pass
