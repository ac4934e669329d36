// Every component of every setup by itself, and the short version of faults_test.
// Tests C2, C3.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

#include "common/config/properties.h"
#include "common/process/setup.h"
#include "common/robot_ice/base_ice.h"
#include "faults/fault_scenarios.h"
#include "support/build_paths.h"
#include "support/free_ports.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;

class EverySetup : public testing::TestWithParam<std::string> {
 protected:
  void SetUp() override {
    prepared_ = prepareSetup(GetParam());
    if (!prepared_.missing.empty()) GTEST_SKIP() << prepared_.missing;
    application_ = std::make_unique<Application>(GetParam(), freePortOffset(), prepared_.extra);
  }
  PreparedSetup prepared_;
  std::unique_ptr<Application> application_;
};

TEST_P(EverySetup, EachComponentRunsAloneAndSaysWhomItWaitsFor) {
  for (const auto& name : application_->names()) {
    ASSERT_TRUE(application_->start(name));
    const Properties properties =
        Properties::load(std::string(VISMEM_SOURCE_DIR) + "/cfg/" + GetParam() + "/" + name + ".cfg");
    bool has_peers = false;
    for (const auto& [key, entry] : properties.entries()) {
      if (!key.ends_with(".Proxy") || entry.value.empty()) continue;
      has_peers = true;
      const auto peer = key.substr(0, key.size() - std::string(".Proxy").size());
      const auto waited_for = peer.substr(peer.rfind('.') + 1);
      EXPECT_TRUE(application_->says(name, RunState::kWaiting, "waiting for " + waited_for + " at ", 10s));
      EXPECT_TRUE(application_->process(name).waitForLine("waiting for " + waited_for + " at ", kPatience));
    }
    if (!has_peers) {
      EXPECT_TRUE(application_->says(name, RunState::kRunning, "", 10s));
    }
    EXPECT_EQ(application_->process(name).stop(10s), 0) << application_->process(name).error();
    application_->kill(name);
  }
}

TEST_P(EverySetup, SurvivesTheLossOfEachComponent) {
  ASSERT_TRUE(application_->startAll());
  ASSERT_TRUE(application_->waitUntilWhole(kPatience)) << application_->why() << application_->logs();
  killEach(*application_, kPatience);
  if (!HasFatalFailure()) freezeEach(*application_, 1s, kPatience);
}

TEST_P(EverySetup, EachComponentEndsInTimeWhileAllOthersAreFrozen) {
  ASSERT_TRUE(application_->startAll());
  ASSERT_TRUE(application_->waitUntilWhole(kPatience)) << application_->why() << application_->logs();
  stopEachBesideFrozenOnes(*application_);
}

INSTANTIATE_TEST_SUITE_P(Setups, EverySetup, testing::ValuesIn(triedSetups()),
                         [](const auto& which) { return which.param; });

/// The base of a setup: who serves Motors and Encoders.
struct BaseOfSetup {
  std::string setup;
  std::string component;
};
void PrintTo(const BaseOfSetup& base, std::ostream* out) {
  *out << base.setup;
}

class Watchdog : public testing::TestWithParam<BaseOfSetup> {};

TEST_P(Watchdog, TheBaseStandsWithinHalfASecondWhenItsCommanderVanishes) {
  const auto& [setup, component] = GetParam();
  Application application(setup, freePortOffset());
  ASSERT_TRUE(application.start(component));
  RemoteMobileBase base(nullptr, Ice::uncheckedCast<avm::OdometryPrx>(application.ice().stringToProxy(
                                     application.proxy(component, "Encoders"))));
  StampUs newest_us = -1;
  const auto next = [&]() -> std::optional<OdometrySample> {
    const auto batch = base.samplesSince(newest_us, 200ms);
    if (batch.samples.empty()) return std::nullopt;
    newest_us = batch.samples.back().stamp_us;
    return batch.samples.back();
  };
  const auto waitForSpeed = [&](auto wanted) {
    const auto deadline = std::chrono::steady_clock::now() + kPatience;
    while (std::chrono::steady_clock::now() < deadline) {
      const auto sample = next();
      if (sample && wanted(*sample)) return true;
    }
    return false;
  };
  for (const int fault : {SIGKILL, SIGSTOP}) {
    ComponentProcess commander("commander", {application.proxy(component, "Motors"), "0.3", "0.5"});
    ASSERT_TRUE(commander.waitUntilReady());
    ASSERT_TRUE(waitForSpeed([](const OdometrySample& s) { return s.v_mps > 0.25 && s.w_radps > 0.4; }));
    next();
    const auto vanished = std::chrono::steady_clock::now();
    commander.signal(fault);
    const StampUs vanished_us = newest_us;
    ASSERT_TRUE(waitForSpeed([](const OdometrySample& s) { return s.v_mps == 0.0 && s.w_radps == 0.0; }));
    const auto stood =
        std::chrono::duration_cast<std::chrono::milliseconds>(std::chrono::steady_clock::now() - vanished);
    // By the base's own clock: a test may be slow to look.
    EXPECT_LE(newest_us - vanished_us, 500'000) << "the commander got signal " << fault;
    report(setup + ": commander " + (fault == SIGKILL ? "killed" : "frozen") + ": the base stands after " +
           std::to_string((newest_us - vanished_us) / 1000) + " ms by its own clock, " +
           std::to_string(stood.count()) + " ms by the observer's");
    if (fault == SIGSTOP) {
      commander.signal(SIGCONT);
      EXPECT_TRUE(waitForSpeed([](const OdometrySample& s) { return s.v_mps > 0.25; })) << "it drives on";
    }
  }
}

std::vector<BaseOfSetup> bases() {
  std::vector<BaseOfSetup> found{{"sim", "simulator"}};
  for (const auto& setup : triedSetups()) {
    if (setup == "files") found.push_back({"files", "base_server"});
  }
  return found;
}
INSTANTIATE_TEST_SUITE_P(Setups, Watchdog, testing::ValuesIn(bases()),
                         [](const auto& which) { return which.param.setup; });

}  // namespace
}  // namespace vismem
