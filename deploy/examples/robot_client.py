#!/usr/bin/python3
"""robot_client.py [--robot NAME] [--port-offset N] [--proxy TEXT] [--slices DIR] COMMAND ...: a client of a running robot, to use
and to copy from.

  pose [--seconds S]           the pose, one line an estimate: stamp [s], x [m], y [m], heading [deg], reliability 0..1
  memory                       the remembered segments: id, label, ends in odom [m], confirmed or not
  image FILE [--camera NAME]   the newest image as JPEG
  look X Y                     asks the gaze for a place of the floor, in odom [m], for 5 s
  drive V W SECONDS            drives with V m/s and W rad/s under a lease, then stops
  set-pose X Y DEGREES         says where the robot is, in world
  parameters COMPONENT         what may change at run time, with values and ranges
  set COMPONENT NAME VALUE     changes one of them until the component ends
  status COMPONENT             state, reason, peers, rates

--port-offset is that of scripts/start. --proxy names the object of the command whole, as for another machine, a gateway or
WebSocket: robot.TOKEN/Localization:ws -h 10.0.0.7 -p 11005. Exit code: 0, 1 with the reason, 2 for a wrong command line.
"""
import argparse
import math
import os
import sys
import time

import Ice

HERE = os.path.dirname(os.path.abspath(__file__))
SLICES = [os.path.join(HERE, "..", "..", "interfaces"), "/usr/share/vismem/slice"]
# Ports of cfg/sim; where one process serves several objects, all of its ports lead to each of them.
PORTS = {"cameraA": 9999, "Motors": 9990, "Encoders": 9997, "PanTilt": 9977, "VisualMemory": 9970, "Gaze": 9970,
         "Localization": 9971, "Simulation": 9972, "Replay": 9973, "Recorder": 9992, "Mapper": 9974}
COMPONENT_PORTS = {"simulator": 9999, "replay_server": 9999, "camera_server": 9999, "base_server": 9990,
                   "pantilt_server": 9977, "active_visual_memory": 9970, "localization": 9971, "recorder": 9992,
                   "mapper": 9974}
FILES = ("base", "camera", "component", "gaze", "localization", "pantilt", "visual_memory")
SMALLEST_LONG = -2**63  # "none yet"


def load_slices(folder):
    """Modules `avm` and `jderobot`. Ice takes one text with the options of slice2py."""
    for name in FILES:
        Ice.loadSlice(f"--all -I{Ice.getSliceDir()} -I{folder} {folder}/avm/{name}.ice")
    import avm
    return avm


class Robot:
    def __init__(self, communicator, options):
        self.communicator, self.options = communicator, options

    def find(self, prx, name):
        """The object of a name, asked whether it has this interface."""
        options = self.options
        port = PORTS.get(name, PORTS["cameraA"]) + options.port_offset
        return self._cast(prx, f"{options.robot}/{name}" if options.robot else name, port)

    def component(self, avm, name):
        if name not in COMPONENT_PORTS:
            raise SystemExit(f"component {name} (must be one of {', '.join(sorted(COMPONENT_PORTS))})")
        identity = f"{self.options.robot}.component/{name}" if self.options.robot else f"{name}/component"
        return self._cast(avm.ComponentPrx, identity, COMPONENT_PORTS[name] + self.options.port_offset)

    def _cast(self, prx, identity, port):
        text = self.options.proxy or f"{identity}:tcp -h 127.0.0.1 -p {port}"
        try:
            proxy = prx.checkedCast(self.communicator.stringToProxy(text))
        except (Ice.ProxyParseException, Ice.EndpointParseException, Ice.IdentityParseException) as failure:
            raise SystemExit(f"--proxy {text}: {failure.str}")
        if proxy is None:
            raise SystemExit(f"{text} is no {prx.ice_staticId()}")
        return proxy


def newest(avm, ask, patience_s=10.0):
    """Asks until there is an answer with data: a long-poll ends after 1 s with state Waiting and a reason."""
    end = time.monotonic() + patience_s
    while True:
        result = ask()
        if result.state == avm.SourceState.Running:
            return result
        if time.monotonic() > end or result.state == avm.SourceState.Finished:
            raise SystemExit(f"no data: {result.message or 'none in time'}")


def show_poses(avm, robot, options):
    localization = robot.find(avm.LocalizationPrx, "Localization")
    revision, end = 0, time.monotonic() + options.seconds
    while time.monotonic() < end:
        estimate = newest(avm, lambda: localization.next(revision)).estimate
        if estimate.revision == revision:
            continue
        revision, pose = estimate.revision, estimate.robotInWorld
        if estimate.hasPose:
            print(f"{estimate.stampUs / 1e6:9.2f} {pose.x:7.3f} {pose.y:7.3f} {math.degrees(pose.theta):8.2f} "
                  f"{estimate.reliability:5.2f}", flush=True)


def show_memory(avm, robot, options):
    snapshot = newest(avm, lambda: robot.find(avm.VisualMemoryPrx, "VisualMemory").next(0)).update.snapshot
    for s in snapshot.segments:
        print(f"{s.id:6} {s.label:14} {s.a.x:7.3f} {s.a.y:7.3f} {s.a.z:6.3f}  {s.b.x:7.3f} {s.b.y:7.3f} {s.b.z:6.3f}  "
              f"{'confirmed' if s.confirmed else '-'}")
    print(f"{len(snapshot.segments)} segments, {len(snapshot.primitives)} primitives")


def save_image(avm, robot, options):
    camera = robot.find(avm.CameraPrx, options.camera)
    image = newest(avm, lambda: camera.getNext("JPEG", -1)).image
    with open(options.file, "wb") as file:
        file.write(bytes(image.pixels))
    print(f"{options.file}: {image.width}x{image.height}, stamp {image.stampUs / 1e6:.3f} s")


def look(avm, robot, options):
    gaze = robot.find(avm.GazePrx, "Gaze")
    now_us = newest(avm, lambda: gaze.next(SMALLEST_LONG)).status.stampUs  # the images' clock, not this machine's
    target = avm.GazeTarget(True, avm.Vector3(options.x, options.y, 0.0), avm.PanTiltAngles(0.0, 0.0))
    gaze.request(avm.GazeRequest("robot_client", "look", target, 50.0, now_us + 5_000_000))
    print(f"asked for ({options.x:g}, {options.y:g}) until {now_us / 1e6 + 5:.1f} s")


def drive(avm, robot, options):
    base = robot.find(avm.BasePrx, "Motors")
    lease = base.acquire("robot_client", 10, 1.0)
    mine = base.ice_context({"lease": lease.id})
    try:
        end = time.monotonic() + options.seconds
        while time.monotonic() < end:
            reply = mine.setVelocity(options.v, options.w)  # again and again: the base stops by itself without commands
            time.sleep(0.05)
        print(reply.message or "done")
    finally:
        base.release(lease.id)  # brakes, too


def set_pose(avm, robot, options):
    localization = robot.find(avm.LocalizationPrx, "Localization")
    reply = localization.setPose(avm.Pose2(options.x, options.y, math.radians(options.degrees)))
    print(reply.message or "accepted")


def show_parameters(avm, robot, options):
    for p in robot.component(avm, options.component).parameters():
        print(f"{p.name} = {p.value:g} {p.unit}   # {p.minimum:g}..{p.maximum:g}; {p.description}")


def set_parameter(avm, robot, options):
    reply = robot.component(avm, options.component).setParameter(options.name, options.value)
    print(reply.message or "accepted")


def show_status(avm, robot, options):
    status = robot.component(avm, options.component).getStatus()
    print(f"{status.name} {status.version}: {status.state} {status.reason}")
    for peer in status.peers:
        print(f"  peer {peer.name}: {'connected' if peer.connected else peer.message}")
    for rate in status.rates:
        print(f"  {rate.name}: {rate.hz:.1f} Hz")


def parse():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--slices", default=next((s for s in SLICES if os.path.isdir(s)), SLICES[-1]), metavar="DIR")
    parser.add_argument("--robot", default="", metavar="NAME", help="Robot.Name of the components, where it is set")
    parser.add_argument("--port-offset", type=int, default=0, metavar="N")
    parser.add_argument("--proxy", default="", metavar="TEXT", help="of the object, in place of its name and port")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)

    def command(name, function, *arguments):
        one = commands.add_parser(name)
        one.set_defaults(function=function)
        for argument, kind in arguments:
            one.add_argument(argument, type=kind)
        return one
    command("pose", show_poses).add_argument("--seconds", type=float, default=math.inf)
    command("memory", show_memory)
    command("image", save_image, ("file", str)).add_argument("--camera", default="cameraA")
    command("look", look, ("x", float), ("y", float))
    command("drive", drive, ("v", float), ("w", float), ("seconds", float))
    command("set-pose", set_pose, ("x", float), ("y", float), ("degrees", float))
    command("parameters", show_parameters, ("component", str))
    command("set", set_parameter, ("component", str), ("name", str), ("value", float))
    command("status", show_status, ("component", str))
    return parser.parse_args()


def main():
    options = parse()
    avm = load_slices(options.slices)
    # An answer may have 16 MB, as the components allow; no call waits for a frozen server longer than 3 s.
    settings = ["", "--Ice.MessageSizeMax=16384", "--Ice.Default.InvocationTimeout=3000"]
    with Ice.initialize(settings) as communicator:
        try:
            options.function(avm, Robot(communicator, options), options)
        except OSError as failure:
            raise SystemExit(f"{failure.filename}: {failure.strerror}")
        except avm.Failure as failure:
            raise SystemExit(failure.reason)
        except Ice.ConnectionRefusedException:
            raise SystemExit("nobody serves there: is the setup started, and the port offset right? (scripts/status)")
        except Ice.ObjectNotExistException as failure:
            raise SystemExit(f"nobody has the name {Ice.identityToString(failure.id)} there")
        except Ice.Exception as failure:
            raise SystemExit(f"{type(failure).__name__}: {failure}")


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        pass
