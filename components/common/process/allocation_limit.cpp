#include "common/process/allocation_limit.h"

#include <atomic>
#include <cstdlib>
#include <limits>
#include <new>

namespace {

// Set before any constructor runs, because they allocate.
constinit std::atomic<std::size_t> g_largest{std::numeric_limits<std::size_t>::max()};

}  // namespace

namespace vismem {

void limitAllocations(std::size_t bytes) {
  g_largest.store(bytes, std::memory_order_relaxed);
}

}  // namespace vismem

// The plain form serves arrays and nothrow as well; aligned ones are left alone, no Ice type needs them.
void* operator new(std::size_t size) {
  if (size <= g_largest.load(std::memory_order_relaxed)) {
    if (void* memory = std::malloc(size == 0 ? 1 : size)) return memory;
  }
  throw std::bad_alloc();
}

void operator delete(void* memory) noexcept {
  std::free(memory);
}

void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
