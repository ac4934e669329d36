/// @file Keeps strangers from making this process allocate without bound.
#pragma once

#include <cstddef>

namespace vismem {

/// Nothing that a component does needs more at once. Ice lets a few bytes of a request announce a sequence so
/// long that its own check of the length overflows; whatever the type of the elements, that is over 2 GB.
inline constexpr std::size_t kLargestAllocation = std::size_t{1} << 30;

/// From now on `new` for more bytes than this throws std::bad_alloc, in the whole process and its libraries:
/// where Ice reads parameters that becomes the answer to the call. Without a limit until then. *Thread-safe*.
void limitAllocations(std::size_t bytes);

}  // namespace vismem
