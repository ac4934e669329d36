/// @file A short list inside its owner. Pure.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <initializer_list>
#include <iterator>

namespace vismem {

/// A list of at most kMost values that needs no memory of its own. Values beyond that are left out. *Value.*
template <typename Value, std::size_t kMost>
class BoundedVector {
 public:
  using value_type = Value;
  using iterator = Value*;
  using const_iterator = const Value*;

  BoundedVector() = default;
  BoundedVector(std::initializer_list<Value> values) { assign(values.begin(), values.end()); }

  template <typename Iterator>
  void assign(Iterator first, Iterator last) {
    size_ = std::min(kMost, static_cast<std::size_t>(std::distance(first, last)));
    std::copy_n(first, size_, values_.begin());
  }
  void push_back(const Value& value) {
    if (size_ < kMost) values_[size_++] = value;
  }
  void clear() { size_ = 0; }

  static constexpr std::size_t capacity() { return kMost; }
  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  Value* data() { return values_.data(); }
  const Value* data() const { return values_.data(); }
  Value& operator[](std::size_t i) { return values_[i]; }
  const Value& operator[](std::size_t i) const { return values_[i]; }
  const Value& front() const { return values_[0]; }
  iterator begin() { return data(); }
  iterator end() { return data() + size_; }
  const_iterator begin() const { return data(); }
  const_iterator end() const { return data() + size_; }
  friend bool operator==(const BoundedVector& a, const BoundedVector& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end());
  }

 private:
  std::array<Value, kMost> values_{};
  std::size_t size_ = 0;
};

}  // namespace vismem
