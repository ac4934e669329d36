"""A simulated robot that differs from its description: drawn by a seed, which no step of the wizard reads. Its board lies on
the floor of a world of its own, or a simulated hand holds it before the camera."""
import contextlib
import json
import math
import os
import random
import re
import subprocess
import sys

from programs import BIN, running_components
from setup_files import Failure, read_text, set_keys, value_of

WIDTH, HEIGHT = 640, 480
NECK_M = 0.45  # of the pan-tilt unit above the floor, as described
BASE_M = 0.33  # distance of the wheels, as described
RATE_HZ = 10
HELD_S = 0.5  # so long the hand holds the board still
VIEWS = 150  # places of the hand


def rotation(roll, pitch, yaw):
    """About x, then y, then z, as keys of a mounting have it. Angles in radians."""
    (cr, sr), (cp, sp), (cy, sy) = ((math.cos(a), math.sin(a)) for a in (roll, pitch, yaw))
    return [[cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
            [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
            [-sp, cp * sr, cp * cr]]


def angles_of(r):
    """Roll, pitch, yaw of a rotation."""
    return math.atan2(r[2][1], r[2][2]), math.asin(max(-1.0, min(1.0, -r[2][0]))), math.atan2(r[1][0], r[0][0])


def product(a, b):
    return [[sum(a[i][k] * b[k][j] for k in range(3)) for j in range(3)] for i in range(3)]


def moved(pose, point):
    r, t = pose
    return [t[i] + sum(r[i][k] * point[k] for k in range(3)) for i in range(3)]


def texts(values, digits=5):
    return " ".join(f"{value:.{digits}f}" for value in values)


def focal_px(view_deg):
    return 0.5 * WIDTH / math.tan(0.5 * math.radians(view_deg))


def keeps_order(focal, k1, k2):
    """Whether each place of the image, as far as its corners, shows one direction only."""
    r, corner = 0.0, 0.5 * math.hypot(WIDTH, HEIGHT) / focal * 1.05
    while r * (1 + r * r * (k1 + r * r * k2)) < corner:
        if 1 + r * r * (3 * k1 + r * r * 5 * k2) < 0.2:
            return False
        r += 0.01
    return True


def draw_lens(drawn):
    """Pinhole and distortion of a lens that does not fold the image."""
    within = lambda most: drawn.uniform(-most, most)  # noqa: E731
    while True:
        focal = focal_px(drawn.uniform(45.0, 90.0))
        pinhole = (focal, focal * (1 + within(0.003)), 0.5 * (WIDTH - 1) + within(12.0), 0.5 * (HEIGHT - 1) + within(12.0))
        k1 = drawn.uniform(-0.25, 0.05)
        if keeps_order(focal, k1, 0.3 * k1 * k1):
            return pinhole, (k1, 0.3 * k1 * k1, within(0.001), within(0.001), 0.0)


def draw(seed):
    """What is true of the robot, as keys of its simulator. Lens of 45 to 90 degrees, mounting askew up to 3 degrees and 3 cm,
    zeros of the joints up to 5 degrees (in the mounting), scales of joints and wheels up to 3 % off."""
    drawn = random.Random(f"robot {seed}")
    within = lambda most: drawn.uniform(-most, most)  # noqa: E731
    pinhole, distortion = draw_lens(drawn)
    base = BASE_M * (1 + within(0.03))
    keys = {
        "Simulator.Mount.PanTilt.Position_m": texts((within(0.03), within(0.03), NECK_M + within(0.03))),
        "Simulator.Mount.PanTilt.Rotation_deg": texts((within(3), within(3), within(3) + within(5))),
        "Simulator.Mount.Camera.Position_m": texts((within(0.03), within(0.03), within(0.03))),
        "Simulator.Mount.Camera.Rotation_deg": texts((within(3), within(3) + within(5), within(3))),
        "Simulator.Camera.Width_px": WIDTH, "Simulator.Camera.Height_px": HEIGHT, "Simulator.Camera.Rate_hz": RATE_HZ,
        "Simulator.Camera.Pinhole_px": texts(pinhole), "Simulator.Camera.Distortion": texts(distortion),
        "Simulator.PanTilt.Pan.Backlash_deg": f"{drawn.uniform(0, 0.1):.4f}",
        "Simulator.PanTilt.Tilt.Backlash_deg": f"{drawn.uniform(0, 0.1):.4f}",
        "Simulator.Joints.PanScale": f"{1 + within(0.03):.5f}", "Simulator.Joints.TiltScale": f"{1 + within(0.03):.5f}",
        "Simulator.Joints.Delay_s": f"{drawn.uniform(0, 0.1):.4f}",
        "Simulator.Wheels.LeftScale": f"{1 + within(0.03):.5f}", "Simulator.Wheels.RightScale": f"{1 + within(0.03):.5f}",
        "Simulator.Wheels.ReportedBase_m": BASE_M, "Simulator.Base.WheelBase_m": f"{base:.5f}",
        "Simulator.Wheels.Delay_s": f"{drawn.uniform(0, 0.1):.4f}",
    }
    # A data sheet states the field of view in steps of five degrees.
    return keys, 5 * round(math.degrees(2 * math.atan(0.5 * WIDTH / pinhole[0])) / 5)


def describe(robot, seed):
    """Makes the setup's simulator the drawn robot, whose frames state the lens of a data sheet."""
    keys, view_deg = draw(seed)
    lens = f"{robot.setup}/camera.yaml"
    focal, cx, cy = focal_px(view_deg), 0.5 * (WIDTH - 1), 0.5 * (HEIGHT - 1)
    with open(lens, "w", encoding="utf-8") as file:
        file.write(f"# {view_deg} degrees across, by the data sheet; not measured.\n"
                   f"image_width: {WIDTH}\nimage_height: {HEIGHT}\ncamera_name: {robot.name}\n"
                   f"camera_matrix:\n  rows: 3\n  cols: 3\n  data: [{focal:.3f}, 0, {cx}, 0, {focal:.3f}, {cy}, 0, 0, 1]\n"
                   "distortion_model: plumb_bob\ndistortion_coefficients:\n  rows: 1\n  cols: 5\n  data: [0, 0, 0, 0, 0]\n")
    set_keys(f"{robot.setup}/simulator.cfg", {**keys, "Simulator.Camera.Calibration": lens})


def board_arguments(setup):
    """A board whose tags the camera can read from a metre away, as large as a sheet of A1 holds."""
    lens = read_text(f"{setup}/camera.yaml")
    focal = float(re.search(r"data: \[([0-9.]+)", lens).group(1))
    square_mm = min(125, max(60, round(50e3 / focal)))
    columns, rows = min(9, 790 // square_mm), min(6, 540 // square_mm)
    return ["--paper", "A1", "--columns", columns, "--rows", rows, "--square-mm", square_mm, "--world"]


def triple(setup, key):
    return [float(part) for part in value_of(f"{setup}/simulator.cfg", key).split()]


def true_camera(setup):
    """Where the camera is on the robot with its head straight: the hand that holds the board sees the image."""
    pose = ([[1, 0, 0], [0, 1, 0], [0, 0, 1]], [0, 0, 0])
    for part in ("PanTilt", "Camera"):
        at = triple(setup, f"Simulator.Mount.{part}.Position_m")
        turn = [math.radians(a) for a in triple(setup, f"Simulator.Mount.{part}.Rotation_deg")]
        pose = (product(pose[0], rotation(*turn)), moved(pose, at))
    return pose


def board_size_m(robot):
    board = json.loads(read_text(robot.board))
    return 1e-3 * board["square_mm"] * board["columns"], 1e-3 * board["square_mm"] * board["rows"]


def hand(setup, width_m, seed):
    """A scenario: the board at VIEWS places before the camera, from corner to corner of the image, near and aslant."""
    drawn = random.Random(f"hand {seed}")
    camera = true_camera(setup)
    focal = triple(setup, "Simulator.Camera.Pinhole_px")[0]
    lines = ["scenario 1", "at 0 remove floor"]
    for number in range(VIEWS):
        u, v = (drawn.uniform(-0.42, 0.42) * WIDTH, drawn.uniform(-0.42, 0.42) * HEIGHT)
        distance = width_m * focal / (drawn.uniform(0.45, 0.95) * WIDTH)
        # Towards the camera, then aslant about an axis in the board, then turned in its plane.
        towards = rotation(0.0, math.atan2(v, focal), -math.atan2(u, focal))
        slant, about = math.radians(drawn.uniform(0, 45)), drawn.uniform(0, 2 * math.pi)
        slanted = product(product(rotation(about, 0, 0), rotation(0, slant, 0)), rotation(-about, 0, 0))
        faces = [[0, 0, -1], [-1, 0, 0], [0, 1, 0]]  # board's x to the camera's right, its y up
        turn = product(product(towards, slanted), product(faces, rotation(0, 0, math.radians(drawn.uniform(-20, 20)))))
        at = moved(camera, [distance, -distance * u / focal, -distance * v / focal])
        angles = [math.degrees(a) for a in angles_of(product(camera[0], turn))]
        lines.append(f"at {HELD_S * (number + 1):.2f} place board at_m={','.join(f'{x:.4f}' for x in at)} "
                     f"rotation_deg={','.join(f'{a:.3f}' for a in angles)}")
    return "\n".join(lines) + "\n"


@contextlib.contextmanager
def beside_board(robot, port_offset, arguments):
    """The robot in the world of its board; time waits for whoever takes the images. @return what to call its state."""
    world = f"{robot.out}/board/board.world"
    if not os.path.exists(world):
        raise Failure(f"{world}: no such file: scripts/own_robot {robot.name} target makes it")
    state = robot.state_name(port_offset)
    running = running_components(state)
    if running:
        raise Failure(f"{', '.join(sorted(running))} of {state} runs already: scripts/stop {state} first")
    command = ["scripts/start", robot.name, "simulator", f"--Simulator.World={os.path.abspath(world)}", "--Simulator.LockStep=1", *arguments]
    command += ["--port-offset", str(port_offset)] if port_offset else []
    command += ["--no-build"] if os.access(os.path.join(BIN, "simulator"), os.X_OK) else []
    try:
        done = subprocess.run(command, stdout=subprocess.DEVNULL)
        if done.returncode != 0:
            raise Failure("the simulated robot did not start: see above", done.returncode)
        yield state
    finally:
        subprocess.run(["scripts/stop", state], stdout=sys.stderr)


def calibrate_lens(robot, options, program, arguments):
    print("simulated: a hand holds the board before the camera", file=sys.stderr)
    scenario = f"{robot.out}/board/hand.scenario"
    with open(scenario, "w", encoding="utf-8") as file:
        file.write(hand(robot.setup, board_size_m(robot)[0], robot.name))
    with beside_board(robot, options.port_offset, ["--Simulator.Start.Position_m=0 0", "--Simulator.Start.Heading_deg=0",
                                                   f"--Simulator.Scenario={os.path.abspath(scenario)}"]):
        return program("calibrate", [*arguments, "--camera", f"cameraA:tcp -h 127.0.0.1 -p {9999 + options.port_offset}",
                                     "--seconds", 600])[0]


def calibrate_body(robot, options, program, arguments):
    ring = 0.5 * math.hypot(*board_size_m(robot)) + 0.57
    with beside_board(robot, options.port_offset, [f"--Simulator.Start.Position_m={-ring:.3f} 0.1", "--Simulator.Start.Heading_deg=0"]):
        return program("calibrate", [*arguments, "--ring-m", f"{ring:.2f}", "--robot-radius-m", 0.22,
                                     "--port-offset", options.port_offset])[0]
