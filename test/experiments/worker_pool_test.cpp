// Tests E6, C3. Workers that die, hang or refuse; the work is writing x.
#include "experiments/ice/worker_pool.h"

#include <gmock/gmock.h>

#include <atomic>
#include <map>
#include <thread>

#include "experiments/ice/worker_servant.h"
#include "support/eventually.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

/// Writes as many x as the task says, one in 5 ms, each a part. `steps` counts them.
WorkerSkill writing(std::atomic<int>* steps = nullptr) {
  return {[](const std::string& task) { return task.starts_with('-') ? "negative" : ""; },
          [steps](const std::string& task, const std::string& parts, const std::function<void()>& look,
                  const std::function<void(const std::string&)>& part) {
            if (task == "bad") throw std::runtime_error("not a number");
            std::string done = parts;
            while (done.size() < std::stoul(task)) {
              std::this_thread::sleep_for(5ms);
              look();
              if (steps != nullptr) ++*steps;
              done += 'x';
              part(done);
            }
            return done;
          }};
}

/// A worker at a port that it keeps over its deaths.
class TestWorker {
 public:
  explicit TestWorker(WorkerSkill skill = writing()) : skill_(std::move(skill)) { start(); }
  ~TestWorker() { kill(); }
  TestWorker(const TestWorker&) = delete;
  TestWorker& operator=(const TestWorker&) = delete;

  void start() {
    communicator_ = std::make_unique<Ice::CommunicatorHolder>(Ice::initialize());
    const auto adapter =
        (*communicator_)
            ->createObjectAdapterWithEndpoints("Worker", "tcp -h 127.0.0.1 -p " + std::to_string(port_));
    port_ = std::dynamic_pointer_cast<Ice::IPEndpointInfo>(adapter->getEndpoints().front()->getInfo())->port;
    servant_ = std::make_shared<WorkerServant>(skill_);
    adapter->add(servant_, {"Worker", ""});
    adapter->activate();
    thread_ = std::jthread([this, servant = servant_](const std::stop_token& stop) {
      servant->serve(
          stop, [] {},
          [this](const std::string& id, const std::string& failure) {
            const std::scoped_lock lock(mutex_);
            finished_[id] = failure;
          });
    });
  }
  void kill() {
    communicator_.reset();
    thread_ = {};
    servant_.reset();
  }
  std::string proxy() const { return "Worker:tcp -h 127.0.0.1 -p " + std::to_string(port_); }
  WorkerServant& servant() { return *servant_; }
  std::map<std::string, std::string> finished() {
    const std::scoped_lock lock(mutex_);
    return finished_;
  }

 private:
  const WorkerSkill skill_;
  int port_ = 0;
  std::unique_ptr<Ice::CommunicatorHolder> communicator_;
  std::shared_ptr<WorkerServant> servant_;
  std::mutex mutex_;
  std::map<std::string, std::string> finished_;
  std::jthread thread_;
};

class WorkerPoolTest : public testing::Test {
 protected:
  WorkerPoolOptions options(std::vector<std::string> workers) {
    return {std::move(workers), "",
            [this](const WorkList::Task& task, const std::string& result, bool is_whole) {
              ++stored_;
              if (is_whole) results_[task.name] = result;
            },
            [](const std::string&) {}};
  }
  void waitFor(WorkerPool& pool, std::size_t results) {
    pool.wait([&] { return results_.size() >= results; });
  }
  static std::vector<WorkList::Task> tasks(int count, const std::string& text) {
    std::vector<WorkList::Task> all;
    for (int i = 0; i < count; ++i) all.push_back({"task" + std::to_string(i), text, ""});
    return all;
  }
  std::map<std::string, std::string> results_;
  std::atomic<int> stored_ = 0;
};

TEST_F(WorkerPoolTest, SpreadsTasksAndCollectsTheirResults) {
  TestWorker first;
  TestWorker second;
  WorkerPool pool(options({first.proxy(), second.proxy()}));
  pool.add(tasks(6, "9"), [] {});
  waitFor(pool, 6);
  for (const auto& [name, result] : results_) EXPECT_EQ(result, "xxxxxxxxx") << name;
  EXPECT_GE(first.finished().size(), 1u);
  EXPECT_GE(second.finished().size(), 1u);
}

TEST_F(WorkerPoolTest, AWorkerThatWasStartedAgainContinuesWithTheParts) {
  constexpr int kLong = 400;
  std::atomic<int> steps = 0;
  TestWorker worker(writing(&steps));
  WorkerPool pool(options({worker.proxy()}));
  pool.add({{"long", std::to_string(kLong), ""}}, [] {});
  ASSERT_TRUE(eventually([&] { return steps > kLong / 2; }));
  worker.kill();
  worker.start();
  waitFor(pool, 1);
  EXPECT_EQ(results_["long"], std::string(kLong, 'x'));
  EXPECT_GE(steps, kLong);
  EXPECT_LT(steps, 3 * kLong / 2) << "it began from nothing";
}

TEST_F(WorkerPoolTest, AnotherWorkerTakesTheTaskOfADeadOne) {
  TestWorker first;
  WorkerPool pool(options({first.proxy(), "Worker:tcp -h 127.0.0.1 -p 1"}));
  pool.add(tasks(2, "9"), [] {});
  waitFor(pool, 2);
  EXPECT_EQ(first.finished().size(), 2u);
}

TEST_F(WorkerPoolTest, AFailedTaskEndsTheRunWithItsReason) {
  TestWorker worker;
  WorkerPool pool(options({worker.proxy()}));
  pool.add({{"wrong", "bad", ""}}, [] {});
  try {
    waitFor(pool, 1);
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), HasSubstr("wrong at Worker"));
    EXPECT_THAT(error.what(), HasSubstr("not a number"));
  }
}

TEST_F(WorkerPoolTest, ATaskThatTheWorkerCannotRunEndsTheRun) {
  TestWorker worker;
  WorkerPool pool(options({worker.proxy()}));
  pool.add({{"wrong", "-1", ""}}, [] {});
  EXPECT_THROW(waitFor(pool, 1), std::runtime_error);
}

TEST_F(WorkerPoolTest, MalformedProxiesAreNamed) {
  for (const char* text : {"Worker:tcp -q", "Worker@Workers", ""}) {
    try {
      WorkerPool pool(options({text}));
      FAIL() << text;
    } catch (const std::runtime_error& error) {
      EXPECT_THAT(error.what(), HasSubstr("workers \"" + std::string(text) + "\""));
    }
  }
}

TEST(WorkerServant, KeepsItsTaskFromOthersWhileSomebodyAsksForIt) {
  TestWorker worker;
  auto& servant = worker.servant();
  const Ice::Current current{};
  servant.begin("one", "100000", "", current);
  servant.begin("one", "100000", "", current);
  EXPECT_THROW(servant.begin("two", "1", "", current), avm::Refused);
  EXPECT_THROW(servant.report("two", 0, current), avm::Refused);
  ASSERT_TRUE(eventually([&] { return servant.report("one", 0, current).parts > 2; }));
  const auto report = servant.report("one", 0, current);
  EXPECT_EQ(report.state, avm::WorkState::Working);
  EXPECT_GT(report.steps, 2);
  EXPECT_THAT(report.text, testing::StartsWith("xx"));
  EXPECT_EQ(servant.report("one", report.parts + 1000, current).text, "");
  // Nobody asks any more: its master has died.
  EXPECT_TRUE(eventually([&] {
    try {
      servant.begin("two", "1", "", current);
      return true;
    } catch (const avm::Refused&) {
      return false;
    }
  }));
  ASSERT_TRUE(eventually([&] { return servant.report("two", 0, current).state == avm::WorkState::Done; }));
  EXPECT_EQ(servant.report("two", 0, current).text, "x");
  EXPECT_EQ(worker.finished()["one"], "another task took its place");
}

TEST(WorkerServant, RefusesWhatItCannotRun) {
  TestWorker worker;
  const Ice::Current current{};
  EXPECT_THROW(worker.servant().begin("", "1", "", current), avm::InvalidArgument);
  EXPECT_THROW(worker.servant().begin(std::string(201, 'x'), "1", "", current), avm::InvalidArgument);
  EXPECT_THROW(worker.servant().begin("big", std::string(2 << 20, '1'), "", current), avm::InvalidArgument);
  EXPECT_THROW(worker.servant().begin("wrong", "-1", "", current), avm::InvalidArgument);
}

}  // namespace
}  // namespace vismem
