#include "application/app/run_inputs.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>

#include "common/config/config_error.h"
#include "common/config/config_reader.h"
#include "common/vision/palette.h"

namespace vismem {

Route loadRoute(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  if (!in) throw ConfigError({file.string() + ": cannot read it: " + std::strerror(errno)});
  return parseRoute(text.str(), file.string());
}

RunMap loadRunMap(const std::filesystem::path& map, const std::filesystem::path& palette) {
  RunMap loaded{loadSegmentMap(map), {}};
  const auto stripes = palette.empty() ? std::map<Label, Label>{} : loadPalette(palette).stripes();
  loaded.edges = expandStripes(loaded.map, stripes);
  return loaded;
}

ImageRange judgedImages(const RunOptions& options) {
  const std::filesystem::path file = options.root / "cfg/replay/recordings.cfg";
  const Properties properties = Properties::load(file);
  ConfigReader config(properties);
  constexpr long kEnd = 1'000'000'000;
  ImageRange range;
  for (const std::string& name : config.children("Recording")) {
    ConfigReader recording = config.group("Recording." + name);
    const ImageRange read{static_cast<int>(recording.integer("FirstImage", 1, 1, kEnd)),
                          static_cast<int>(recording.integer("LastImage", kEnd, 1, kEnd))};
    if (name == options.bag.stem().string()) range = read;
  }
  config.finish();
  return range;
}

}  // namespace vismem
