#include "application/app/options.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <iostream>
#include <vector>

#include "common/config/config_reader.h"
#include "common/config/properties.h"
#include "common/config/text_fields.h"
#include "common/process/name_by_date.h"
#include "common/recording/bag_advice.h"
#include "common/recording/bag_file.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;

/// Ports of our setups lie below 11100; every shifted one must still be a port.
constexpr int kMaximumPortOffset = 50'000;

fs::path requireFile(const fs::path& file, const std::string& option, const std::string& what) {
  std::error_code error;
  if (!fs::exists(file, error))
    throw UsageError(option + " " + file.string() + ": no such file (" + what + ")");
  if (!fs::is_regular_file(file, error)) {
    throw UsageError(option + " " + file.string() + ": not a file (" + what + ")");
  }
  return fs::absolute(file);
}

/// A folder of the recorder's with the configurations that are needed.
fs::path requireSession(const fs::path& session) {
  for (const char* name : {"session.json", "cfg/active_visual_memory.cfg", "cfg/localization.cfg"}) {
    std::error_code error;
    if (!fs::is_regular_file(session / name, error)) {
      throw UsageError("--session " + session.string() + ": has no " + name +
                       " (must be a folder that the recorder made)");
    }
  }
  return fs::canonical(session);
}

fs::path findBin() {
  std::error_code error;
  const fs::path self = fs::read_symlink("/proc/self/exe", error);
  if (error) throw UsageError("cannot find the folder of this program: " + error.message());
  return self.parent_path();
}

/// The working directory if it has the setup, else the folder that build/PRESET/bin lies in.
fs::path findRoot(const fs::path& bin, const std::string& setup) {
  const fs::path project = bin / ".." / ".." / "..";
  for (const fs::path& root : {fs::current_path(), project}) {
    if (fs::is_directory(root / "cfg" / setup)) return fs::canonical(root);
  }
  if (fs::is_directory(project / "cfg")) return fs::canonical(project);
  throw UsageError("no folder cfg here or three folders above " + bin.string() +
                   ": run it from the project's root");
}

/// A folder of cfg/ with a simulator or a replay server.
Setup kindOf(const fs::path& cfg, const std::string& setup) {
  std::string names;
  std::vector<fs::path> folders{fs::directory_iterator(cfg), {}};
  std::sort(folders.begin(), folders.end());
  for (const fs::path& folder : folders) {
    const bool simulated = fs::exists(folder / "simulator.cfg");
    if (!simulated && !fs::exists(folder / "replay_server.cfg")) continue;
    if (folder.filename() == setup) return simulated ? Setup::kSimulation : Setup::kReplay;
    names += (names.empty() ? "" : ", ") + folder.filename().string();
  }
  throw UsageError("--setup " + setup + " (must be a folder of " + cfg.string() +
                   " with a simulator or a replay server: " + names + ")");
}

/// A bag, a folder of some, or several with commas between: the components have another working directory.
/// @throws UsageError for what is not there.
fs::path requireBags(const std::string& text) {
  try {
    bagsOf(text);
  } catch (const ConfigError& error) {
    throw UsageError("--bag " + std::string(error.what()));
  }
  std::string absolute;
  for (const std::string_view part :
       fs::exists(text) ? std::vector<std::string_view>{text} : splitAt(text, ',')) {
    fs::path path = fs::absolute(part).lexically_normal();
    if (!path.has_filename()) path = path.parent_path();
    absolute += (absolute.empty() ? "" : ",") + path.string();
  }
  return absolute;
}

/// Whether the setup says that its map has a frame of its own, as one from a drive.
bool mapHasOwnFrame(const RunOptions& options) {
  const fs::path file = options.root / "cfg" / options.folder / "gui_server.cfg";
  if (!fs::exists(file)) return false;
  const Properties properties = Properties::load(file);
  return !ConfigReader(properties).group("GuiServer").boolean("Truth", true);
}

double parseSeconds(const std::string& text) {
  const auto value = finiteNumber(text);
  if (!value || *value <= 0.0) throw UsageError("--seconds " + text + " (must be a number above 0)");
  return *value;
}

template <typename Integer>
Integer parseInteger(const std::string& option, const std::string& text, Integer minimum, Integer maximum) {
  Integer value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < minimum || value > maximum) {
    throw UsageError(option + " " + text + " (must be a whole number " + std::to_string(minimum) + ".." +
                     std::to_string(maximum) + ")");
  }
  return value;
}

}  // namespace

fs::path fileOfSetup(const RunOptions& options, const std::string& component, const std::string& key) {
  const Properties properties =
      Properties::load(options.root / "cfg" / options.folder / (component + ".cfg"));
  const Properties::Entry* entry = properties.find(key);
  return entry == nullptr || entry->value.empty() ? fs::path{} : options.root / entry->value;
}

std::optional<RunOptions> parseOptions(int argc, char** argv) {
  CLI::App app{
      "Starts the robot of a setup with its visual memory and localization, shows what they do, and ends "
      "with\n"
      "trajectories, figures and one line of JSON. Ctrl-C ends it in the same way.",
      "run_application"};
  std::string setup = "sim", seconds, seed, bag, map, world, scenario, out, port_offset, session, palette,
              topics;
  bool record = false;
  app.add_option(
      "--setup", setup,
      "sim (a simulated robot on wheels, the default), humanoid (a simulated one that walks), replay "
      "(a recording), nao (a recording of a walking Nao), or another folder of cfg/ with a simulator or a "
      "replay server");
  app.add_option("--seconds", seconds,
                 "length in the robot's time; without it until Ctrl-C or the recording's end");
  app.add_option("--seed", seed, "of the start and of all chance (default 1)");
  app.add_option("--bag", bag,
                 "replay: the recording: a ROS 1 bag, a folder of some, or several with commas between");
  app.add_option(
      "--session", session,
      "replay: a folder that the recorder made; bags, map and configurations are taken from there");
  app.add_flag("--record", record, "record everything into the folder of the results, as recording/");
  app.add_option("--map", map,
                 "map of the world (default when simulated: the setup's; of a --world cfg/maps/WORLD.csv)");
  app.add_option("--palette", palette,
                 "colours of the map (default: MAP.palette beside MAP.csv, else the setup's)");
  app.add_option(
      "--topics", topics,
      "replay: topics of the roles, ROLE=/topic,..., as bag_info advises (default: found by type)");
  app.add_option("--world", world, "simulated: the world, an SDF file (default: the setup's)");
  app.add_option("--scenario", scenario, "simulated: what happens in the world (docs/scenarios.md)");
  app.add_option("--out", out, "folder of the results (default out/DATE-TIME)");
  app.add_option("--port-offset", port_offset, "added to every port, so that several runs share a machine");
  bool no_gui = false;
  app.add_flag("--no-gui", no_gui, "leaves out the page in the browser");
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    std::cout << app.help();
    return std::nullopt;
  } catch (const CLI::ParseError& error) {
    throw UsageError(std::string(error.what()) + " (see --help)");
  }

  RunOptions options;
  options.record = record;
  options.gui = !no_gui;
  if (!seconds.empty()) options.seconds = parseSeconds(seconds);
  if (!seed.empty()) options.seed = parseInteger<std::uint64_t>("--seed", seed, 0, 1'000'000'000'000);
  if (!port_offset.empty())
    options.port_offset = parseInteger("--port-offset", port_offset, 0, kMaximumPortOffset);
  options.bin = findBin();
  options.root = findRoot(options.bin, setup);
  options.folder = setup;
  options.setup = kindOf(options.root / "cfg", setup);

  if (options.setup == Setup::kSimulation) {
    if (!bag.empty()) throw UsageError("--bag is for a setup with a replay server, such as replay");
    if (!topics.empty()) throw UsageError("--topics is for a setup with a replay server, such as replay");
    if (!session.empty()) throw UsageError("--session is for a setup with a replay server, such as replay");
    const fs::path own_world = fileOfSetup(options, "simulator", "Simulator.World");
    options.world =
        world.empty() && !own_world.empty()
            ? requireFile(own_world, "Simulator.World of cfg/" + setup, "must be an SDF world")
            : requireFile(world.empty() ? options.root / "cfg/worlds/corridor.world" : fs::path(world),
                          "--world", "must be an SDF world");
    options.route = fs::path(options.world).replace_extension(".route");
    requireFile(options.route, "--world " + options.world.string() + " needs", "the way-points of its route");
    if (!scenario.empty()) {
      options.scenario = requireFile(scenario, "--scenario", "must be a scenario");
    }
    // The map of a setup is that of its own world.
    if (map.empty() && world.empty()) {
      map = fileOfSetup(options, "localization", "Localization.Map").string();
      options.own_frame = mapHasOwnFrame(options);
    }
    if (map.empty()) map = (options.root / "cfg/maps" / (options.world.stem().string() + ".csv")).string();
  } else {
    if (!world.empty()) throw UsageError("--world is for simulated setups");
    if (!scenario.empty()) throw UsageError("--scenario is for simulated setups");
    if (!session.empty()) {
      if (!bag.empty()) throw UsageError("--session " + session + " has its own bags: --bag is not for it");
      options.session = requireSession(session);
      options.bag = options.session;
      if (map.empty() && fs::exists(options.session / "map.csv"))
        map = (options.session / "map.csv").string();
    } else if (bag.empty()) {
      throw UsageError("--setup " + setup + " needs --bag FILE");
    } else {
      options.bag = requireBags(bag);
    }
    if (map.empty()) throw UsageError("--setup " + setup + " needs --map FILE");
    RobotLogOptions roles;
    if (const std::string wrong = applyTopics(topics, roles); !wrong.empty())
      throw UsageError("--topics " + wrong);
    options.topics = topics;
  }
  options.map = requireFile(map, "--map", "must be a map: CSV of labelled segments");
  const fs::path beside = fs::path(options.map).replace_extension(".palette");
  if (!palette.empty()) {
    options.palette = requireFile(palette, "--palette", "must be a palette");
  } else if (fs::exists(beside)) {
    options.palette = beside;
  }
  options.out =
      fs::absolute(out.empty() ? options.root / "out" / nameByDate() : fs::path(out)).lexically_normal();
  return options;
}

}  // namespace vismem
