/// @file Immutable values for readers in other threads, without an allocation each. Pure.
#pragma once

#include <memory>
#include <vector>

namespace vismem {

/// Values that are published by `shared_ptr`. One that no reader holds any more is written again, with the
/// memory of its parts. *Single-threaded* (owner: the publisher); readers may let go of a value in any
/// thread.
template <typename Value>
class Snapshots {
 public:
  /// A value that nobody reads, to be overwritten whole. Invariant: readers get it as `shared_ptr<const
  /// Value>`, so that none can become a reader of a value that nobody holds.
  std::shared_ptr<Value> next() {
    for (const std::shared_ptr<Value>& value : values_) {
      // The copy orders the writes to come after the last reader's release of the value.
      if (value.use_count() == 1) return value;
    }
    return values_.emplace_back(std::make_shared<Value>());
  }

 private:
  std::vector<std::shared_ptr<Value>> values_;
};

}  // namespace vismem
