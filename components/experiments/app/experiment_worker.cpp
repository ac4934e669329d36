/// @file experiment_worker: runs trials that `experiment --workers` gives out.
#include <memory>
#include <opencv2/core/utility.hpp>
#include <thread>

#include "common/process/component.h"
#include "common/process/log.h"
#include "common/process/status.h"
#include "evaluation/app/commit_id.h"
#include "experiments/app/trial_work.h"
#include "experiments/ice/worker_servant.h"

namespace {

using namespace vismem;

/// A trial reports each image; the slowest take tenths of a second.
constexpr std::chrono::milliseconds kProgressLimit{60'000};

WorkerSkill trialSkill() {
  return {[](const std::string& task) { return problemOfTrialTask(task, commitId()); }, runTrialTask};
}

class ExperimentWorker : public Component {
 public:
  void start(ComponentHost& host) override {
    host.serve("Worker", servant_);
    thread_ = std::jthread(host.guarded([this, &host](const std::stop_token& stop) {
      servant_->serve(
          stop, [&host] { host.status().alive("trials", kProgressLimit); },
          [&host](const std::string& id, const std::string& failure) {
            host.status().count(failure.empty() ? "trials" : "trials without a result");
            host.log().info(id + ": " + (failure.empty() ? "done" : failure));
          });
    }));
  }

  void stop() override {
    if (!thread_.joinable()) return;
    thread_.request_stop();
    thread_.join();
  }

 private:
  const std::shared_ptr<WorkerServant> servant_ = std::make_shared<WorkerServant>(trialSkill());
  std::jthread thread_;
};

}  // namespace

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  ComponentSpec spec;
  spec.name = "experiment_worker";
  spec.prefix = "ExperimentWorker";
  spec.summary = "Runs trials of E5 and E6 for `experiment --workers`.";
  spec.default_endpoints = "tcp -h 127.0.0.1 -p 9976";
  spec.configure = [](ConfigReader&) { return std::make_unique<ExperimentWorker>(); };
  return runComponent(argc, argv, spec);
}
