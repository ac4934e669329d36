/// @file experiment: the chapter's experiments, one command each.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/config/config_error.h"
#include "common/config/project_file.h"
#include "common/tool/command_line_tool.h"
#include "evaluation/app/commit_id.h"
#include "evaluation/app/evaluation_setup.h"
#include "experiments/app/experiment_files.h"
#include "experiments/app/experiments.h"
#include "experiments/app/over_runs.h"
#include "experiments/ice/trial_farm.h"

namespace {

using namespace vismem;

/// The origin of a result.
struct Origin {
  std::string commit;   ///< of the sources
  std::string command;  ///< without folders
};

/// The command line without the program's folder and without options that do not change the results.
std::string commandOf(int argc, char** argv) {
  const std::vector<std::string> left_out{"--out", "--data", "--commit", "--workers", "--locator"};
  std::string command = "experiment";
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const std::string option = word.substr(0, word.find('='));
    if (std::find(left_out.begin(), left_out.end(), option) == left_out.end()) {
      command += " " + word;
    } else if (option == word) {
      ++i;
    }
  }
  return command;
}

nlohmann::json runOnce(const Experiment& experiment, const ExperimentOptions& options, const Origin& origin) {
  const bool is_new = std::filesystem::create_directories(options.out);
  nlohmann::json result{{"experiment", experiment.name}, {"commit", origin.commit},
                        {"command", origin.command},     {"mode", options.mode},
                        {"seed", options.seed},          {"out", options.out.string()}};
  // What is refused leaves no new folder; what failed later keeps its files.
  std::error_code ignored;
  nlohmann::json figures;
  try {
    figures = experiment.run(options);
  } catch (const ConfigError&) {
    if (is_new) std::filesystem::remove(options.out, ignored);
    throw;
  }
  if (figures.empty()) {
    if (is_new) std::filesystem::remove_all(options.out, ignored);
    throw ConfigError({experiment.name + " has no variant \"" + options.variant + "\""});
  }
  result.update(figures);
  replaceFile(options.out / "result.json", result.dump(2) + "\n");
  return result;
}

struct Seeds {
  std::uint64_t first = 0;
  std::uint64_t last = 0;
};

/// "A..B". @throws CLI::ValidationError.
Seeds parseSeeds(const std::string& text) {
  Seeds seeds;
  char rest = 0;
  unsigned long long first = 0;
  unsigned long long last = 0;
  if (std::sscanf(text.c_str(), "%llu..%llu%c", &first, &last, &rest) != 2 || last < first ||
      last - first >= 10'000) {
    throw CLI::ValidationError("--seeds",
                               "\"" + text + "\" (expected A..B with A <= B, at most 10000 seeds)");
  }
  seeds.first = first;
  seeds.last = last;
  return seeds;
}

/// Runs each seed into its own folder and prints its line; then the statistics over all of them.
int runSeeds(const Experiment& experiment, const ExperimentOptions& options, const Seeds& seeds,
             const Origin& origin) {
  std::vector<nlohmann::json> results;
  for (std::uint64_t seed = seeds.first; seed <= seeds.last; ++seed) {
    ExperimentOptions one = options;
    one.seed = seed;
    one.out = options.out / ("seed" + std::to_string(seed));
    results.push_back(runOnce(experiment, one, origin));
    std::cout << results.back().dump() << std::endl;
  }
  const nlohmann::json all{{"experiment", experiment.name},      {"commit", origin.commit},
                           {"command", origin.command},          {"mode", options.mode},
                           {"seeds", {seeds.first, seeds.last}}, {"out", options.out.string()},
                           {"over_seeds", overRuns(results)}};
  replaceFile(options.out / "result.json", all.dump(2) + "\n");
  std::cout << all.dump() << "\n";
  return 0;
}

/// The command line.
struct Arguments {
  ExperimentOptions options;
  std::string name;                  ///< of the experiment
  std::string seeds;                 ///< "A..B"; empty: one seed
  std::string commit;                ///< of the sources
  std::vector<std::string> workers;  ///< proxies; empty: this process runs the trials
  std::string locator;               ///< of the workers' registry
};

void declareWorkers(CLI::App& app, Arguments& arguments) {
  CLI::Option* workers = app.add_option(
      "--workers", arguments.workers,
      "of E5 and E6: proxies of experiment_worker processes that run the trials, such as \"Worker:tcp -h "
      "127.0.0.1 -p 9976\", or with --locator a replica group: Worker@Workers. Finished trials are kept in "
      "OUT/trials: the same command continues a stopped run");
  workers->allow_extra_args(false);
  app.add_option("--locator", arguments.locator,
                 "IceGrid registry of the workers: \"Vismem/Locator:tcp -h HOST -p PORT\"")
      ->needs(workers);
}

void declare(CLI::App& app, const std::vector<std::string>& names, Arguments& arguments) {
  app.add_option("EXPERIMENT", arguments.name, "its name")->required()->check(CLI::IsMember(names));
  app.add_option("--mode", arguments.options.mode, "default or chapter")
      ->check(CLI::IsMember({"default", "chapter"}))
      ->capture_default_str();
  CLI::Option* seed =
      app.add_option("--seed", arguments.options.seed, "of all that is random")->capture_default_str();
  app.add_option("--seeds", arguments.seeds,
                 "A..B: once for each seed, a line each, then mean, least and most over all")
      ->excludes(seed)
      ->check([](const std::string& text) {
        try {
          parseSeeds(text);
          return std::string();
        } catch (const CLI::Error& error) {
          return std::string(error.what());
        }
      });
  app.add_option("--variant", arguments.options.variant,
                 "of an experiment that has several: only the one of this name (default: all)");
  app.add_option("--variants", arguments.options.variants,
                 "file of the variants of E5 or E6 (default: cfg/experiments/EXPERIMENT.variants)");
  app.add_option("--trials", arguments.options.trials,
                 "runs of each variant of an experiment over many (E5, E6; default: as documented)")
      ->check(CLI::Range(1, 10'000));
  app.add_option(
         "--methods", arguments.options.methods,
         "of E5 and E6: only these, by name, with commas between them: \"default\" leaves out the peers, "
         "which take most of the time (default: all)")
      ->delimiter(',');
  app.add_option(
         "--gaze", arguments.options.gaze,
         "of E6: the gaze policy: salience alone, with requests of localization, or with requests of a "
         "localization that knows the true place (oracle, a bound); both: the first two, "
         "all: all, each in trials of its own with the same kidnappings, compared")
      ->check(CLI::IsMember({"salience", "localization", "oracle", "both", "all"}));
  app.add_option("--out", arguments.options.out, "folder for all that is written (default: out/EXPERIMENT)");
  app.add_option("--commit", arguments.commit, "id of the sources, for the results (default: of this build)");
  app.add_option(
      "--data", arguments.options.data,
      "folder of recordings and photographs (default: AVM_DATA, else ../shared/data beside the project)");
}

/// An option that the experiment does not read is a mistake.
/// @throws ConfigError.
void refuseUnused(const CLI::App& app, const std::string& experiment) {
  struct Use {
    const char* option;
    const char* lacks;
    std::vector<std::string> experiments;
  };
  static const std::vector<Use> kUses{
      {"--workers", "trials", {"E5", "E6"}},
      {"--variants", "file of variants", {"E5", "E6"}},
      {"--variant", "variants", {"E1", "E2", "E3", "E4", "E5", "E6", "E7", "E8", "map", "primitives"}},
      {"--methods", "methods to compare", {"E5", "E6"}},
      {"--trials", "trials", {"E5", "E6", "map"}},
      {"--gaze", "gaze policies", {"E6"}}};
  for (const Use& use : kUses) {
    const auto& names = use.experiments;
    if (app.count(use.option) == 0 || std::find(names.begin(), names.end(), experiment) != names.end())
      continue;
    std::string list;
    for (const std::string& name : names) list += (list.empty() ? "" : " or ") + name;
    throw ConfigError(
        {std::string(use.option) + ": " + experiment + " has no " + use.lacks + " (must be " + list + ")"});
  }
}

/// Where recordings and photographs lie when the command line does not name it.
std::filesystem::path defaultData() {
  const char* data = std::getenv("AVM_DATA");
  return data != nullptr ? std::filesystem::path(data) : projectFile("../shared/data");
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  arguments.commit = commitId();
  std::vector<std::string> names;
  std::string list = "The experiments of the chapter, with figures, CSV and JSON. EXPERIMENT is one of\n";
  for (const Experiment& experiment : experiments()) {
    names.push_back(experiment.name);
    list += "  " + experiment.name + "  " + experiment.title + "\n";
  }
  CLI::App app(list);
  declare(app, names, arguments);
  declareWorkers(app, arguments);
  if (const auto code = parseTool(app, argc, argv)) return *code;
  ExperimentOptions& options = arguments.options;
  if (options.data.empty()) options.data = defaultData();
  const Origin origin{arguments.commit, commandOf(argc, argv)};
  try {
    cv::setNumThreads(1);
    const auto chosen =
        std::find_if(experiments().begin(), experiments().end(),
                     [&](const Experiment& experiment) { return experiment.name == arguments.name; });
    if (options.out.empty()) options.out = std::filesystem::path("out") / chosen->name;
    refuseUnused(app, chosen->name);
    if (!arguments.workers.empty()) {
      // Only programs of the same build give the same results, whatever --commit says.
      options.source = [farm = std::make_shared<TrialFarm>(options.out / "trials", commitId(),
                                                           arguments.workers, arguments.locator)](
                           const TrialSeries& series, std::uint64_t seed) { return (*farm)(series, seed); };
    }
    if (!arguments.seeds.empty()) return runSeeds(*chosen, options, parseSeeds(arguments.seeds), origin);
    std::cout << runOnce(*chosen, options, origin).dump() << "\n";
    return 0;
  } catch (const ConfigError& error) {
    std::cerr << error.what() << "\n";
    return 2;
  } catch (const std::exception& error) {
    std::cerr << "experiment: " << error.what() << "\n";
    return 1;
  }
}
