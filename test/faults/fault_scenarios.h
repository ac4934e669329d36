/// @file Faults of a running application and the required behaviour (see C3).
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "support/application.h"

namespace vismem {

/// Maximum time after a component's return until the application is whole. Sanitizers need more.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr std::chrono::milliseconds kWholeWithin{10'000};
#else
inline constexpr std::chrono::milliseconds kWholeWithin{2000};
#endif

/// A setup with its additional inputs, at ports of its own. Empty with a message if an input (a recording) is
/// missing.
struct PreparedSetup {
  std::string name;
  ExtraArguments extra;
  std::string missing;
};
PreparedSetup prepareSetup(const std::string& setup);
/// The tested setups: sim, replay, files.
std::vector<std::string> triedSetups();

/// The direct clients of a component, from the proxies in their status: (component, its peer's name).
using Dependents = std::vector<std::pair<std::string, std::string>>;
Dependents dependentsOf(Application& application, const std::string& victim);

/// Prints one line "faults: ..." with a measurement, for docs/resilience.md.
void report(const std::string& what);

/// Kills each component in turn and starts it again: the others report this and continue, and the application
/// is whole in time.
void killEach(Application& application, std::chrono::milliseconds limit);
/// Freezes each component for a time and continues it.
void freezeEach(Application& application, std::chrono::milliseconds duration,
                std::chrono::milliseconds limit);
/// Kills and freezes at random, several at a time, until `faults` are done; after every tenth all return and
/// must be whole in time.
void randomFaults(Application& application, int faults, std::uint64_t seed, std::chrono::milliseconds limit);
/// Each component ends cleanly when asked to while all others are frozen: its peers as well as its clients.
void stopEachBesideFrozenOnes(Application& application);

}  // namespace vismem
