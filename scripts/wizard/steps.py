"""The steps of the wizard, declared once: help, command line, list of steps and page read this table."""
import dataclasses
import os
import re
import textwrap

NUMBER = r"[0-9]*\.?[0-9]+"

HOW_TO_DRIVE = """How to drive (docs/mapping.md):
- walking speed, 0.3 m/s; turn slowly; the head looks about by itself
- drive round, and 10 m further: the map needs places that are seen again
- pass everything that the map should have within 3 m; do not lift or push the robot
- lock exposure and white balance of the camera, and leave the light as it is"""


def always(_robot):
    return True


def real(robot):
    return not robot.simulated


def configured(robot):
    return not robot.simulated and os.path.isdir(robot.setup)


def simulated(robot):
    return robot.simulated


def uncalibrated(robot):
    return robot.uncalibrated


@dataclasses.dataclass(frozen=True)
class Argument:
    name: str  # "--seed", or a word for one without a name, such as ACROSS
    kind: str  # flag, whole, number, choice, text; path: of a file or folder; file: a small one, which a browser may send; key: of the setup
    about: str
    value: str = ""  # what stands for it in the help
    default: object = None
    choices: object = ()  # or a function of nothing that lists them
    may_lack_value: bool = False  # the default then counts
    goes_with: tuple = ()  # those of the step's alternatives that it belongs to; none: to all
    to_program: bool = False  # passed on, as it is, to the program behind the step
    minor: bool = False  # not in the overview of the help
    when: object = always  # of a robot
    found: tuple = ()  # patterns of files that it may be
    label: str = ""  # on the page, if not its name

    @property
    def is_named(self):
        return self.name.startswith("--")

    @property
    def spelling(self):
        if not self.is_named or self.kind == "flag":
            return self.name
        return f"{self.name} [{self.value}]" if self.may_lack_value else f"{self.name} {self.value}"

    def listed(self):
        return self.choices() if callable(self.choices) else list(self.choices)


@dataclasses.dataclass(frozen=True)
class Step:
    name: str
    title: str
    does: str  # in the help
    needs: str = ""  # things and people
    how: str = ""  # of a robot's own paths: {setup}, {out}
    how_real: str = ""  # what follows for a robot that is not simulated
    after: tuple = ()  # steps that come before
    unless: tuple = ()  # arguments with which they need not
    otherwise: dict = dataclasses.field(default_factory=dict)  # alternatives: name of an argument, or "" for none, to what it means
    arguments: tuple = ()
    results: dict = dataclasses.field(default_factory=dict)  # files that it leaves, in {out} or {setup}: path to what it shows
    notes: str = ""  # before it begins on a robot that is not simulated
    ctrl_c: str = "stop"  # what Ctrl-C is for
    apply: str = ""  # the argument that makes the changes which the step has shown
    wants_robot: tuple = ()  # alternatives for which its components run; "": the only one
    is_step: bool = True  # it is done once it succeeded
    is_once: bool = False  # it is not repeated
    leads_to: str = ""  # what is to be looked at before the next step, if the robot is not simulated

    @property
    def usage(self):
        shown = [a for a in self.arguments if not a.minor]
        parts = [a.spelling for a in shown if a.name in self.otherwise]
        parts = [" | ".join(parts)] if parts and "" not in self.otherwise else [f"[{part}]" for part in parts]
        parts += [f"[{a.spelling}]" if a.is_named else a.spelling for a in shown if a.name not in self.otherwise]
        return " ".join([self.name, *parts])


def worlds():
    return sorted(file[:-6] for file in os.listdir("cfg/worlds") if file.endswith(".world"))


RECORDINGS = ("out/recordings/*", "out/own_robot/*/drives/*", "*.bag")
PORT_OFFSET = Argument("--port-offset", "whole", "added to every port, so that several setups share a machine", "N", 0, minor=True)


def when(argument, condition, **others):
    return dataclasses.replace(argument, when=condition, **others)


TOPICS = Argument("--topics", "text", "of a recording: ROLE=/topic,..., as bag_info advises", "TEXT", to_program=True, minor=True)
NO_GUI = Argument("--no-gui", "flag", "without the page that shows and drives the robot", minor=True, when=real)
CAMERA_RATE = Argument("--Simulator.Camera.Rate_hz", "number", "of the simulated camera [Hz]; fewer images make a smaller recording", "HZ",
                       to_program=True, minor=True, when=simulated)

PORTS = ("/dev/serial/by-id/*", "/dev/ttyUSB*", "/dev/ttyACM*", "/dev/ttyS?")
KEYS = tuple(Argument(f"--{key}", "key", f"{key}, {about}", "VALUE", choices=choices, to_program=True, minor=True, when=configured, found=found, label=label)
             for key, label, about, choices, found in (
                 ("CameraServer.Camera.cameraA.Device", "camera", "its device", (), ("/dev/v4l/by-id/*", "/dev/video*")),
                 ("PanTiltServer.Driver", "pan-tilt unit", "its driver", ("maestro", "ptu46", "uvc"), ()),
                 ("PanTiltServer.Port", "its port", "of ptu46 and maestro", (), PORTS),
                 ("BaseServer.Driver", "base", "its driver", ("pioneer",), ()), ("BaseServer.Port", "its port", "of pioneer", (), PORTS)))

TABLE = (
    Step("start", "Start", "makes cfg/NAME, the configuration of your robot; or a simulated robot in a world of cfg/worlds, to try the steps",
         how="makes {setup}", how_real=" as a copy of cfg/robot; then set its ports and devices", is_once=True, leads_to="devices",
         otherwise={"": "my own robot", "--simulated": "a simulated robot"},
         arguments=(Argument("--simulated", "choice", "", "WORLD", "corridor", worlds, may_lack_value=True, label="world"),
                    Argument("--seed", "whole", "draws the errors of wheels, and of an uncalibrated robot", "N", 1, goes_with=("--simulated",)),
                    Argument("--uncalibrated", "flag", "its lens, mounting, joints and wheels differ from their description",
                             goes_with=("--simulated",)))),
    Step("devices", "Devices", "shows what is connected; sets drivers and ports in cfg/NAME: --Component.Key=VALUE",
         needs="camera, pan-tilt unit and base, connected", arguments=KEYS, is_step=False),
    Step("target", "Board", "writes the calibration board to print", needs="a printer, and flat glass or board",
         how="print {out}/board/board.pdf at 100 %, glue it onto something flat",
         arguments=(Argument("--paper", "choice", "of the printer", "A4|A3|...", "A4", ("A4", "A3", "A2", "A1"), to_program=True, when=real),
                    Argument("--tile", "choice", "prints it in parts on this paper", "A4|A3", choices=("A4", "A3"), to_program=True, minor=True, when=real),
                    Argument("--square-mm", "number", "side of a square [mm]; as large as fits, if not given", "MM", to_program=True, minor=True, when=real)),
         results={"{out}/board/board.pdf": "the board, to print at 100 %", "{out}/board/board.png": "the board"}),
    Step("ruler", "Ruler", "takes what the two printed rulers measure [mm], for printers scale", needs="the printed board and a ruler", how="measure both rulers of the print",
         after=("target",),
         arguments=(Argument("ACROSS", "number", "the ruler across [mm]", "ACROSS", when=real),
                    Argument("UP", "number", "the ruler up [mm]", "UP", when=real))),
    Step("lens", "Lens", "finds focal lengths and distortion from views of the board; goes on where it stopped",
         needs="the board, in your hand before the camera", how="show the board to the camera: {out}/lens/progress.png says where", after=("target",),
         otherwise={"--images": "a folder of images", "--bag": "a recording", "--camera": "a running camera"},
         arguments=(Argument("--images", "path", "folder of images, each of a still board", "DIR", to_program=True, when=real),
                    Argument("--bag", "path", "ROS 1 bag of a moving board or camera", "FILE", to_program=True, when=real, found=RECORDINGS),
                    Argument("--camera", "text", "its proxy", "PROXY", "cameraA:tcp -h 127.0.0.1 -p 9999", to_program=True, when=real),
                    when(PORT_OFFSET, uncalibrated)),
         results={"{out}/lens/progress.png": "green: the lens is known; the arrow shows where the board is wanted next",
                  "{out}/lens/uncertainty.png": "standard deviation of the projection", "{out}/lens/residuals.png": "what the model does not explain",
                  "{out}/lens/report.json": "figures", "{out}/lens/camera.yaml": "the lens, as ROS reads it"},
         ctrl_c="it goes on from here later", wants_robot=("--camera",)),
    Step("body", "Body", "finds the mounting of the camera, and errors of joints and wheels: the robot drives round the board on the floor; shows the changes of cfg/NAME",
         needs="the board, and free floor",
         how="the board flat on the floor, 1 m before the robot, free space around it", after=("target",),
         arguments=(Argument("--fence-m", "number", "the robot's middle stays within this distance of the board's [m]", "M", 2, to_program=True),
                    Argument("--write", "flag", "makes these changes", to_program=True),
                    Argument("--again", "flag", "new views, although there are some", to_program=True, minor=True),
                    Argument("--head-only", "flag", "the base stands still: less is observable", to_program=True, minor=True),
                    Argument("--ring-m", "number", "radius of its ways around the board [m]", "M", 1.1, to_program=True, minor=True, when=real),
                    Argument("--robot-radius-m", "number", "of the robot's body [m]", "M", 0.25, to_program=True, minor=True, when=real),
                    when(PORT_OFFSET, uncalibrated), when(PORT_OFFSET, real, to_program=True)),
         results={"{out}/body/report.json": "figures"}, apply="--write", wants_robot=("",),
         notes="The robot drives round the board by itself and sees no obstacles: keep the floor free within the fence, and a hand at STOP."),
    Step("drive", "Drive", "records a drive until it is stopped, or for S seconds; or takes a recording", needs="you, who drive it",
         how="once round the place, and 10 m further", after=("start",), unless=("--bag",),
         otherwise={"": "record a drive", "--bag": "take a recording"},
         arguments=(Argument("--seconds", "number", "how long [s]; if not given, until it is ended, a simulated robot once round and further", "S",
                            goes_with=("",)),
                    Argument("--bag", "path", "ROS 1 bag, several with commas between, or a folder", "FILE", found=RECORDINGS),
                    when(TOPICS, always, goes_with=("--bag",)), when(NO_GUI, real, goes_with=("",)),
                    when(PORT_OFFSET, always, goes_with=("",)), when(CAMERA_RATE, simulated, goes_with=("",))),
         notes=HOW_TO_DRIVE, ctrl_c="end the recording"),
    Step("colours", "Colours", "learns the colours of the place, its palette, from the drive; or takes a palette", needs="the drive",
         how="look at {out}/colours/colours.png: images, and beside each what the palette makes of it",
         after=("drive",), unless=("--palette",),
         otherwise={"": "learn from the drive", "--clicks": "learn with my clicks", "--palette": "take a palette"},
         arguments=(Argument("--clicks", "file", "what the clicks' page saved", "FILE"),
                    Argument("--palette", "file", "such as cfg/maps/corridor.palette", "FILE", found=("cfg/maps/*.palette",), label="palette")),
         results={"{out}/colours/colours.png": "what the palette makes of the drive", "{out}/colours/shown/clicks.html": "name colours by clicks",
                  "{out}/colours/colours.palette": "the palette"}),
    Step("map", "Map", "makes the map from the drive, and sets map and palette in cfg/NAME", needs="drive and colours",
         how="compare {out}/map/map.png with the place", after=("drive", "colours"),
         arguments=(Argument("--edits", "file", "changes by hand (docs/mapping.md)", "FILE", to_program=True, minor=True), TOPICS),
         results={"{out}/map/map.png": "the map, with the path of the drive", "{out}/map/map.svg": "a drawing", "{out}/map/map.dxf": "for CAD",
                  "{setup}/map.csv": "the map in use"}),
    Step("localize", "Localize", "tests whether the robot finds itself in the map: in the drive, in a recording, or in a new drive", needs="the map",
         how="look at {out}/localize/top_view.png", after=("map",),
         otherwise={"": "in the drive", "--live": "in a new drive", "--bag": "in another recording"},
         arguments=(Argument("--live", "flag", "records and evaluates a new drive"),
                    Argument("--bag", "path", "ROS 1 bag, or a folder", "FILE", found=RECORDINGS),
                    Argument("--seconds", "number", "of the new drive [s]; 60 if not given", "S", minor=True, goes_with=("--live",)),
                    when(TOPICS, always, goes_with=("", "--bag")),
                    *(when(a, a.when, goes_with=("--live",)) for a in (NO_GUI, PORT_OFFSET, CAMERA_RATE))),
         results={"{out}/localize/top_view.png": "map, path and memory", "{out}/localize/verdict.json": "figures"}),
    Step("robot", "Robot", "starts the components of the robot, which then go on; --stop ends them", after=("start",),
         otherwise={"": "start it", "--stop": "stop it"},
         arguments=(Argument("--stop", "flag", "ends them", minor=True), PORT_OFFSET, when(NO_GUI, real, goes_with=("",))), is_step=False),
    Step("page", "Page", "these steps as a page in the browser, which runs them by buttons",
         arguments=(Argument("--port", "whole", "of the page; any free one, if not given and 8790 is taken", "N"),
                    when(PORT_OFFSET, always, about="what the page suggests for its steps")), is_step=False),
)
STEPS = {step.name: step for step in TABLE}


def overview():
    """Of the help: usage and meaning of each step."""
    lines = []
    for step in TABLE:
        flags = [f"; {a.name}: {a.about}" for a in step.arguments if a.kind == "flag" and not a.minor and a.name not in step.otherwise]
        meaning = textwrap.wrap(step.does + "".join(flags), 92)
        if len(step.usage) <= 32:
            lines.append(f"  {step.usage:32s} {meaning.pop(0)}")
        else:
            lines.append(f"  {step.usage}")
        lines += [" " * 35 + line for line in meaning]
    return "\n".join(lines)


def is_number(text):
    return bool(re.fullmatch(NUMBER, str(text)))
