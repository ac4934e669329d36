#!/usr/bin/python3
"""test/network/ask.py PROXY [OPTION...]: calls an object over Ice once; prints "accepted" or the exception's name. Exit code 0, or 1."""
import sys

import Ice

options = ["--Ice.RetryIntervals=-1", "--Ice.Override.ConnectTimeout=3000", "--Ice.Default.InvocationTimeout=5000"]
try:
    with Ice.initialize(["", *options, *sys.argv[2:]]) as communicator:
        communicator.stringToProxy(sys.argv[1]).ice_ping()
except Ice.Exception as failure:
    print(type(failure).__name__, str(getattr(failure, "reason", ""))[:100].replace("\n", " "))
    sys.exit(1)
print("accepted")
