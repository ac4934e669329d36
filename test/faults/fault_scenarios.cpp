#include "faults/fault_scenarios.h"

#include <csignal>
#include <filesystem>
#include <iostream>
#include <random>
#include <thread>

#include "common/config/properties.h"
#include "common/process/setup.h"
#include "support/build_paths.h"
#include "support/data_folder.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;

/// The invocation timeout (3 s), a pause between tries, and some time on a busy machine.
constexpr auto kSaysLostWithin = 7s;

/// The ports of a text of endpoints or a proxy: the numbers after "-p ".
std::vector<std::string> portsOf(const std::string& text) {
  std::vector<std::string> ports;
  for (auto place = text.find("-p "); place != std::string::npos; place = text.find("-p ", place + 1)) {
    ports.push_back(text.substr(place + 3, text.find_first_not_of("0123456789", place + 3) - place - 3));
  }
  return ports;
}

bool shareAPort(const std::string& endpoints, const std::string& proxy) {
  for (const auto& port : portsOf(proxy)) {
    for (const auto& other : portsOf(endpoints)) {
      if (port == other) return true;
    }
  }
  return false;
}

std::string seconds(std::chrono::milliseconds duration) {
  return std::to_string(duration.count()) + " ms";
}

/// Those that neither are nor need the victim: they must not notice.
bool isUnconcerned(Application& application, const std::string& name, const std::string& victim) {
  const auto report = application.status(name);
  return name != victim && report && report->peers.empty();
}

void expectWhole(Application& application, const std::string& what, std::chrono::milliseconds limit) {
  const auto whole = application.waitUntilWhole(limit);
  EXPECT_TRUE(whole) << what << ": not whole within " << seconds(limit) << ": " << application.why() << "\n"
                     << application.logs();
  if (whole) {
    report(what + ": whole after " + seconds(*whole));
  } else {
    application.waitUntilWhole(20s);  // The next fault shall show by itself.
  }
}

void expectOthersSaySo(Application& application, const std::string& victim, const Dependents& dependents,
                       const std::vector<std::string>& unconcerned) {
  const auto begin = Clock::now();
  for (const auto& [name, peer] : dependents) {
    EXPECT_TRUE(application.says(name, RunState::kDegraded, peer + " is lost", kSaysLostWithin))
        << victim << " is away";
  }
  if (!dependents.empty()) {
    report(victim + " away: reported by its clients after " +
           seconds(std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - begin)));
  }
  for (const auto& name : unconcerned) {
    EXPECT_TRUE(application.says(name, RunState::kRunning, "", 2s)) << victim << " is no concern of " << name;
  }
}

std::vector<std::string> unconcernedBy(Application& application, const std::string& victim) {
  std::vector<std::string> names;
  for (const auto& name : application.names()) {
    if (isUnconcerned(application, name, victim)) names.push_back(name);
  }
  return names;
}

}  // namespace

PreparedSetup prepareSetup(const std::string& setup) {
  PreparedSetup prepared{setup, {}, ""};
  if (setup == "replay") {
    const fs::path folder = dataFolder() / "nao_field_2009";
    if (!fs::exists(folder / "nao_field_2009.bag")) {
      prepared.missing = "no recording nao_field_2009 in " + dataFolder().string() + ": set AVM_DATA";
    }
    // Ten times as fast, so that images come often enough to measure with; over and over: time goes back.
    prepared.extra["replay_server"] = {"--ReplayServer.File=" + (folder / "nao_field_2009.bag").string(),
                                       "--ReplayServer.Rate=10", "--ReplayServer.Loop=yes"};
    const std::string palette = std::string(VISMEM_SOURCE_DIR) + "/cfg/maps/field.palette";
    prepared.extra["active_visual_memory"] = {"--ActiveVisualMemory.Palette=" + palette};
    prepared.extra["localization"] = {"--Localization.Map=" + (folder / "map.csv").string(),
                                      "--Localization.Palette=" + palette};
  }
  return prepared;
}

std::vector<std::string> triedSetups() {
  std::vector<std::string> setups;
  for (const char* setup : {"sim", "replay", "files", "humanoid"}) {
    if (fs::is_directory(fs::path(VISMEM_SOURCE_DIR) / "cfg" / setup)) setups.emplace_back(setup);
  }
  return setups;
}

Dependents dependentsOf(Application& application, const std::string& victim) {
  Dependents dependents;
  for (const auto& name : application.names()) {
    if (name == victim) continue;
    const auto report = application.status(name);
    if (!report) continue;
    for (const auto& peer : report->peers) {
      if (shareAPort(application.endpoints(victim), peer.proxy)) dependents.emplace_back(name, peer.name);
    }
  }
  return dependents;
}

void report(const std::string& what) {
  std::cout << "faults: " << what << std::endl;
}

void killEach(Application& application, std::chrono::milliseconds limit) {
  for (const auto& victim : application.names()) {
    const auto dependents = dependentsOf(application, victim);
    const auto unconcerned = unconcernedBy(application, victim);
    application.kill(victim);
    expectOthersSaySo(application, victim, dependents, unconcerned);
    ASSERT_TRUE(application.start(victim));
    expectWhole(application, victim + " killed and started again", limit);
  }
}

void freezeEach(Application& application, std::chrono::milliseconds duration,
                std::chrono::milliseconds limit) {
  for (const auto& victim : application.names()) {
    const auto dependents = dependentsOf(application, victim);
    const auto unconcerned = unconcernedBy(application, victim);
    const auto until = Clock::now() + duration;
    application.freeze(victim);
    // A short freeze ends before anybody's patience: then it need not be noticed.
    if (duration > kSaysLostWithin) expectOthersSaySo(application, victim, dependents, unconcerned);
    do {
      for (const auto& name : application.names()) {
        if (name != victim) {
          EXPECT_TRUE(application.status(name)) << name << " does not answer beside " << victim;
        }
      }
      std::this_thread::sleep_for(50ms);
    } while (Clock::now() < until);
    application.goOn(victim);
    expectWhole(application, victim + " frozen for " + seconds(duration), limit);
  }
}

void randomFaults(Application& application, int faults, std::uint64_t seed, std::chrono::milliseconds limit) {
  report("random faults with seed " + std::to_string(seed));
  std::mt19937_64 engine(seed);
  const auto below = [&](std::uint64_t n) { return engine() % n; };
  const auto& names = application.names();
  const auto bringBack = [&](const std::string& name) {
    if (!application.runs(name)) {
      ASSERT_TRUE(application.start(name)) << "seed " << seed;
    } else if (application.isFrozen(name)) {
      application.goOn(name);
    }
  };
  int kills = 0;
  for (int fault = 1; fault <= faults; ++fault) {
    const std::string& victim = names[below(names.size())];
    if (!application.runs(victim) || application.isFrozen(victim)) {
      bringBack(victim);
    }
    if (below(2) == 0) {
      application.kill(victim);
      ++kills;
    } else {
      application.freeze(victim);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(below(below(4) == 0 ? 5000 : 800)));
    if (below(2) == 0) bringBack(names[below(names.size())]);
    if (fault % 10 != 0 && fault != faults) continue;
    for (const auto& name : names) bringBack(name);
    expectWhole(application,
                "random faults, seed " + std::to_string(seed) + ", after " + std::to_string(fault) + " (" +
                    std::to_string(kills) + " kills)",
                limit);
    if (testing::Test::HasFailure()) return;
  }
}

void stopEachBesideFrozenOnes(Application& application) {
  for (const auto& victim : application.names()) {
    for (const auto& name : application.names()) {
      if (name != victim) application.freeze(name);
    }
    // Calls to the frozen ones are under way, and theirs are held here.
    std::this_thread::sleep_for(300ms);
    const auto begin = Clock::now();
    application.process(victim).signal(SIGTERM);
    const auto code = application.process(victim).waitForExit(kPatience);
    const auto spent = std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - begin);
    EXPECT_EQ(code, 0) << victim << ":\n" << application.process(victim).error();
    report(victim + " asked to stop while all others are frozen: ended after " + seconds(spent));
    for (const auto& name : application.names()) {
      if (name != victim) application.goOn(name);
    }
    ASSERT_TRUE(application.start(victim));
    EXPECT_TRUE(application.waitUntilWhole(20s)) << application.why();
  }
}

}  // namespace vismem
