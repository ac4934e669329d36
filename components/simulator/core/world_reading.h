/// @file Reading of a text by libsdformat. Includes libsdformat: for world_loader.cpp only.
#pragma once

#include <functional>
#include <memory>
#include <sdf/Root.hh>
#include <sdf/SDFImpl.hh>
#include <string>
#include <vector>

namespace vismem {

struct Reading {
  sdf::Root root;
  std::vector<std::string> complaints;
  bool hasWorld() const { return root.WorldCount() > 0; }
};

/// *Single-threaded.*
class SdfReader {
 public:
  /// @param find_include returns the folder with a model.config, or the file, of a uri; empty if none.
  explicit SdfReader(std::function<std::string(const std::string& uri)> find_include);

  /// Reads a world. Exceptions of libsdformat become errors of the reading.
  std::unique_ptr<Reading> read(const std::string& xml) const;
  /// Reason why libsdformat rejects a text; empty if it accepts it. Takes half as long as read.
  std::string refusal(const std::string& xml);

 private:
  std::function<std::string(const std::string&)> find_include_;
  sdf::SDFPtr scratch_;
};

}  // namespace vismem
