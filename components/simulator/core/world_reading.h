/// @file What libsdformat makes of a text. Includes it: for world_loader.cpp only.
#pragma once

#include <functional>
#include <memory>
#include <sdf/Root.hh>
#include <string>
#include <vector>

namespace vismem {

struct Reading {
  sdf::Root root;
  std::vector<std::string> complaints;
  bool hasWorld() const { return root.WorldCount() > 0; }
};

/// @param find_include gives the folder with a model.config, or the file, that a uri names; empty if none.
/// Throws nothing of libsdformat's: what it throws is a complaint.
std::unique_ptr<Reading> readSdf(const std::string& xml,
                                 const std::function<std::string(const std::string& uri)>& find_include);

}  // namespace vismem
