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

// All forms, because those of a sanitizer do not call each other. Aligned forms are not replaced: no type of
// Ice needs them.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  if (size > g_largest.load(std::memory_order_relaxed)) return nullptr;
  return std::malloc(size == 0 ? 1 : size);
}
void* operator new(std::size_t size) {
  if (void* memory = operator new(size, std::nothrow)) return memory;
  throw std::bad_alloc();
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  return operator new(size, std::nothrow);
}
void* operator new[](std::size_t size) {
  return operator new(size);
}

void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, const std::nothrow_t&) noexcept {
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, const std::nothrow_t&) noexcept {
  std::free(memory);
}
