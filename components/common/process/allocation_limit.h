/// @file An upper bound of single allocations, against requests that announce huge sequences.
#pragma once

#include <cstddef>

namespace vismem {

/// Above every allocation of a component [bytes]. A request of a few bytes can announce a sequence whose
/// length overflows the check of Ice; for any element type that is over 2 GB.
inline constexpr std::size_t kLargestAllocation = std::size_t{1} << 30;

/// From now on `new` for more bytes throws std::bad_alloc, in the whole process and its libraries. While Ice
/// reads parameters, this exception becomes the answer to the call. There is no limit before the first call.
/// *Thread-safe*.
void limitAllocations(std::size_t bytes);

}  // namespace vismem
