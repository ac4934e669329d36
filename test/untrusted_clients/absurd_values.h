/// @file Well-formed parameters with absurd values, drawn from a seed.
#pragma once

#include <random>
#include <string>

#include "untrusted_clients/ice_wire.h"
#include "untrusted_clients/slice_model.h"

namespace vismem::test {

/// Encodes values of any type of the interfaces: limits and special values of every number, strings from
/// empty to 10 MB, enumerators that do not exist, null and unknown classes, sequences that announce more than
/// they hold.
class AbsurdValues {
 public:
  AbsurdValues(const SliceModel& model, std::mt19937_64& random) : model_(model), random_(random) {}

  /// The parameters of one call, in order, as they stand inside an encapsulation.
  std::string parametersOf(const SliceOperation& operation);

 private:
  void add(WireBytes& bytes, const std::string& type, int depth);
  void addClass(WireBytes& bytes, const SliceType& type, int depth);
  void addSequence(WireBytes& bytes, const SliceType& type, int depth);
  double real();
  std::int64_t whole();
  std::string text();
  int below(int bound) { return static_cast<int>(random_() % static_cast<std::uint64_t>(bound)); }

  const SliceModel& model_;
  std::mt19937_64& random_;
};

}  // namespace vismem::test
