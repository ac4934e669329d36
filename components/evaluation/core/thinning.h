/// @file A long row of samples in bounded memory. Pure.
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace vismem {

/// Keeps at most so many samples of a row, evenly spaced: when it is full, every second one goes, and from
/// then on half as many come in. The newest is always kept, as the last one. *Value.*
class Thinning {
 public:
  /// @param capacity at least 2.
  explicit Thinning(std::size_t capacity) : capacity_(capacity) {}

  /// @param kept the row; changed by this class only.
  template <typename T>
  void add(std::vector<T>& kept, T sample) {
    if (!last_stays_ && !kept.empty()) kept.pop_back();
    kept.push_back(std::move(sample));
    last_stays_ = added_ % stride_ == 0;
    ++added_;
    if (kept.size() > capacity_) halve(kept);
  }

  /// One of so many samples is kept.
  std::size_t stride() const { return stride_; }

 private:
  template <typename T>
  void halve(std::vector<T>& kept) {
    const std::size_t last = kept.size() - 1;
    std::size_t count = 0;
    for (std::size_t i = 0; i <= last; ++i) {
      if (i % 2 != 0 && i != last) continue;
      if (count != i) kept[count] = std::move(kept[i]);
      ++count;
    }
    kept.resize(count);
    stride_ *= 2;
    last_stays_ = (added_ - 1) % stride_ == 0;
  }

  std::size_t capacity_;
  std::size_t stride_ = 1;
  std::size_t added_ = 0;
  bool last_stays_ = true;
};

}  // namespace vismem
