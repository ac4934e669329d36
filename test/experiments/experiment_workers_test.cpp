// Tests E6. Trials at other processes: the table is that of one process, whoever dies meanwhile.
#include <nlohmann/json.hpp>

#include "experiments/experiment_program.h"
#include "support/component_process.h"

namespace vismem {
namespace {

/// A table without what differs between two runs of one process.
nlohmann::json withoutTimes(nlohmann::json table) {
  if (!table.is_object()) return table;
  for (const char* key : {"cpu_ms_mean", "cpu_ms_p99", "took_s", "out", "command"}) table.erase(key);
  for (auto& [key, value] : table.items()) value = withoutTimes(value);
  return table;
}

class ExperimentWorkers : public ExperimentProgram {
 protected:
  ExperimentWorkers() {
    std::ofstream(folder_ / "short.variants")
        << "E6.Variant.short.Title = two short events\nE6.Variant.short.Events = 2\n"
           "E6.Variant.short.Event_s = 6\nE6.Variant.short.Trials = 3\nE6.Variant.short.Twins = yes\n"
           "E6.Variant.short.World = corridor\nE6.Variant.short.Methods = default chapter\n";
  }
  std::string command(const std::string& out) const {
    return "E6 --variants " + (folder_ / "short.variants").string() + " --out " + (folder_ / out).string();
  }
  static std::unique_ptr<ComponentProcess> worker() {
    return std::make_unique<ComponentProcess>(
        "experiment_worker", std::vector<std::string>{"--ExperimentWorker.Endpoints=tcp -h 127.0.0.1 -p 0"});
  }
  static std::string workerAt(const ComponentProcess& worker) {
    return " --workers \"" + worker.proxy("Worker") + "\"";
  }
  static bool hasTrial(const fs::path& folder) {
    std::error_code absent;
    for (const auto& entry : fs::directory_iterator(folder, absent)) {
      if (entry.path().extension() == ".json") return true;
    }
    return false;
  }
};

TEST_F(ExperimentWorkers, GiveTheTableOfOneProcessThoughAWorkerAndTheMasterDie) {
  ASSERT_EQ(run(command("alone")), 0) << content("stderr");
  const auto alone = lastLine();
  auto first = worker();
  const auto second = worker();
  ASSERT_TRUE(first->waitUntilReady());
  ASSERT_TRUE(second->waitUntilReady());
  const std::string line = command("spread") + workerAt(*first) + workerAt(*second);
  {
    // The master dies once the first outcome is on disk, and a worker with it.
    ChildProcess master({"/bin/sh", "-c", "exec " + std::string(VISMEM_BIN_DIR) + "/experiment " + line}, {});
    ASSERT_TRUE(eventually([&] { return hasTrial(folder_ / "spread/trials"); }, std::chrono::seconds(120)))
        << master.error();
    master.signal(SIGKILL);
    master.waitForExit(kPatience);
    first->signal(SIGKILL);
  }
  ASSERT_EQ(run(line), 0) << content("stderr");
  EXPECT_EQ(withoutTimes(lastLine()), withoutTimes(alone));
  EXPECT_EQ(content("spread/short_events.csv"), content("alone/short_events.csv"));
  EXPECT_TRUE(fs::exists(folder_ / "spread/short_default.png"));
  EXPECT_THAT(content("stderr"), HasSubstr("short: "));
}

TEST_F(ExperimentWorkers, AFinishedRunNeedsNoWorkers) {
  const auto one = worker();
  const std::string line = command("spread") + " --trials 1" + workerAt(*one);
  ASSERT_EQ(run(line), 0) << content("stderr");
  const auto before = lastLine();
  one->signal(SIGKILL);
  ASSERT_EQ(run(line), 0) << content("stderr");
  EXPECT_EQ(withoutTimes(lastLine()), withoutTimes(before));
  EXPECT_THAT(content("stderr"), HasSubstr("short: 1 trials are done, 0 go to the workers"));
}

TEST_F(ExperimentWorkers, NameWhatIsWrong) {
  EXPECT_EQ(run("E1 --workers \"Worker:tcp -h 127.0.0.1 -p 1\" --out " + (folder_ / "e1").string()), 2);
  EXPECT_THAT(content("stderr"), HasSubstr("--workers: E1 has no trials (must be E5 or E6)"));
  EXPECT_EQ(run(command("x") + " --workers Worker@Workers"), 1);
  EXPECT_THAT(content("stderr"), HasSubstr("workers \"Worker@Workers\": has no endpoint, and no --locator"));
  const auto one = worker();
  EXPECT_EQ(run(command("x") + " --methods nothing" + workerAt(*one)), 1);
  EXPECT_THAT(content("stderr"), HasSubstr("no method \"nothing\" here"));
}

}  // namespace
}  // namespace vismem
