#include "common/process/operation_table.h"

#include <algorithm>
#include <functional>

namespace vismem {
namespace {

constexpr InterfaceOperation kOperations[] = {
#include <operations.inc>
};

}  // namespace

std::span<const InterfaceOperation> interfaceOperations() {
  return kOperations;
}

std::set<std::string, std::less<>> readingOperations(const std::vector<std::string>& type_ids) {
  std::set<std::string, std::less<>> reading{"ice_ping", "ice_isA", "ice_id", "ice_ids"};
  for (const InterfaceOperation& row : kOperations) {
    if (row.reading && std::find(type_ids.begin(), type_ids.end(), row.interface) != type_ids.end())
      reading.emplace(row.operation);
  }
  return reading;
}

}  // namespace vismem
