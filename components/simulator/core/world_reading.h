/// @file What libsdformat makes of a text. Includes it: for world_loader.cpp only.
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
  /// @param find_include gives the folder with a model.config, or the file, that a uri names; empty if none.
  explicit SdfReader(std::function<std::string(const std::string& uri)> find_include);

  /// What libsdformat throws is a complaint.
  std::unique_ptr<Reading> read(const std::string& xml) const;
  /// Why it gives no world; empty if it gives one. Takes half as long as read.
  std::string refusal(const std::string& xml);

 private:
  std::function<std::string(const std::string&)> find_include_;
  sdf::SDFPtr scratch_;
};

}  // namespace vismem
