#!/usr/bin/python3
"""test/deploy/watch.py SLICES NAME=PORT...: the state of components and the newest pose, as lines of JSON on stdout.

Asks all components every 50 ms. A line is {"t": monotonic seconds, "up": {NAME: [state, uptime in seconds]}, "pose": n};
a component that does not answer within 300 ms has no entry in "up", and n counts the estimates with a pose that came.
"""
import json
import sys
import time

import Ice

PERIOD_S = 0.05


def asked(calls):
    """The answers of asynchronous calls, None for a failed one."""
    answers = []
    for call in calls:
        try:
            answers.append(call.result())
        except Ice.Exception:
            answers.append(None)
    return answers


def main():
    slices, components = sys.argv[1], dict(text.split("=") for text in sys.argv[2:])
    for name in ("component", "localization"):
        Ice.loadSlice(f"--all -I{Ice.getSliceDir()} -I{slices} {slices}/avm/{name}.ice")
    import avm
    options = ["", "--Ice.Default.InvocationTimeout=300", "--Ice.RetryIntervals=-1"]
    with Ice.initialize(options) as communicator:
        proxies = {name: avm.ComponentPrx.uncheckedCast(
            communicator.stringToProxy(f"{name}/component:tcp -h 127.0.0.1 -p {port}"))
            for name, port in components.items()}
        pose = avm.LocalizationPrx.uncheckedCast(
            communicator.stringToProxy(f"Localization:tcp -h 127.0.0.1 -p {components['localization']}"))
        poses, stamp = 0, None
        while True:
            begin = time.monotonic()
            calls = [proxy.getStatusAsync() for proxy in proxies.values()] + [pose.latestAsync()]
            *states, estimate = asked(calls)
            if estimate is not None and estimate.hasPose and estimate.stampUs != stamp:
                poses, stamp = poses + 1, estimate.stampUs
            up = {name: [str(state.state), state.uptimeS]
                  for name, state in zip(proxies, states) if state is not None}
            print(json.dumps({"t": time.monotonic(), "up": up, "pose": poses}), flush=True)
            time.sleep(max(0.0, begin + PERIOD_S - time.monotonic()))


if __name__ == "__main__":
    main()
