/// @file What the tests of resilience do to a running application, and what must be true then (SPEC C3,
/// DESIGN 10).
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "support/application.h"

namespace vismem {

/// The application is whole again this soon after a component's return. Sanitizers slow everything down.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr std::chrono::milliseconds kWholeWithin{10'000};
#else
inline constexpr std::chrono::milliseconds kWholeWithin{2000};
#endif

/// A setup with what it needs beside its configuration, at ports of its own. Empty with a message when that
/// is not there (a recording).
struct PreparedSetup {
  std::string name;
  ExtraArguments extra;
  std::string missing;
};
PreparedSetup prepareSetup(const std::string& setup);
/// The setups whose components are there to be tried: sim, replay, files.
std::vector<std::string> triedSetups();

/// Whom a component's absence concerns directly, by the proxies that they say they have: (component, its
/// peer's name).
using Dependents = std::vector<std::pair<std::string, std::string>>;
Dependents dependentsOf(Application& application, const std::string& victim);

/// Prints one line "faults: ..." of what was measured, for docs/resilience.md.
void report(const std::string& what);

/// Kills each component in turn and starts it again: the others say so and go on, and all is whole in time.
void killEach(Application& application, std::chrono::milliseconds limit);
/// Freezes each for the time and lets it go on.
void freezeEach(Application& application, std::chrono::milliseconds duration,
                std::chrono::milliseconds limit);
/// Kills and freezes at random, several at a time, until `faults` are done; after every tenth all return and
/// must be whole in time.
void randomFaults(Application& application, int faults, std::uint64_t seed, std::chrono::milliseconds limit);
/// Each component ends cleanly when asked to while all others are frozen: its peers as well as its clients.
void stopEachBesideFrozenOnes(Application& application);

}  // namespace vismem
