// Any bytes as a drawing: a map of finite segments on the floor or a ConfigError, nothing else.
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <string>

#include "common/config/config_error.h"
#include "simulator/core/svg_map.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const vismem::Palette kPalette = vismem::Palette::parse(
      "class.floor = value 0..30\nclass.line = saturation 0..10 value 90..100\n"
      "class.door = hue 15..50 saturation 60..100\nclass.wall = saturation 0..20 value 40..80\n"
      "pair.skirting = floor wall\npair.door_foot = floor door\npair.stripe_edge = floor line\n"
      "stripe.line = stripe_edge\n",
      "fuzz.palette");
  vismem::SvgMapParams params;
  // Each corner costs time with every other one.
  params.drawing.max_points = 2000;
  params.ground = "floor";
  if (size % 2 == 1) {
    params.drawing.metres_per_unit = 0.01;
    params.drawing.origin = Eigen::Vector2d(0, 0);
  }
  try {
    const std::string bytes(reinterpret_cast<const char*>(data), size);
    for (const auto& segment : vismem::buildSvgMap(bytes, "fuzz.svg", kPalette, params).map.segments) {
      const double length = segment.world.length();
      if (!(length > 0.0 && length < 1e6) || segment.world.a.z() != 0.0 || segment.world.b.z() != 0.0)
        std::abort();
      if (!(segment.width_m >= 0.0 && segment.width_m < 0.2) || segment.label.empty()) std::abort();
    }
  } catch (const vismem::ConfigError&) {
  }
  return 0;
}
