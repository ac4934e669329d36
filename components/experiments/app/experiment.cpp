/// @file experiment: the chapter's experiments, one command each. SPEC E1-E9; DESIGN 11.
#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <opencv2/core/utility.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "common/tool/command_line_tool.h"
#include "experiments/app/evaluation_setup.h"
#include "experiments/app/experiments.h"

namespace {

using namespace vismem;

void write(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file);
  out << text;
  out.close();
  if (!out) throw std::runtime_error(file.string() + ": cannot be written");
}

int run(const Experiment& experiment, ExperimentOptions options) {
  if (options.out.empty()) options.out = std::filesystem::path("out") / experiment.name;
  std::filesystem::create_directories(options.out);
  nlohmann::json result{{"experiment", experiment.name},
                        {"mode", options.mode},
                        {"seed", options.seed},
                        {"out", options.out.string()}};
  result.update(experiment.run(options));
  write(options.out / "result.json", result.dump(2) + "\n");
  std::cout << result.dump() << "\n";
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  ExperimentOptions options;
  std::string name;
  std::vector<std::string> names;
  std::string list = "The experiments of the chapter, with figures, CSV and JSON. EXPERIMENT is one of\n";
  for (const Experiment& experiment : experiments()) {
    names.push_back(experiment.name);
    list += "  " + experiment.name + "  " + experiment.title + "\n";
  }
  CLI::App app(list);
  app.add_option("EXPERIMENT", name, "its name")->required()->check(CLI::IsMember(names));
  app.add_option("--mode", options.mode, "default or chapter")
      ->check(CLI::IsMember({"default", "chapter"}))
      ->capture_default_str();
  app.add_option("--seed", options.seed, "of all that is random")->capture_default_str();
  app.add_option("--out", options.out, "folder for all that is written (default: out/EXPERIMENT)");
  app.add_option(
      "--data", options.data,
      "folder of recordings and photographs (default: AVM_DATA, else ../shared/data beside the project)");
  if (const auto code = parseTool(app, argc, argv)) return *code;
  if (options.data.empty()) {
    const char* data = std::getenv("AVM_DATA");
    options.data = data != nullptr ? std::filesystem::path(data) : projectFile("../shared/data");
  }
  try {
    cv::setNumThreads(1);
    const auto chosen = std::find_if(experiments().begin(), experiments().end(),
                                     [&](const Experiment& experiment) { return experiment.name == name; });
    return run(*chosen, options);
  } catch (const std::exception& error) {
    std::cerr << "experiment: " << error.what() << "\n";
    return 1;
  }
}
