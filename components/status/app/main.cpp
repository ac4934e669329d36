/// @file show_status: status of the running components. See its --help; scripts/status calls it.
#include <Ice/Ice.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <iostream>

#include "common/config/config_error.h"
#include "common/process/ice_setup.h"
#include "common/process/log.h"
#include "common/process/setup.h"
#include "common/process/status_client.h"
#include "common/tool/command_line_tool.h"
#include "common/tool/end_signals.h"
#include "status/app/setup_search.h"

namespace {

using namespace vismem;
namespace fs = std::filesystem;

constexpr int kExitWhole = 0;
constexpr int kExitNotWhole = 1;

struct Options {
  std::vector<std::string> setups;
  bool watch = false;
  bool json = false;
  std::string configuration;
  std::string configurations = "cfg";
  int port_offset = 0;
  double timeout_s = 1.0;
  double interval_s = 1.0;
};

void declare(CLI::App& app, Options& options) {
  app.add_option(
      "SETUP", options.setups,
      "a setup that scripts/start runs, or a folder of cfg/ (default: all that scripts/start runs; where "
      "it runs none, those of cfg/ that answer)");
  app.add_flag("--watch", options.watch, "again and again until Ctrl-C");
  app.add_flag("--json", options.json, "one line of JSON instead of the table");
  app.add_option("--configuration", options.configuration,
                 "the effective configuration of this component instead: every key, defaults included");
  app.add_option("--port-offset", options.port_offset, "added to the ports of cfg/, as in scripts/run")
      ->check(CLI::Range(0, 50000));
  app.add_option("--setups", options.configurations,
                 "folder of the setups: /etc/vismem where it is installed")
      ->capture_default_str();
  app.add_option("--timeout", options.timeout_s, "how long an answer may take [s]")
      ->check(CLI::Range(0.05, 60.0));
  app.add_option("--interval", options.interval_s, "between two looks of --watch [s]")
      ->check(CLI::Range(0.1, 3600.0));
  app.footer(
      "Exit code: 0 if all components are running, 1 if one is not (waiting, degraded, absent, silent ...), "
      "2 for a "
      "wrong command line.");
}

class Viewer {
 public:
  Viewer(const Options& options, fs::path root)
      : options_(options),
        root_(std::move(root)),
        configurations_(options.configurations),
        log_("show_status", LogLevel::kError),
        ice_(communicator(log_)) {}

  std::vector<ComponentRow> look() {
    auto setups = options_.setups;
    if (setups.empty() && options_.port_offset == 0) setups = startedSetups(root_);
    const bool only_who_answers = setups.empty();
    if (only_who_answers) {
      for (const auto& entry : fs::directory_iterator(configurations_)) {
        if (entry.is_directory() && !componentsOfSetup(entry.path()).empty())
          setups.push_back(entry.path().filename().string());
      }
      std::sort(setups.begin(), setups.end());
    }
    std::vector<ComponentRow> rows;
    for (const auto& setup : setups) {
      for (auto& row : rowsOfSetup(root_, configurations_, setup, options_.port_offset)) {
        const auto same = [&](const ComponentRow& other) {
          return other.name == row.name && other.endpoints == row.endpoints;
        };
        // Setups share ports: a server at a port may belong to either of them.
        const auto known = std::find_if(rows.begin(), rows.end(), same);
        if (known == rows.end()) {
          rows.push_back(std::move(row));
        } else {
          known->setup += "," + row.setup;
        }
      }
    }
    ask(rows);
    std::erase_if(rows, [&](const ComponentRow& row) {
      return row.absent && (only_who_answers || row.may_be_left_out);
    });
    return rows;
  }

  /// @return the exit code.
  int showConfiguration() {
    for (const auto& row : look()) {
      if (row.name != options_.configuration) continue;
      if (!row.report) throw std::runtime_error(row.name + ": " + row.failure);
      const auto settings = askConfiguration(*ice_.communicator(), statusProxyOf(row), timeout());
      if (options_.json) {
        nlohmann::json json;
        for (const auto& setting : settings) json[setting.key] = setting.value;
        std::cout << json.dump() << std::endl;
      } else {
        for (const auto& setting : settings) std::cout << setting.key << " = " << setting.value << "\n";
      }
      return kExitWhole;
    }
    throw std::runtime_error("no component " + options_.configuration + " is running");
  }

 private:
  static std::shared_ptr<Ice::Communicator> communicator(Logger& log) {
    Properties properties;
    // Absent components are reported as such without a second request; no request to a frozen one may outlast
    // the tool.
    properties.set("Ice.RetryIntervals", "-1");
    properties.set("Ice.Override.CloseTimeout", "100");
    return makeCommunicator(properties, log);
  }

  std::chrono::milliseconds timeout() const {
    return std::chrono::milliseconds(static_cast<int>(1000 * options_.timeout_s));
  }

  void ask(std::vector<ComponentRow>& rows) {
    std::vector<std::string> proxies;
    std::vector<ComponentRow*> asked;
    for (auto& row : rows) {
      if (row.endpoints.empty()) {
        row.absent = true;
        continue;
      }
      proxies.push_back(statusProxyOf(row));
      asked.push_back(&row);
    }
    auto answers = askStatus(*ice_.communicator(), proxies, timeout());
    for (std::size_t i = 0; i < answers.size(); ++i) {
      asked[i]->report = std::move(answers[i].report);
      asked[i]->failure = answers[i].failure;
      asked[i]->absent = answers[i].no_server;
    }
  }

  const Options& options_;
  const fs::path root_;
  const fs::path configurations_;
  Logger log_;
  Ice::CommunicatorHolder ice_;
};

int run(const Options& options) {
  EndSignals end;
  if (!fs::is_directory(options.configurations)) {
    throw ConfigError({"no folder " + options.configurations +
                       " here: run it from the project's root, or name the folder of setups (--setups)"});
  }
  Viewer viewer(options, fs::current_path());
  if (!options.configuration.empty()) return viewer.showConfiguration();
  const bool terminal = isatty(STDOUT_FILENO) == 1;
  for (;;) {
    const auto rows = viewer.look();
    if (options.json) {
      std::cout << statusJson(rows).dump() << std::endl;
    } else {
      // One write for the whole screen, so that it does not flicker.
      std::string picture = options.watch && terminal ? "\033[H\033[J" : "";
      picture += rows.empty() ? "no component is running\n" : statusTable(rows, terminal);
      std::cout << picture << std::flush;
    }
    if (!options.watch || end.wait(options.interval_s)) return isWhole(rows) ? kExitWhole : kExitNotWhole;
  }
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app{"Shows the components of a setup: state, peers, rates, latencies, estimates, last errors.",
               "status"};
  Options options;
  declare(app, options);
  if (const auto code = parseTool(app, argc, argv)) return *code;
  try {
    return run(options);
  } catch (const ConfigError& error) {
    std::cerr << "status: " << error.what() << std::endl;
    return kExitUsage;
  } catch (const std::exception& error) {
    std::cerr << "status: " << error.what() << std::endl;
    return kExitNotWhole;
  }
}
