#include "broken_config/cases.h"

namespace vismem::test {

std::vector<BrokenConfig> servers() {
  const std::string p = "pantilt_server";
  const std::string b = "base_server";
  return {
      {"PanTiltDriverMissing",
       p,
       {},
       {"broken.cfg: missing key \"PanTiltServer.Driver\" (must be a driver: simulated)"},
       2,
       {"PanTiltServer.Driver"}},
      {"PanTiltDriverUnknown",
       p,
       {"PanTiltServer.Driver = simulatd"},
       {"broken.cfg:1: PanTiltServer.Driver = simulatd (unknown driver (did you mean \"simulated\"?); must "
        "be one of: simulated)"}},
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
       {"cannot serve at PanTiltServer.Endpoints = tcp -h 127.0.0.1 -p PORT (adapter PanTiltServerServer): "
        "Address already in use"},
       1},
      {"BaseDriverEmpty",
       b,
       {"BaseServer.Driver ="},
       {"broken.cfg:1: BaseServer.Driver = (empty) (must be a driver: simulated)"}},
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
       {"BaseServer.Endpoints = ws -h 127.0.0.1 -p PORT"},
       {"cannot serve at BaseServer.Endpoints = ws -h 127.0.0.1 -p PORT (adapter BaseServerServer): Address "
        "already in use"},
       1},
  };
}

}  // namespace vismem::test
