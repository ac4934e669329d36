/// @file The values of a component that may change while it runs. No Ice.
#pragma once

#include <functional>
#include <mutex>
#include <string>
#include <vector>

namespace vismem {

struct RuntimeParameter {
  std::string name;  ///< "Overlay.Rate_hz"
  std::string unit;  ///< "Hz"; empty for a plain number
  double minimum = 0.0;
  double maximum = 0.0;
  bool whole = false;       ///< only whole numbers
  double configured = 0.0;  ///< at the start
  std::string description;  ///< what it does, one sentence for people
};

/// The list of a component's parameters with their present values. *Thread-safe*: changes exclude each other.
class ParameterTable {
 public:
  /// Hands a checked value to its owner, through the owner's queue. @return empty if accepted, else why not.
  using Apply = std::function<std::string(double value)>;

  struct Entry {
    RuntimeParameter parameter;
    double value = 0.0;
  };
  struct Outcome {
    enum class Kind { kAccepted, kInvalid, kRefused };
    Kind kind = Kind::kAccepted;
    std::string reason;  ///< empty when accepted
  };

  /// Before the component serves. @throws std::logic_error for a name that is listed already, or a configured
  /// value outside the range.
  void add(RuntimeParameter parameter, Apply apply);
  std::vector<Entry> list() const;
  /// kInvalid: unknown name, or a value that is not finite, not in the range or not whole. kRefused: by the
  /// owner.
  Outcome set(const std::string& name, double value);

 private:
  struct Row {
    Entry entry;
    Apply apply;
  };
  std::mutex changes_;         ///< held while an owner is asked
  mutable std::mutex values_;  ///< guards the rows' values
  std::vector<Row> rows_;
};

}  // namespace vismem
