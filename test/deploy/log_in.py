#!/usr/bin/python3
"""test/deploy/log_in.py operator|viewer USER PASSWORD DIR: logs in at a gateway of this machine with the authority DIR/ca.pem, reads
the speed of the base and commands it. Prints "read" and then "drove" or "refused".
"""
import os
import sys

import Ice

INTERFACES = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../interfaces")


def main():
    role, user, password, folder = sys.argv[1:]
    slices = Ice.getSliceDir()
    Ice.loadSlice(f"-I{slices} {slices}/Glacier2/Router.ice")
    Ice.loadSlice(f"--all -I{slices} -I{INTERFACES} {INTERFACES}/avm/base.ice")
    import Glacier2
    import avm
    viewer = role == "viewer"
    options = ["", "--Ice.Plugin.IceSSL=IceSSL:createIceSSL", f"--IceSSL.DefaultDir={folder}", "--IceSSL.CAs=ca.pem",
               "--IceSSL.CheckCertName=1", "--Ice.Default.InvocationTimeout=5000", "--Ice.RetryIntervals=-1"]
    with Ice.initialize(options) as communicator:
        name, port = ("Viewer", 4066) if viewer else ("Operator", 4064)
        router = Glacier2.RouterPrx.uncheckedCast(communicator.stringToProxy(f"{name}/router:ssl -h 127.0.0.1 -p {port}"))
        router.createSession(user, password)
        base = avm.BasePrx.uncheckedCast(communicator.stringToProxy(
            f"{'robot.view/' if viewer else ''}Motors:tcp -h 127.0.0.1 -p 9999").ice_router(router))
        base.getV()
        print("read")
        try:
            base.setVelocity(0.0, 0.0)
            print("drove")
        except Ice.OperationNotExistException:
            print("refused")


if __name__ == "__main__":
    main()
