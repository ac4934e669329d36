/// @file The drivers of a port, by their names in configurations. Pure.
#pragma once

#include <cassert>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/config/config_reader.h"
#include "common/config/nearest_name.h"
#include "common/config/text_format.h"

namespace vismem {

/// Maps the name of a driver to its factory. A server fills it explicitly, with one function per port:
///
///   void registerCameraDrivers(DriverRegistry<FrameSource>& registry) {
///     registry.add("files", "images, videos and network streams", makeFileCamera);
///   }
///   ...
///   ConfigReader group = config.group("CameraServer.cameraA");
///   std::unique_ptr<FrameSource> camera = registry.make(group);   // reads CameraServer.cameraA.Driver
///   if (!group.good()) return nullptr;
///
/// The linker would drop self-registering globals from static libraries. *Single-threaded* while it is
/// filled; const functions are then thread-safe.
template <typename Port>
class DriverRegistry {
 public:
  /// Reads the driver's own keys from the group and makes the port. The reader collects all problems and
  /// returns defaults for invalid values. A factory may return nullptr when the reader is not good(). The
  /// port's start() opens the device, not the factory.
  using Factory = std::function<std::unique_ptr<Port>(ConfigReader& group)>;

  /// @param name its name in configurations: "files"; unique.
  /// @param summary a few words for people.
  void add(std::string name, std::string summary, Factory factory) {
    const bool is_new =
        drivers_.emplace(std::move(name), Driver{std::move(summary), std::move(factory)}).second;
    assert(is_new && "two drivers of one name");
    static_cast<void>(is_new);
  }

  /// Makes the driver that a key of the group names.
  /// @return nullptr with a problem in the reader that lists the known drivers if the key is absent or
  /// unknown. The group's other keys then count as known, because only the driver could check them.
  std::unique_ptr<Port> make(ConfigReader& group, std::string_view key = "Driver") const {
    group.describe(basic(key, "--help lists its keys when it is named, too"));
    const std::string name = group.requiredText(key, "a driver: " + namesText());
    const auto driver = drivers_.find(name);
    if (driver != drivers_.end()) return driver->second.factory(group);
    group.known("*");
    if (!name.empty()) {
      const auto all = names();
      group.problem(key, "unknown driver" + suggestion(name, {all.begin(), all.end()}) +
                             "; must be one of: " + namesText());
    }
    return nullptr;
  }

  /// Sorted.
  std::vector<std::string> names() const {
    std::vector<std::string> all;
    for (const auto& [name, driver] : drivers_) all.push_back(name);
    return all;
  }
  /// Summary of a registered driver.
  const std::string& summary(const std::string& name) const { return drivers_.at(name).summary; }

 private:
  struct Driver {
    std::string summary;
    Factory factory;
  };

  std::string namesText() const { return drivers_.empty() ? "none is built in" : joined(names(), ", "); }

  std::map<std::string, Driver> drivers_;
};

}  // namespace vismem
