#include "experiments/app/trial_work.h"

#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>

#include "experiments/app/experiment_files.h"
#include "experiments/app/trial_variants.h"

namespace vismem {

using nlohmann::json;

std::string trialTask(const TrialSeries& series, std::uint64_t seed, const std::string& commit) {
  // The first trial is drawn.
  const bool with_path = !series.drawn.empty() && seed == seedsOf(series).front();
  return json{{"commit", commit}, {"series", series.origin}, {"seed", seed}, {"path", with_path}}.dump();
}

std::string problemOfTrialTask(const std::string& task, const std::string& commit) {
  try {
    const json all = json::parse(task);
    const auto wanted = all.at("commit").get<std::string>();
    if (wanted != commit) return "the task is of commit " + wanted + ", this program of " + commit;
    all.at("seed").get<std::uint64_t>();
    all.at("path").get<bool>();
    seriesFrom(all.at("series").get<std::string>());
  } catch (const std::exception& error) {
    return error.what();
  }
  return "";
}

std::string runTrialTask(const std::string& task, const std::string& parts, const std::function<void()>& look,
                         const std::function<void(const std::string&)>& part) {
  const json all = json::parse(task);
  const bool with_path = all.at("path").get<bool>();
  const TrialSeries series = seriesFrom(all.at("series").get<std::string>());
  TrialWatch watch;
  watch.look = look;
  watch.part = [&](const TrialOutcome& outcome) { part(toJson(outcome, with_path).dump()); };
  const TrialOutcome so_far = parts.empty() ? TrialOutcome() : trialOutcomeFrom(json::parse(parts));
  return toJson(runTrial(series, all.at("seed").get<std::uint64_t>(), so_far, watch), with_path).dump();
}

TrialFolder::TrialFolder(std::filesystem::path folder) : folder_(std::move(folder)) {
  std::filesystem::create_directories(folder_);
}

std::string TrialFolder::load(const std::string& name, const std::string& task) const {
  std::ifstream in(folder_ / (name + ".json"), std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const json all = json::parse(text, nullptr, /*allow_exceptions=*/false);
  if (!all.is_object() || all.value("task", "") != task) return "";
  return all.at("outcome").dump();
}

void TrialFolder::save(const std::string& name, const std::string& task, const std::string& outcome) const {
  replaceFile(folder_ / (name + ".json"),
              json{{"task", task}, {"outcome", json::parse(outcome)}}.dump() + "\n");
}

}  // namespace vismem
