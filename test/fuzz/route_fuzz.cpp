// Routes of any bytes, and places on those that can be read.
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string_view>

#include "common/config/config_error.h"
#include "common/routes/route.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vismem;
  try {
    const Route route = parseRoute({reinterpret_cast<const char*>(data), size}, "fuzz.route");
    for (const double along_m : {-1e9, -1.0, 0.0, 0.5, 1e9}) {
      const RoutePlace place = placeAlong(route, along_m);
      if (!place.position.allFinite() || !std::isfinite(place.heading_rad)) throw std::logic_error("nowhere");
      nearestPlace(route, place.position);
    }
    startOnRoute(reversed(route), 7);
  } catch (const ConfigError& error) {
    if (error.problems().empty()) throw std::logic_error("an error without a problem");
  }
  return 0;
}
