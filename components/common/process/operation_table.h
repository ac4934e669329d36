/// @file Which operations of the Slice files only read. Made from interfaces/operations.txt. No Ice.
#pragma once

#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace vismem {

struct InterfaceOperation {
  std::string_view interface;  ///< type id of the interface that declares it: "::avm::Base"
  std::string_view operation;
  bool reading = false;
};

/// Every operation of every Slice file.
std::span<const InterfaceOperation> interfaceOperations();

/// The reading operations of an object, and what every Ice object answers (ice_ping, ice_isA, ice_id,
/// ice_ids).
/// @param type_ids of all its interfaces, inherited ones included, as ice_ids() gives them.
std::set<std::string, std::less<>> readingOperations(const std::vector<std::string>& type_ids);

}  // namespace vismem
