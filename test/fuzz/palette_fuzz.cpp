// Palettes of any bytes.
#include <cstdint>
#include <stdexcept>
#include <string_view>

#include "common/config/config_error.h"
#include "common/vision/palette.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace vismem;
  try {
    const Palette palette = Palette::parse({reinterpret_cast<const char*>(data), size}, "fuzz.palette");
    for (const auto& label : palette.labels()) {
      if (label.empty()) throw std::logic_error("a label without a name");
    }
  } catch (const ConfigError& error) {
    if (error.problems().empty()) throw std::logic_error("an error without a problem");
  }
  return 0;
}
