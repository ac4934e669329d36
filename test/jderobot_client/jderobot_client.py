#!/usr/bin/python3
"""A client that knows JdeRobot's interfaces and nothing else (see C4): its stubs are made from interfaces/jderobot
when it starts. It asks real servers, and checks what they answer against physics and against the other answers.

  jderobot_client.py INTERFACES camera CAMERA WIDTH HEIGHT OUT_FOLDER
  jderobot_client.py INTERFACES pantilt PANTILT Z_M
  jderobot_client.py INTERFACES looking PANTILT CAMERA
  jderobot_client.py INTERFACES base MOTORS ENCODERS [CAMERA]
  jderobot_client.py INTERFACES pose LOCALIZATION MOTORS X_M Y_M HEADING_DEG
  jderobot_client.py INTERFACES replay REPLAY LENGTH_MS

INTERFACES is the folder with jderobot/*.ice; the others are proxies. Writes what it measured, exits 0 when all is right
and 1 with what is wrong.
"""

import hashlib
import math
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import Ice

PATIENCE_S = 20.0
jderobot = None  # the generated module


class Wrong(Exception):
    """Something is not as it must be."""


def check(condition, message):
    if not condition:
        raise Wrong(message)


def near(name, value, expected, tolerance):
    print(f"{name} = {value:.4g} (expected {expected:.4g} +- {tolerance:.2g})", flush=True)
    check(abs(value - expected) <= tolerance, f"{name} = {value} (must be {expected} +- {tolerance})")


def until(what, condition):
    """The first result of condition() that is true."""
    deadline = time.monotonic() + PATIENCE_S
    while time.monotonic() < deadline:
        result = condition()
        if result:
            return result
        time.sleep(0.02)
    raise Wrong(f"waited {PATIENCE_S} s in vain: {what}")


def make_stubs(interfaces, folder):
    slices = sorted(str(path) for path in Path(interfaces, "jderobot").glob("*.ice"))
    subprocess.run(["slice2py", f"-I{interfaces}", "--prefix", "jderobot_", "--output-dir", folder, *slices],
                   check=True)
    sys.path.insert(0, folder)
    global jderobot
    import jderobot as generated
    jderobot = generated


class Client:
    def __init__(self, communicator):
        self._communicator = communicator

    def find(self, prx, text):
        """Asks the object whether it is of JdeRobot's type, as JdeRobot's clients do."""
        def cast():
            try:
                return prx.checkedCast(self._communicator.stringToProxy(text))
            except Ice.LocalException:
                return None  # not there yet
        proxy = until(f"{text} to be a {prx.ice_staticId()}", cast)
        return proxy


def seconds_of(image):
    return image.timeStamp.seconds + image.timeStamp.useconds * 1e-6


# --- images ------------------------------------------------------------------------------------------

def grab(camera, image_format):
    """A newest image that there is."""
    def try_it():
        try:
            return camera.getImageData(image_format)
        except jderobot.HardwareFailedException:
            return None  # no image yet
    return until(f"an image as {image_format}", try_it)


def grab_later(camera, image_format, than):
    """One that was captured after another."""
    return until(f"a later image as {image_format}",
                 lambda: next((i for i in [grab(camera, image_format)] if seconds_of(i) > seconds_of(than)), None))


def jpeg_size(data):
    """Width and height by the frame header of a JPEG file."""
    at = 2
    while at < len(data):
        check(data[at] == 0xFF, "JPEG: no marker where one must be")
        marker = data[at + 1]
        length = data[at + 2] << 8 | data[at + 3]
        if 0xC0 <= marker <= 0xC2:
            return (data[at + 7] << 8 | data[at + 8], data[at + 5] << 8 | data[at + 6])
        at += 2 + length
    raise Wrong("JPEG without a frame header")


def brightness(rgb):
    return [0.299 * r + 0.587 * g + 0.114 * b for r, g, b in zip(rgb[0::3], rgb[1::3], rgb[2::3])]


def mean_difference(a, b):
    return sum(abs(x - y) for x, y in zip(a, b)) / len(a)


def check_yuy2(yuy2, rgb, luma):
    """BT.601 in video range; a pair of pixels shares its chroma."""
    near("YUY2 luma against RGB8, mean difference",
         mean_difference([(y - 16) * 255 / 219 for y in yuy2[0::2]], luma), 0.0, 2.0)

    def pairs(values):
        return [(a + b) / 2 for a, b in zip(values[0::2], values[1::2])]
    blue, red, grey = pairs(rgb[2::3]), pairs(rgb[0::3]), pairs(luma)
    expected_u = [128 + (b - y) / 1.772 * 224 / 255 for b, y in zip(blue, grey)]
    expected_v = [128 + (r - y) / 1.402 * 224 / 255 for r, y in zip(red, grey)]
    near("YUY2 U against RGB8, mean difference", mean_difference(yuy2[1::4], expected_u), 0.0, 2.0)
    near("YUY2 V against RGB8, mean difference", mean_difference(yuy2[3::4], expected_v), 0.0, 2.0)


def check_formats(client, text, width, height, out):
    camera = client.find(jderobot.CameraPrx, text)
    width, height = int(width), int(height)
    expected_size = {"RGB8": 3 * width * height, "GRAY8": width * height, "YUY2": 2 * width * height}
    offered = camera.getImageFormat()
    print("formats:", *offered, flush=True)
    check(set(offered) >= {"RGB8", "GRAY8", "JPEG", "YUY2"}, f"formats {offered} (must hold RGB8 GRAY8 JPEG YUY2)")
    pixels = {}
    for image_format in offered:
        image = grab(camera, image_format)
        d = image.description
        check((d.width, d.height) == (width, height), f"{image_format}: {d.width}x{d.height}")
        check(d.format == image_format, f"{image_format}: the description says {d.format}")
        data = bytes(image.pixelData)
        check(d.size == len(data), f"{image_format}: size {d.size}, {len(data)} bytes")
        check(hashlib.md5(data).hexdigest() == d.md5sum, f"{image_format}: md5 {d.md5sum} is not the data's")
        if image_format in expected_size:
            check(d.size == expected_size[image_format],
                  f"{image_format}: {d.size} bytes (must be {expected_size[image_format]})")
        later = grab_later(camera, image_format, image)
        check(seconds_of(later) > seconds_of(image), f"{image_format}: stamps stand still")
        pixels[image_format] = data
        Path(out, image_format).write_bytes(data)
    # The scene stands still and has no noise, so all formats show the same picture.
    luma = brightness(pixels["RGB8"])
    mean = sum(luma) / len(luma)
    check(math.sqrt(sum((v - mean) ** 2 for v in luma) / len(luma)) > 5, "the picture is flat")
    near("GRAY8 against RGB8, mean difference", mean_difference(pixels["GRAY8"], luma), 0.0, 1.0)
    check_yuy2(pixels["YUY2"], pixels["RGB8"], luma)
    jpeg = pixels["JPEG"]
    check(jpeg[:2] == b"\xff\xd8" and jpeg[-2:] == b"\xff\xd9", "JPEG without its begin and end")
    check(jpeg_size(jpeg) == (width, height), f"JPEG of {jpeg_size(jpeg)}")
    check(len(jpeg) < len(luma), "JPEG is not smaller than a grey picture")
    try:
        camera.getImageData("BGR565")
        raise Wrong("an unknown format was served")
    except jderobot.DataNotExistException as failure:
        print("unknown format:", failure.what, flush=True)
    d = camera.getImageDescription()
    check((d.width, d.height) == (width, height), f"getImageDescription: {d.width}x{d.height}")
    description = camera.getCameraDescription()
    near("principal point u0 [px]", description.u0, (width - 1) / 2, 1.0)
    near("principal point v0 [px]", description.v0, (height - 1) / 2, 1.0)
    check(description.fdistx > 0.3 * width, f"focal length {description.fdistx} px")


# --- pan-tilt ----------------------------------------------------------------------------------------

def turn_to(motors, encoders, pan_deg, tilt_deg, speed_degps=0.0):
    """Turns and waits until the encoders say so."""
    data = jderobot.PTMotorsData(pan_deg, speed_degps, tilt_deg, speed_degps, 0)
    check(motors.setPTMotorsData(data) == 0, f"PTMotors refused {pan_deg}, {tilt_deg}")
    def there():
        e = encoders.getPTEncodersData()
        return abs(e.panAngle - pan_deg) < 0.05 and abs(e.tiltAngle - tilt_deg) < 0.05
    until(f"the encoders to report {pan_deg}, {tilt_deg} deg", there)


def first_reading(read):
    """A server that has just begun fails until its device has given something."""
    def try_it():
        try:
            return read()
        except Ice.UnknownException:
            return None
    return until("a first reading", try_it)


def check_pan_tilt(client, text, z):
    """z: how high the axes cross above the floor, as the server is configured [m]."""
    z = float(z)
    motors = client.find(jderobot.PTMotorsPrx, text)
    encoders = client.find(jderobot.PTEncodersPrx, text)
    params = motors.getPTMotorsParams()
    near("maxPan [deg]", params.maxPan, 159, 0.01)
    near("minPan [deg]", params.minPan, -159, 0.01)
    near("maxTilt [deg]", params.maxTilt, 31, 0.01)
    near("minTilt [deg]", params.minTilt, -31, 0.01)
    near("maxPanSpeed [deg/s]", params.maxPanSpeed, 150, 0.01)
    first = first_reading(encoders.getPTEncodersData)
    turn_to(motors, encoders, 40.0, -10.0)
    check(encoders.getPTEncodersData().clock > first.clock, "the clock of the encoders stands still")
    # A bound of the speed: 30 degrees at 30 deg/s take a second.
    began = time.monotonic()
    turn_to(motors, encoders, 10.0, -10.0, 30.0)
    took = time.monotonic() - began
    print(f"30 deg at 30 deg/s took {took:.2f} s", flush=True)
    check(took > 0.9, f"30 deg at 30 deg/s took {took} s")
    # Beyond the limits it goes to the limit.
    check(motors.setPTMotorsData(jderobot.PTMotorsData(10.0, 0.0, 90.0, 0.0, 0)) == 0, "beyond the limit is refused")
    until("the upper limit", lambda: abs(encoders.getPTEncodersData().tiltAngle - 31.0) < 0.05)
    check(motors.setPTMotorsData(jderobot.PTMotorsData(math.nan, 0.0, 0.0, 0.0, 0)) == -1, "NaN is taken")

    # The same unit as a pose in 3-D.
    pose_motors = client.find(jderobot.Pose3DMotorsPrx, text)
    pose_encoders = client.find(jderobot.Pose3DEncodersPrx, text)
    data = pose_motors.getPose3DMotorsData()
    near("Pose3DMotors pan [deg]", data.pan, 10.0, 0.01)
    near("Pose3DMotors tilt [deg]", data.tilt, 31.0, 0.01)
    near("Pose3DMotors z [m]", data.z, z, 1e-6)
    data.pan, data.tilt, data.panSpeed, data.tiltSpeed = -25.0, 12.0, 100.0, 100.0
    check(pose_motors.setPose3DMotorsData(data) == 0, "Pose3DMotors refused -25, 12")
    until("Pose3DEncoders to report -25, 12 deg",
          lambda: abs(pose_encoders.getPose3DEncodersData().pan + 25) < 0.05
          and abs(pose_encoders.getPose3DEncodersData().tilt - 12) < 0.05)
    near("PTEncoders pan [deg]", encoders.getPTEncodersData().panAngle, -25.0, 0.05)
    measured = pose_encoders.getPose3DEncodersData()
    near("Pose3DEncoders maxPan [deg]", measured.maxPan, 159, 0.01)
    near("Pose3DEncoders minTilt [deg]", measured.minTilt, -31, 0.01)
    near("Pose3DEncoders z [m]", measured.z, z, 1e-6)
    near("Pose3DEncoders roll", measured.roll, 0.0, 0.0)
    pose_params = pose_motors.getPose3DMotorsParams()
    near("Pose3DMotors maxTilt [deg]", pose_params.maxTilt, 31, 0.01)
    near("Pose3DMotors maxTiltSpeed [deg/s]", pose_params.maxTiltSpeed, 150, 0.01)
    turn_to(motors, encoders, 0.0, 0.0)


def profile(image, across):
    """Mean brightness of the columns (across) or rows in the middle of a grey picture."""
    w, h = image.description.width, image.description.height
    data = bytes(image.pixelData)
    if across:
        rows = range(h // 3, 2 * h // 3)
        return [sum(data[y * w + x] for y in rows) / len(rows) for x in range(w)]
    columns = range(w // 3, 2 * w // 3)
    return [sum(data[y * w + x] for x in columns) / len(columns) for y in range(h)]


def shift(before, after, largest):
    """By how many pixels the content has moved to higher coordinates."""
    def difference(s):
        pairs = [(before[i], after[i + s]) for i in range(len(before)) if 0 <= i + s < len(after)]
        return sum((a - b) ** 2 for a, b in pairs) / len(pairs)
    return min(range(-largest, largest + 1), key=difference)


def check_looking(client, pan_tilt_text, camera_text):
    """Pan > 0 looks left, so the picture moves right; tilt > 0 looks up, so it moves down."""
    motors = client.find(jderobot.PTMotorsPrx, pan_tilt_text)
    encoders = client.find(jderobot.PTEncodersPrx, pan_tilt_text)
    camera = client.find(jderobot.CameraPrx, camera_text)
    first_reading(encoders.getPTEncodersData)
    grab(camera, "GRAY8")  # The description has the lens of the newest image.
    focal = camera.getCameraDescription().fdistx
    step_deg = 5.0
    expected = focal * math.tan(math.radians(step_deg))

    def look(pan, tilt):
        turn_to(motors, encoders, pan, tilt)
        return grab_later(camera, "GRAY8", grab_later(camera, "GRAY8", grab(camera, "GRAY8")))
    ahead = look(0.0, -8.0)
    left = look(step_deg, -8.0)
    up = look(0.0, -8.0 + step_deg)
    near("picture's move to the right for 5 deg of pan [px]", shift(profile(ahead, True), profile(left, True), 60),
         expected, 0.25 * expected)
    near("picture's move down for 5 deg of tilt [px]", shift(profile(ahead, False), profile(up, False), 60),
         expected, 0.25 * expected)
    turn_to(motors, encoders, 0.0, 0.0)


# --- base --------------------------------------------------------------------------------------------

def drive(motors, clock, v, w, seconds):
    """Repeats a command, because the base stops by itself, and then stops. Returns how long it was [s of the clock]."""
    began = clock()
    while clock() - began < seconds:
        check(motors.setV(v) == 0 and motors.setW(w) == 0, "the motors refused")
        time.sleep(0.03)
    check(motors.setV(0.0) == 0 and motors.setW(0.0) == 0, "the motors refused to stop")
    return clock() - began


def settled(read):
    """Readings once they stay the same for a while."""
    state = {"last": read(), "since": time.monotonic()}
    def same():
        now = read()
        moved = abs(now.robotx - state["last"].robotx) + abs(now.roboty - state["last"].roboty) > 0.01
        turned = abs(now.robottheta - state["last"].robottheta) > 0.01
        if moved or turned:
            state.update(last=now, since=time.monotonic())
        return now if time.monotonic() - state["since"] > 0.5 else None
    return until("the base to stand", same)


def turned_deg(before, after):
    return (after.robottheta - before.robottheta + 180.0) % 360.0 - 180.0


def check_base(client, motors_text, encoders_text, camera_text=None):
    motors = client.find(jderobot.MotorsPrx, motors_text)
    encoders = client.find(jderobot.EncodersPrx, encoders_text)
    pose3d = client.find(jderobot.Pose3DPrx, encoders_text)
    clock = time.monotonic
    if camera_text:  # a simulation has its own time: that of its images
        camera = client.find(jderobot.CameraPrx, camera_text)
        clock = lambda: seconds_of(grab(camera, "GRAY8"))
    first_reading(encoders.getEncodersData)
    check(motors.setL(0.1) == -1, "the base claims to move sideways")
    check(motors.setV(math.nan) == -1, "NaN is taken")

    start = settled(encoders.getEncodersData)
    took = drive(motors, clock, 0.2, 0.0, 2.0)
    end = settled(encoders.getEncodersData)
    dx, dy = end.robotx - start.robotx, end.roboty - start.roboty
    # 0.2 m/s for 2 s; acceleration at the begin and braking at the end even out.
    near("driven [mm]", math.hypot(dx, dy), 200.0 * took, 0.08 * 200.0 * took + 15.0)
    # Forward, where the robot looks.
    along = (dx * start.robotcos + dy * start.robotsin) / math.hypot(dx, dy)
    near("cosine of the way to the heading", along, 1.0, 0.02)

    took = drive(motors, clock, 0.0, 0.5, 1.5)
    left = settled(encoders.getEncodersData)
    expected = math.degrees(0.5 * took)
    near("turned to the left [deg]", turned_deg(end, left), expected, 0.1 * expected + 3.0)
    took = drive(motors, clock, 0.0, -0.5, 2.3)
    right = settled(encoders.getEncodersData)
    expected = math.degrees(0.5 * took)
    near("turned to the right [deg]", -turned_deg(left, right), expected, 0.1 * expected + 3.0)
    for reading in (start, end, left, right):
        check(0.0 <= reading.robottheta < 360.0, f"heading {reading.robottheta} (must be 0..360)")
        near("robotcos", reading.robotcos, math.cos(math.radians(reading.robottheta)), 1e-4)
        near("robotsin", reading.robotsin, math.sin(math.radians(reading.robottheta)), 1e-4)

    # It reports the command, clamped to its limits.
    check(motors.setV(9.0) == 0, "too fast is refused")
    near("getV() after setV(9) [m/s]", motors.getV(), 0.6, 1e-6)
    motors.setV(0.0)
    # Without another command it stops by itself.
    motors.setV(0.3)
    until("the watchdog", lambda: motors.getV() == 0.0)
    settled(encoders.getEncodersData)

    # The same pose in metres, with a quaternion w x y z about the vertical.
    e, p = encoders.getEncodersData(), pose3d.getPose3DData()
    near("Pose3D x [m]", p.x, e.robotx / 1000, 1e-4)
    near("Pose3D y [m]", p.y, e.roboty / 1000, 1e-4)
    near("Pose3D heading [cos]", p.q0 ** 2 - p.q3 ** 2, e.robotcos, 1e-4)
    near("Pose3D heading [sin]", 2 * p.q0 * p.q3, e.robotsin, 1e-4)
    near("Pose3D z, q1, q2", abs(p.z) + abs(p.q1) + abs(p.q2), 0.0, 0.0)
    near("Pose3D h", p.h, 1.0, 0.0)
    check(pose3d.setPose3DData(p) == -1, "dead reckoning can be set")


# --- localization's pose --------------------------------------------------------------------------------

def check_pose(client, text, motors_text, x, y, heading_deg):
    """The localization gets the true pose, reports it, and follows a drive of half a metre."""
    pose3d = client.find(jderobot.Pose3DPrx, text)
    motors = client.find(jderobot.MotorsPrx, motors_text)
    x, y, heading = float(x), float(y), math.radians(float(heading_deg))
    q0, q3 = math.cos(heading / 2), math.sin(heading / 2)
    wanted = jderobot.Pose3DData(x, y, 0.0, 1.0, q0, 0.0, 0.0, q3)
    check(pose3d.setPose3DData(jderobot.Pose3DData(x, y, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0)) == -1,
          "a quaternion of zeros is taken")
    check(pose3d.setPose3DData(wanted) == 0, "the pose is refused")

    def distance(p, px, py):
        return math.hypot(p.x - px, p.y - py)
    def found():
        p = first_reading(pose3d.getPose3DData)
        return p if distance(p, x, y) < 0.15 else None
    p = until(f"localization to find the robot at {x}, {y}", found)
    near("|q|", math.sqrt(p.q0 ** 2 + p.q1 ** 2 + p.q2 ** 2 + p.q3 ** 2), 1.0, 1e-4)
    # q and -q are the same rotation.
    near("angle of the quaternion to the commanded one", abs(p.q0 * q0 + p.q3 * q3), 1.0, 0.004)
    near("q1, q2", abs(p.q1) + abs(p.q2), 0.0, 0.0)

    goal = x + 0.5 * math.cos(heading), y + 0.5 * math.sin(heading)
    def ahead():
        motors.setV(0.25)
        q = pose3d.getPose3DData()
        return (q.x - x) * math.cos(heading) + (q.y - y) * math.sin(heading) > 0.5 - 0.06
    until("the pose to move half a metre ahead", ahead)
    motors.setV(0.0)
    time.sleep(1.0)  # it stands, and localization has seen that
    p = pose3d.getPose3DData()
    near("distance to half a metre ahead [m]", distance(p, *goal), 0.0, 0.25)


# --- replay --------------------------------------------------------------------------------------------

def check_replay(client, text, length_ms):
    replay = client.find(jderobot.replayControlPrx, text)
    status = jderobot.ReplayerStatus
    length_ms = int(length_ms)
    check(replay.getStatus() == status.PAUSED, f"it begins {replay.getStatus()}")
    near("time at the begin [ms]", replay.getTime(), 0, 0)
    check(replay.resume(), "resume is refused")
    until("it to play", lambda: replay.getStatus() == status.PLAYING and replay.getTime() > 50)
    check(replay.pause(), "pause is refused")
    stood = replay.getTime()
    time.sleep(0.2)
    near("time while paused [ms]", replay.getTime(), stood, 0)
    check(replay.getStatus() == status.PAUSED, f"paused, it says {replay.getStatus()}")
    check(replay.goTo(length_ms // 2), "goTo is refused")
    near("time after goTo [ms]", replay.getTime(), length_ms // 2, 1)
    check(not replay.goTo(-1), "a negative time is taken")
    check(not replay.goTo(length_ms + 1000), "a time after the end is taken")
    replay.setReplay(False)
    check(replay.resume(), "resume is refused")
    began, began_ms = time.monotonic(), replay.getTime()
    until("the end", lambda: replay.getStatus() == status.FINISHED)
    took = time.monotonic() - began
    print(f"the last {length_ms - began_ms} ms took {took:.2f} s", flush=True)
    check(took > 0.8 * (length_ms - began_ms) / 1000, "it plays too fast")
    replay.setReplay(True)
    check(replay.resume(), "resume is refused at the end")
    until("it to play again", lambda: replay.getStatus() == status.PLAYING and replay.getTime() < length_ms)


CHECKS = {"camera": check_formats, "pantilt": check_pan_tilt, "looking": check_looking, "base": check_base,
          "pose": check_pose, "replay": check_replay}


def main(arguments):
    if len(arguments) < 3 or arguments[1] not in CHECKS:
        print(__doc__, file=sys.stderr)
        return 2
    settings = Ice.InitializationData()
    settings.properties = Ice.createProperties()
    settings.properties.setProperty("Ice.MessageSizeMax", "16384")
    settings.properties.setProperty("Ice.Default.InvocationTimeout", "3000")
    with tempfile.TemporaryDirectory() as stubs, Ice.initialize(settings) as communicator:
        make_stubs(arguments[0], stubs)
        try:
            CHECKS[arguments[1]](Client(communicator), *arguments[2:])
        except Wrong as wrong:
            print("WRONG:", wrong, file=sys.stderr)
            return 1
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
