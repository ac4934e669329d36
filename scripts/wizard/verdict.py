"""Whether the poses of a run are those of a robot that knows its place. The truth is not needed."""
import math
import os

from setup_files import Failure, read_text


SURE_RELIABILITY = 0.6  # as Recorder.Ring.SureAbove
STEADY_S = 10.0  # so long the pose must have followed the odometry
JUMP_M, JUMP_RAD = 0.3, math.radians(15)  # of the pose against the odometry, from one image to the next
PATH_M, PATH_RAD = 0.10, math.radians(3)  # from the path that the map was made from


def read_poses(path):
    """A trajectory in TUM format: [(stamp_s, x, y, theta)]."""
    poses = []
    for number, line in enumerate(read_text(path).splitlines(), 1):
        if line and not line.startswith("#"):
            try:
                t, x, y, _, _, _, qz, qw = map(float, line.split())
            except ValueError:
                raise Failure(f"{path}:{number}: found {line!r} (expected 8 numbers: t x y z qx qy qz qw)") from None
            poses.append((t, x, y, 2 * math.atan2(qz, qw)))
    return poses


def turned(angle):
    return math.remainder(angle, 2 * math.pi)


def step_between(a, b):
    """Motion from pose a to b in the robot's frame."""
    dx, dy, c, s = b[1] - a[1], b[2] - a[2], math.cos(a[3]), math.sin(a[3])
    return c * dx + s * dy, c * dy - s * dx, turned(b[3] - a[3])


def steady_since(poses, odometry):
    """Stamp from which on the pose moves as the odometry does."""
    odom = {round(pose[0], 3): pose for pose in odometry}
    since = poses[0][0]
    for a, b in zip(poses, poses[1:]):
        oa, ob = odom.get(round(a[0], 3)), odom.get(round(b[0], 3))
        if oa is None or ob is None:
            continue
        (x, y, turn), (ox, oy, oturn) = step_between(a, b), step_between(oa, ob)
        if math.hypot(x - ox, y - oy) > JUMP_M or abs(turned(turn - oturn)) > JUMP_RAD:
            since = b[0]
    return since


def median(values):
    return sorted(values)[len(values) // 2]


def distance_to_path(poses, path):
    """Medians of distance and angle to the poses of a path at the nearest stamps."""
    distances, angles = [], []
    for pose in poses:
        near = min(path, key=lambda other: abs(other[0] - pose[0]))
        if abs(near[0] - pose[0]) < 0.05:
            distances.append(math.hypot(near[1] - pose[1], near[2] - pose[2]))
            angles.append(abs(turned(near[3] - pose[3])))
    return (median(distances), median(angles)) if distances else None


def judge(result, folder, path):
    """Whether the poses of a run are those of a robot that knows its place. @param path of the map's own drive, or none."""
    poses = read_poses(os.path.join(folder, "trajectory.tum"))
    if not poses:
        return {"localized": False, "reasons": ["no image has a pose"]}
    last = poses[-1]
    since = steady_since(poses, read_poses(os.path.join(folder, "odometry.tum")))
    steady_s, needed_s = last[0] - since, min(STEADY_S, 0.5 * (last[0] - poses[0][0]))
    verdict = {"x_m": last[1], "y_m": last[2], "theta_deg": math.degrees(last[3]), "reliability": result.get("reliability", 0.0),
               "steady_s": steady_s, "settled_after_s": since - poses[0][0]}
    reasons = []
    if verdict["reliability"] < SURE_RELIABILITY:
        reasons.append(f"its reliability at the end is {verdict['reliability']:.2f} (expected {SURE_RELIABILITY} or more)")
    if steady_s < needed_s:
        reasons.append(f"its pose jumped {steady_s:.1f} s before the end (expected {needed_s:.0f} s without a jump)")
    off = distance_to_path([pose for pose in poses if pose[0] >= since], path) if path else None
    if off:
        verdict.update(path_difference_m=off[0], path_difference_deg=math.degrees(off[1]))
        if off[0] > PATH_M or off[1] > PATH_RAD:
            reasons.append(f"its path lies {off[0]:.2f} m and {math.degrees(off[1]):.1f} degrees off the path that the map was "
                           f"made from (expected {PATH_M} m and {math.degrees(PATH_RAD):.0f} degrees)")
    return {"localized": not reasons, "reasons": reasons, **verdict}
