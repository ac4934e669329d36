#include "experiments/ice/trial_farm.h"

#include <functional>
#include <iostream>
#include <nlohmann/json.hpp>
#include <utility>

#include "common/config/text_format.h"

namespace vismem {
namespace {

bool isWhole(const std::string& outcome) {
  return !outcome.empty() && nlohmann::json::parse(outcome).value("whole", false);
}

}  // namespace

TrialFarm::TrialFarm(const std::filesystem::path& folder, std::string commit,
                     std::vector<std::string> workers, std::string locator)
    : folder_(folder),
      commit_(std::move(commit)),
      pool_({std::move(workers), std::move(locator),
             [this](const WorkList::Task& task, const std::string& result, bool is_whole) {
               folder_.save(task.name, task.text, result);
               if (is_whole) results_[task.name] = result;
             },
             [](const std::string& message) { std::cerr << "  " + message + "\n"; }}) {}

TrialOutcome TrialFarm::operator()(const TrialSeries& series, std::uint64_t seed) {
  if (given_out_.emplace(series.name, series.seed).second) giveOut(series);
  const std::string name = nameOf(series, seed);
  std::string result;
  pool_.wait([&] {
    const auto found = results_.find(name);
    if (found == results_.end()) return false;
    result = found->second;
    return true;
  });
  return trialOutcomeFrom(nlohmann::json::parse(result));
}

void TrialFarm::giveOut(const TrialSeries& series) {
  std::vector<WorkList::Task> tasks;
  std::vector<std::pair<std::string, std::string>> whole;
  for (const std::uint64_t seed : seedsOf(series)) {
    const std::string name = nameOf(series, seed);
    const std::string task = trialTask(series, seed, commit_);
    const std::string outcome = folder_.load(name, task);
    if (isWhole(outcome)) {
      whole.emplace_back(name, outcome);
    } else {
      tasks.push_back({name, task, outcome});
    }
  }
  std::cerr << formatted("  %s: %zu trials are done, %zu go to the workers\n", series.name.c_str(),
                         whole.size(), tasks.size());
  pool_.add(std::move(tasks), [&] { results_.insert(whole.begin(), whole.end()); });
}

std::string TrialFarm::nameOf(const TrialSeries& series, std::uint64_t seed) const {
  // Two masters with different variants may share the workers.
  const std::size_t hash = std::hash<std::string>()(trialTask(series, seed, commit_));
  return formatted("%s_%llu_%08zx", series.name.c_str(), static_cast<unsigned long long>(seed),
                   hash & 0xffffffff);
}

}  // namespace vismem
