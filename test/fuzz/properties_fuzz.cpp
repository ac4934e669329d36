// Configuration files of any bytes: the result is a list of problems or keys.
#include <cstdint>
#include <stdexcept>
#include <string_view>

#include "common/config/config_error.h"
#include "common/config/config_reader.h"
#include "common/config/text_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vismem;
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const Properties properties = Properties::parse(text, "fuzz.cfg");
  ConfigReader config(properties);
  ConfigReader group = config.group("Fuzz");
  enum class Choice { kOne, kTwo };
  group.real("Real", 1.0, 0.0, 2.0);
  group.integer("Integer", 1, 0, 10);
  group.boolean("Boolean", true);
  group.reals("Reals", {1.0, 2.0}, -10.0, 10.0);
  group.angleDeg("Angle_deg", 0.0, -180.0, 180.0);
  group.choice("Choice", Choice::kOne, {{"one", Choice::kOne}, {"two", Choice::kTwo}});
  group.requiredText("Text", "a text");
  group.path("Path");
  group.children("Children");
  try {
    config.finish();
  } catch (const ConfigError& error) {
    if (error.problems().empty()) throw std::logic_error("an error without a problem");
    for (const auto& line : error.problems()) {
      if (line.find('\n') != std::string::npos || shown(line) != line)
        throw std::logic_error("cannot be shown");
    }
  }
  return 0;
}
