#!/usr/bin/python3
"""show_pose.py [--slices DIR] [--proxy TEXT] [--seconds S]: prints the pose of the robot, one line an estimate.

A client of the localization in Python, as an example: it makes its stubs from the Slice files when it starts, waits for
each new estimate (Localization::next answers within a second), and goes on after a restart of the server.

  stamp [s]   x [m]   y [m]   heading [deg]   reliability 0..1
"""
import argparse
import math
import os
import sys
import time

import Ice

# Of the sources, else of the package vismem-dev.
SLICES = [os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "interfaces"), "/usr/share/vismem/slice"]


def load_slices(folder):
    """Module `avm`. Ice takes one text with the options of slice2py."""
    Ice.loadSlice(f"--all -I{Ice.getSliceDir()} -I{folder} {folder}/avm/localization.ice")
    import avm
    return avm


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--slices", default=next((s for s in SLICES if os.path.isdir(s)), SLICES[-1]), metavar="DIR")
    parser.add_argument("--proxy", default="Localization:tcp -h 127.0.0.1 -p 9971", metavar="TEXT")
    parser.add_argument("--seconds", type=float, default=math.inf, metavar="S")
    options = parser.parse_args()
    avm = load_slices(options.slices)
    end = time.monotonic() + options.seconds
    # No call waits for a frozen server longer than this.
    with Ice.initialize(["", "--Ice.Default.InvocationTimeout=3000"]) as communicator:
        localization = avm.LocalizationPrx.uncheckedCast(communicator.stringToProxy(options.proxy))
        revision = 0
        while time.monotonic() < end:
            try:
                result = localization.next(revision)
            except Ice.Exception as problem:
                print(f"no localization: {type(problem).__name__}", file=sys.stderr, flush=True)
                revision = 0
                time.sleep(0.2)
                continue
            estimate = result.estimate
            if result.state != avm.SourceState.Running or estimate.revision == revision:
                continue
            revision = estimate.revision
            if estimate.hasPose:
                pose = estimate.robotInWorld
                print(f"{estimate.stampUs / 1e6:9.2f} {pose.x:7.3f} {pose.y:7.3f} "
                      f"{math.degrees(pose.theta):8.2f} {estimate.reliability:5.2f}", flush=True)


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        pass
