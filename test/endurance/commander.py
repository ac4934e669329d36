"""commander.py PORT: drives the simulated robot round the corridor, one command for each image; time waits for it."""
import math
import sys

from robot_application import ROOT, avm, make_communicator
import Ice

SPEED_MPS, REACHED_M = 0.3, 0.4


def route():
    points = []
    with open(f"{ROOT}/cfg/worlds/corridor.route") as file:
        for line in file:
            words = line.split("#")[0].strip().split(",")
            if len(words) == 2 and words[0].replace(".", "").lstrip("-").isdigit():
                points.append((float(words[0]), float(words[1])))
    return points


def wrapped(angle):
    return math.atan2(math.sin(angle), math.cos(angle))


def nearest(points, pose):
    """Index of the next way-point: the end of the nearest side of the closed route."""
    def distance(i):
        (ax, ay), (bx, by) = points[i], points[(i + 1) % len(points)]
        length = math.hypot(bx - ax, by - ay)
        t = min(1.0, max(0.0, ((pose.x - ax) * (bx - ax) + (pose.y - ay) * (by - ay)) / length ** 2))
        return math.hypot(pose.x - ax - t * (bx - ax), pose.y - ay - t * (by - ay))
    return (min(range(len(points)), key=distance) + 1) % len(points)


def main():
    points = route()
    with make_communicator() as communicator:
        at = lambda name: communicator.stringToProxy(f"{name}:tcp -h 127.0.0.1 -p {sys.argv[1]}")  # noqa: E731
        camera, base = avm.CameraPrx.uncheckedCast(at("cameraA")), avm.BasePrx.uncheckedCast(at("Motors"))
        simulation = avm.SimulationPrx.uncheckedCast(at("Simulation"))
        print("commander ready", flush=True)
        seen, goal, stamp = -1, None, -1
        while True:
            try:
                result = camera.getNext("GRAY8", seen)
                if result.state != avm.SourceState.Running or result.image.seq == seen:
                    continue
                seen = result.image.seq
                samples = simulation.truthSince(result.image.stampUs - 50_000).samples
                if not samples:
                    continue
                pose = samples[-1].robotInWorld
                if goal is None or samples[-1].stampUs < stamp:
                    goal = nearest(points, pose)
                stamp = samples[-1].stampUs
                if math.hypot(points[goal][0] - pose.x, points[goal][1] - pose.y) < REACHED_M:
                    goal = (goal + 1) % len(points)
                turn = wrapped(math.atan2(points[goal][1] - pose.y, points[goal][0] - pose.x) - pose.theta)
                base.setVelocity(SPEED_MPS if abs(turn) < 0.6 else 0.0, max(-1.0, min(1.0, 2.0 * turn)))
            except Ice.Exception:
                seen, goal = -1, None


if __name__ == "__main__":
    main()
