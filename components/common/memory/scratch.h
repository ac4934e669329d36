/// @file Memory for temporary values of one step. Pure.
#pragma once

#include <cstddef>
#include <memory>
#include <memory_resource>

namespace vismem {

/// Memory for the temporary lists of one step: given out one piece after the other, and used again after
/// `release`. Only a step that needs more than the reserved size allocates. *Single-threaded* (owner: the
/// class whose step it serves).
class Scratch {
 public:
  explicit Scratch(std::size_t bytes = 1U << 20)
      : buffer_(std::make_unique_for_overwrite<std::byte[]>(bytes)), resource_(buffer_.get(), bytes) {}

  /// Ends the life of all that was given out.
  void release() { resource_.release(); }
  std::pmr::memory_resource* resource() { return &resource_; }

 private:
  std::unique_ptr<std::byte[]> buffer_;
  std::pmr::monotonic_buffer_resource resource_;
};

}  // namespace vismem
