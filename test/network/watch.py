#!/usr/bin/python3
"""test/network/watch.py NAME=PORT...: the state of components on this machine's loopback every 50 ms, as lines of JSON:
{"t": monotonic seconds, NAME: {"state": ..., "reason": ..., "total": images or snapshots so far}, "stamp": of the newest estimate}.
"""
import json
import os
import sys
import time

import Ice

INTERFACES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../interfaces")
PERIOD_S = 0.05


def seen(status):
    totals = {rate.name: rate.total for rate in status.rates}
    return {"state": str(status.state), "reason": status.reason, "totals": totals,
            "gauges": {gauge.name: gauge.value for gauge in status.gauges},
            "errors": [error.text for error in status.errors]}


def main():
    for name in ("component", "localization"):
        Ice.loadSlice(f"--all -I{Ice.getSliceDir()} -I{INTERFACES} {INTERFACES}/avm/{name}.ice")
    import avm
    with Ice.initialize(["", "--Ice.Default.InvocationTimeout=500", "--Ice.RetryIntervals=-1"]) as communicator:
        asked = dict(word.split("=") for word in sys.argv[1:])
        proxies = {name: avm.ComponentPrx.uncheckedCast(communicator.stringToProxy(
            f"{name}/component:tcp -h 127.0.0.1 -p {port}")) for name, port in asked.items()}
        while True:
            begin = time.monotonic()
            line = {"t": begin}
            # All at once: a component that is late does not hide what the others say meanwhile.
            calls = {name: proxy.getStatusAsync() for name, proxy in proxies.items()}
            for name, call in calls.items():
                try:
                    line[name] = seen(call.result())
                except Ice.Exception as failure:
                    line[name] = {"state": "absent", "reason": type(failure).__name__, "totals": {}, "gauges": {},
                                  "errors": []}
            line["t"] = time.monotonic()
            print(json.dumps(line), flush=True)
            time.sleep(max(0.0, begin + PERIOD_S - time.monotonic()))


if __name__ == "__main__":
    main()
