// The long tests of resilience (label `faults`): every component of every setup killed and frozen for ten
// seconds, and a hundred faults at random. FAULTS_SEED=N repeats a run.
#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "faults/fault_scenarios.h"
#include "support/free_ports.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;

class Faults : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    const auto prepared = prepareSetup(GetParam());
    if (!prepared.missing.empty()) GTEST_SKIP() << prepared.missing;
    application_ = std::make_unique<Application>(GetParam(), freePortOffset(), prepared.extra);
    ASSERT_TRUE(application_->startAll());
    ASSERT_TRUE(application_->waitUntilWhole(kPatience)) << application_->why() << application_->logs();
    report("--- setup " + GetParam());
  }
  std::unique_ptr<Application> application_;
};

TEST_P(Faults, EachComponentKilledAndStartedAgain) {
  killEach(*application_, kWholeWithin);
}

TEST_P(Faults, EachComponentFrozenForTenSeconds) {
  freezeEach(*application_, 10s, kWholeWithin);
}

TEST_P(Faults, AHundredAtRandomLeaveItWhole) {
  const char* given = std::getenv("FAULTS_SEED");
  const std::uint64_t seed = given != nullptr ? std::strtoull(given, nullptr, 10) : std::random_device{}();
  randomFaults(*application_, 100, seed, kWholeWithin);
  for (const auto& name : application_->names()) {
    EXPECT_EQ(application_->process(name).stop(10s), 0) << name << ", seed " << seed;
  }
}

INSTANTIATE_TEST_SUITE_P(Setups, Faults, testing::ValuesIn(triedSetups()),
                         [](const auto& which) { return which.param; });

}  // namespace
}  // namespace vismem
