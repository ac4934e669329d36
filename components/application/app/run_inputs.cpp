#include "application/app/run_inputs.h"

#include <iostream>
#include <utility>

#include "common/config/config_error.h"
#include "common/config/config_reader.h"
#include "common/recording/bag_advice.h"
#include "localization/app/config.h"

namespace vismem {

RunMap loadRunMap(const std::filesystem::path& map, const std::filesystem::path& palette) {
  LoadedMap loaded = loadMapEdges(map, palette);
  for (const std::string& warning : loaded.warnings) std::cerr << "warning: " << warning << std::endl;
  return {std::move(loaded.rows), std::move(loaded.edges)};
}

ImageRange judgedImages(const RunOptions& options) {
  const std::filesystem::path file = options.root / "cfg" / options.folder / "recordings.cfg";
  if (!std::filesystem::exists(file)) return {};
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

Trajectory recordedTruth(const RunOptions& options) {
  RobotLogOptions log;
  applyTopics(options.topics, log);
  Trajectory truth;
  try {
    BagFile bag(bagsOf(options.bag.string()));
    for (const TruePose& pose : readTruth(bag, log.truth_topic))
      append(truth, {pose.stamp_us, pose.T_world_robot});
  } catch (const RecordingError&) {
    if (!log.truth_topic.empty()) throw;
  }
  return truth;
}

}  // namespace vismem
