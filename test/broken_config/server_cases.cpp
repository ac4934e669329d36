#include "broken_config/cases.h"

namespace vismem::test {

std::vector<BrokenConfig> servers() {
  const std::string c = "camera_server";
  const std::string a = "CameraServer.Camera.cameraA.";
  const std::string of_lens = "broken.cfg:1: " + a +
                              "Calibration = lens.yaml (must be a calibration of a camera as ROS writes it; "
                              "what is wrong with it follows)";
  const std::string p = "pantilt_server";
  const std::string b = "base_server";
  return {
      {"CameraNone",
       c,
       {},
       {"broken.cfg: missing key \"" + a + "Driver\" (must be a driver: files, pattern, v4l2)"},
       2,
       {a + "Driver"}},
      {"CameraDriverUnknown",
       c,
       {a + "Driver = file"},
       {"broken.cfg:1: " + a +
        "Driver = file (unknown driver (did you mean \"files\"?); must be one of: files, pattern, v4l2)"}},
      {"CameraSourceMissing",
       c,
       {a + "Driver = files"},
       {"broken.cfg: missing key \"" + a +
        "Source\" (must be a folder of images, an image, a video or an address such as rtsp://host/path)"}},
      {"CameraKeyOfAnotherDriver", c, {a + "Loop = yes"}, {"broken.cfg:1: unknown key \"" + a + "Loop\""}},
      {"CameraKeyUnknown",
       c,
       {a + "Widht_px = 320"},
       {"broken.cfg:1: unknown key \"" + a + "Widht_px\" (did you mean \"" + a + "Width_px\"?)"}},
      {"CameraNameWithASlash",
       c,
       {"CameraServer.Camera.front/left.Driver = pattern"},
       {"broken.cfg:1: CameraServer.Camera.front/left.Driver = pattern (a camera's name must be of letters, "
        "digits, _ and -)"}},
      {"CameraTooWide",
       c,
       {a + "Width_px = 100000"},
       {"broken.cfg:1: " + a + "Width_px = 100000 (must be 0..16384)"}},
      {"CameraRateTooSlow",
       c,
       {a + "Rate_hz = 0.0001"},
       {"broken.cfg:1: " + a + "Rate_hz = 0.0001 (must be 0 or 0.001..1000)"}},
      {"CameraTurnedByAnyAngle",
       c,
       {a + "Rotate_deg = 45"},
       {"broken.cfg:1: " + a + "Rotate_deg = 45 (must be one of: 0, 90, 180, 270)"}},
      {"CameraCalibrationMissing",
       c,
       {a + "Calibration = lens.yaml"},
       {"broken.cfg:1: " + a +
        "Calibration = lens.yaml (no such file or folder in HERE or the folders above)"}},
      {"CameraCalibrationIsNoYaml",
       c,
       {a + "Calibration = lens.yaml"},
       {of_lens, "lens.yaml:2: end of sequence flow not found"},
       2,
       {},
       {{"lens.yaml", "image_width: [\n"}}},
      {"CameraCalibrationOfAFisheye",
       c,
       {a + "Calibration = lens.yaml"},
       {of_lens,
        "lens.yaml:3: distortion_model equidistant (must be plumb_bob, or rational_polynomial without k4, "
        "k5, k6)"},
       2,
       {},
       {{"lens.yaml",
         "image_width: 320\nimage_height: 240\ndistortion_model: equidistant\ncamera_matrix:\n  rows: 3\n  "
         "cols: 3\n"
         "  data: [200, 0, 160, 0, 200, 120, 0, 0, 1]\ndistortion_coefficients:\n  rows: 1\n  cols: 4\n"
         "  data: [0, 0, 0, 0]\n"}}},
      {"CameraTwoLenses",
       c,
       {a + "HorizontalView_deg = 60", a + "Lens.Focal_px = 277 277"},
       {"broken.cfg:1: " + a +
        "HorizontalView_deg = 60 (must not stand beside another key of the lens: only one of Calibration, "
        "Lens.* and HorizontalView_deg)"}},
      {"CameraLensWithoutFocalLength",
       c,
       {a + "Lens.Width_px = 320", a + "Lens.Height_px = 240", a + "Lens.Centre_px = 160 120"},
       {"broken.cfg: missing key \"" + a + "Lens.Focal_px\" (must be set where any key of a lens is)"}},
      {"CameraPortInUse",
       c,
       {"CameraServer.Endpoints = tcp -h 127.0.0.1 -p PORT"},
       {"cannot serve at CameraServer.Endpoints = tcp -h 127.0.0.1 -p PORT (adapter CameraServerAdapter): "
        "Address already in use"},
       1},
      {"PanTiltDriverMissing",
       p,
       {},
       {"broken.cfg: missing key \"PanTiltServer.Driver\" (must be a driver: " VISMEM_PANTILT_DRIVERS ")"},
       2,
       {"PanTiltServer.Driver"}},
      {"PanTiltDriverUnknown",
       p,
       {"PanTiltServer.Driver = simulatd"},
       {"broken.cfg:1: PanTiltServer.Driver = simulatd (unknown driver (did you mean \"simulated\"?); must "
        "be one of: " VISMEM_PANTILT_DRIVERS ")"}},
      {"PanTiltPlaceOfTwoNumbers",
       p,
       {"PanTiltServer.Position_m = 0 0"},
       {"broken.cfg:1: PanTiltServer.Position_m = 0 0 (must be 3 numbers, -10..10)"}},
      {"PanTiltKeyUnknown",
       p,
       {"PanTiltServer.Pan.Maximum = 10"},
       {"broken.cfg:1: unknown key \"PanTiltServer.Pan.Maximum\" (did you mean "
        "\"PanTiltServer.Pan.Maximum_deg\"?)"}},
      {"PanTiltLimitOutOfRange",
       p,
       {"PanTiltServer.Pan.Maximum_deg = 500"},
       {"broken.cfg:1: PanTiltServer.Pan.Maximum_deg = 500 (must be 0..180)"}},
      {"PanTiltPortInUse",
       p,
       {"PanTiltServer.Endpoints = tcp -h 127.0.0.1 -p PORT"},
       {"cannot serve at PanTiltServer.Endpoints = tcp -h 127.0.0.1 -p PORT (adapter PanTiltServerAdapter): "
        "Address already in use"},
       1},
      {"BaseDriverEmpty",
       b,
       {"BaseServer.Driver ="},
       {"broken.cfg:1: BaseServer.Driver = (empty) (must be a driver: pioneer, simulated)"}},
      {"BaseServesUnknown",
       b,
       {"BaseServer.Serves = wheels"},
       {"broken.cfg:1: BaseServer.Serves = wheels (must be one of: both, motors, encoders)"}},
      {"BaseKeyUnknown",
       b,
       {"BaseServer.MaximumSpeed = 1"},
       {"broken.cfg:1: unknown key \"BaseServer.MaximumSpeed\" (did you mean "
        "\"BaseServer.MaximumSpeed_mps\"?)"}},
      {"BaseSpeedNotANumber",
       b,
       {"BaseServer.MaximumSpeed_mps = fast", "BaseServer.Watchdog_s = -1"},
       {"broken.cfg:1: BaseServer.MaximumSpeed_mps = fast (must be a number, 0.01..5)",
        "broken.cfg:2: BaseServer.Watchdog_s = -1 (must be 0.05..60)"}},
      {"BasePortInUse",
       b,
       {"BaseServer.Endpoints = tcp -h 127.0.0.1 -p PORT"},
       {"cannot serve at BaseServer.Endpoints = tcp -h 127.0.0.1 -p PORT (adapter BaseServerAdapter): "
        "Address "
        "already in use"},
       1},
  };
}

}  // namespace vismem::test
