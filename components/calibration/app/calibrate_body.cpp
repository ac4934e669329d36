#include <algorithm>
#include <filesystem>
#include <iomanip>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "active_visual_memory/app/config.h"
#include "calibration/app/body_files.h"
#include "calibration/app/body_recorder.h"
#include "calibration/app/body_robot.h"
#include "calibration/app/commands.h"
#include "calibration/app/output_files.h"
#include "calibration/core/body/body_keys.h"
#include "calibration/core/target/board_file.h"
#include "common/config/config_error.h"
#include "common/config/text_file.h"
#include "common/process/name_by_date.h"
#include "common/tool/end_signals.h"
#include "common/tool/progress_line.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;

struct BodyOptions {
  std::string setup;
  fs::path board;
  fs::path out;
  std::string bag;
  std::string motors = "Motors:tcp -h 127.0.0.1 -p 9990";
  std::vector<std::string> known;
  int port_offset = 0;
  bool wall = false;
  bool head_only = false;
  bool again = false;
  bool write = false;
  BodyDriveParams drive;
};

/// cfg/NAME/active_visual_memory.cfg, or that of a folder.
fs::path configOf(const std::string& setup) {
  const fs::path folder = fs::is_directory(setup) ? fs::path(setup) : fs::path("cfg") / setup;
  return folder / "active_visual_memory.cfg";
}

ActiveVisualMemoryConfig readSetup(const fs::path& file) {
  const Properties properties = Properties::load(file);
  ConfigReader reader = ConfigReader(properties).group("ActiveVisualMemory");
  ActiveVisualMemoryConfig config = readActiveVisualMemoryConfig(reader);
  if (!reader.good() || !properties.readable()) throw ConfigError(problemLines(reader.allProblems()));
  if (!config.hasPanTilt()) {
    throw ConfigError({file.string() + ": ActiveVisualMemory.PanTilt.Proxy is empty (must name the unit that "
                                       "turns the camera)"});
  }
  return config;
}

BoardSpec readBoard(const fs::path& file) {
  const BoardFile board =
      parseBoardFile(readTextFile(file, "a board that calibrate target wrote"), file.string());
  if (!board.ruler_mm) {
    std::cerr << file.string()
              << ": nobody measured the printed rulers (calibrate target --ruler-mm): all lengths will be as "
                 "wrong as the print\n";
  }
  return board.measured();
}

/// "unit height=450,2": name, value and standard deviation in the unit of the report.
BodyKnowledge knowledgeOf(const std::string& text) {
  const auto equals = text.find('=');
  const auto comma = text.find(',', equals);
  if (equals != std::string::npos && comma != std::string::npos) {
    const std::string name = text.substr(0, equals);
    for (std::size_t i = 0; i < kParameterCount; ++i) {
      const ParameterInfo& info = parameterInfos()[i];
      if (info.name != name) continue;
      try {
        const double value = std::stod(text.substr(equals + 1, comma - equals - 1)) / info.to_unit;
        const double sigma = std::stod(text.substr(comma + 1)) / info.to_unit;
        if (sigma > 0.0) return {i, value, sigma};
      } catch (const std::exception&) {
        break;  // no number: reported below
      }
    }
  }
  throw ConfigError({"--known " + text +
                     " (must be NAME=VALUE,DEVIATION with a name and unit of the report: "
                     "\"unit height=450,2\")"});
}

BodyRecord drive(const BodyOptions& options, const ActiveVisualMemoryConfig& setup, const BoardSpec& board) {
  BodyDriveParams params = options.drive;
  params.rig = setup.pipeline.memory.rig;
  params.drive = !options.head_only;
  params.board_radius_m =
      0.5 * Eigen::Vector2d(board.columns * board.square_m.x(), board.rows * board.square_m.y()).norm();
  if (const std::string problem = checkBodyDrive(params); !problem.empty()) throw ConfigError({problem});
  EndSignals signals;
  LeasedRobot robot(setup, options.motors, options.port_offset);
  BodyDrive plan(params);
  ProgressLine line("steps");
  BodyRecorderOptions how;
  how.board = board;
  how.place = options.wall ? BoardPlace::kWall : BoardPlace::kFloor;
  how.mount = params.rig.mount;
  how.advance = [&] { robot.keepLeases(); };
  how.stopped = [&] { return signals.arrived(); };
  how.progress = [&](const BodyDrive& d, std::size_t) {
    if (d.steps() > 0) line.show(d.stepsDone(), d.steps());
  };
  const BodyRecord record = recordBody(robot.camera(), robot.head(), robot.base(), plan, how);
  if (plan.phase() == BodyDrivePhase::kStopped) {
    std::string kept;
    if (!record.views.empty()) {
      const fs::path file = options.out / ("stopped-" + nameByDate() + ".json");
      writeWholeFile(file, toJson(record).dump() + "\n");
      kept = ". Its " + std::to_string(record.views.size()) + " views are in " + file.string() +
             ": renamed to body.json they are used";
    }
    throw std::runtime_error("the drive was stopped: " + plan.whyStopped() + kept);
  }
  return record;
}

BodyRecord obtainRecord(const BodyOptions& options, const ActiveVisualMemoryConfig& setup) {
  const fs::path file = options.out / "body.json";
  if (fs::exists(file) && !options.again) {
    std::cerr << "the views are those of " << file.string() << " (--again for new ones)\n";
    return readBodyRecord(file);
  }
  if (options.board.empty()) throw ConfigError({"--board is missing (must be a file of calibrate target)"});
  const BoardSpec board = readBoard(options.board);
  BodyRecord record =
      options.bag.empty()
          ? drive(options, setup, board)
          : recordOfBag(options.bag, board, options.wall ? BoardPlace::kWall : BoardPlace::kFloor);
  writeWholeFile(file, toJson(record).dump() + "\n");
  return record;
}

/// Shows the changed lines; with --write changes the file and keeps the old one.
void applyKeys(const BodyOptions& options, const fs::path& file, const std::vector<KeyValue>& keys,
               nlohmann::json& summary) {
  const EditedText edited = setKeys(readTextFile(file, "a configuration"), keys);
  std::cout << (edited.diff.empty() ? "No change of " : "Changes of ") << file.string() << ":\n";
  for (const std::string& line : edited.diff) std::cout << line << "\n";
  summary["changed_lines"] = edited.diff.size();
  summary["written"] = options.write && !edited.diff.empty();
  if (!options.write || edited.diff.empty()) {
    if (!edited.diff.empty()) std::cout << "Nothing was written: add --write.\n";
    return;
  }
  const fs::path old = file.string() + ".before-" + nameByDate();
  fs::copy_file(file, old);
  writeWholeFile(file, edited.text);
  std::cout << "Written. The file before is " << old.string() << "\n";
  summary["before"] = old.string();
}

int calibrateBody(const BodyOptions& options) {
  const fs::path file = configOf(options.setup);
  const ActiveVisualMemoryConfig setup = readSetup(file);
  BodyEstimatorParams params;
  params.mount = setup.pipeline.memory.rig.mount;
  params.wheel_base_m = setup.wheels.reported_base_m;
  for (const std::string& text : options.known) params.knowledge.push_back(knowledgeOf(text));
  const BodyRecord record = obtainRecord(options, setup);
  const BodyEstimate estimate = estimateBody(
      record, params, [](const std::string& stage) { std::cerr << "estimating: " << stage << "\n"; });
  nlohmann::json report = reportOf(estimate);
  writeWholeFile(options.out / "report.json", report.dump(1) + "\n");
  std::cout << tableOf(estimate);
  applyKeys(options, file, bodyKeys(estimate, params.mount, params.wheel_base_m), report);
  std::cout << report.dump() << std::endl;
  return 0;
}

}  // namespace

CalibrateCommand addBodyCommand(CLI::App& calibrate) {
  auto options = std::make_shared<BodyOptions>();
  CLI::App* app = calibrate.add_subcommand(
      "body",
      "Finds where the camera sits on the robot, what its joints and wheels really do, and their time "
      "offsets. "
      "The board lies on the floor about 1 m from the robot, which looks at it from all around by itself. "
      "Ctrl-C "
      "stops it. The keys of the setup are shown as changed lines and written with --write. The last line is "
      "JSON.");
  app->add_option("--setup", options->setup,
                  "a folder of cfg/, or another folder with active_visual_memory.cfg")
      ->required();
  app->add_option("--board", options->board, "OUT/board.json of calibrate target");
  app->add_option("--out", options->out, "folder for views and report; views there are used again")
      ->required();
  app->add_option("--bag", options->bag, "a recording instead of a running robot");
  app->add_flag("--again", options->again, "new views although OUT has some");
  app->add_flag("--write", options->write, "change the setup; the old file is kept beside it");
  app->add_option("--fence-m", options->drive.fence_m,
                  "the robot's middle stays within this distance of the board's middle")
      ->check(CLI::Range(0.5, 20.0))
      ->capture_default_str();
  app->add_option("--ring-m", options->drive.ring_m, "radius of its ways around the board")
      ->check(CLI::Range(0.3, 10.0))
      ->capture_default_str();
  app->add_option("--robot-radius-m", options->drive.robot_radius_m, "of the robot's body")
      ->check(CLI::Range(0.02, 2.0))
      ->capture_default_str();
  app->add_option("--rounds", options->drive.rounds, "around the board, each way")
      ->check(CLI::Range(1, 20))
      ->capture_default_str();
  app->add_option("--speed-mps", options->drive.speed_mps, "of the base")
      ->check(CLI::Range(0.02, 2.0))
      ->capture_default_str();
  app->add_flag("--head-only", options->head_only, "the base stands still: less is observable");
  app->add_flag("--wall", options->wall, "the board hangs on a wall: the height is not observable");
  app->add_option("--known", options->known,
                  "a tape measure: \"unit height=450,2\" (name, value, deviation)");
  app->add_option("--motors", options->motors, "proxy of the base")->capture_default_str();
  app->add_option("--port-offset", options->port_offset, "added to the ports of the setup")
      ->check(CLI::Range(0, 50000));
  return {app, [options] { return calibrateBody(*options); }};
}

}  // namespace vismem
