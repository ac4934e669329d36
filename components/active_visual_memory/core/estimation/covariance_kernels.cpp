#include "active_visual_memory/core/estimation/covariance_kernels.h"

#include <algorithm>
#include <cstring>

// A copy for each width of vectors, chosen at start. Sanitizers are not ready that early.
#if defined(__x86_64__) && !defined(__clang__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__SANITIZE_THREAD__)
#define VISMEM_ALL_WIDTHS __attribute__((target_clones("avx512f", "avx2", "default")))
#else
#define VISMEM_ALL_WIDTHS
#endif
#define VISMEM_INLINE inline __attribute__((always_inline))

namespace vismem {
namespace {

using Rows = double __attribute__((vector_size(8 * kKernelRows)));
constexpr int kColumns = 4;  // of P at once

VISMEM_INLINE void add(double* to, const Rows& more) {
  Rows rows;
  std::memcpy(&rows, to, sizeof rows);
  rows += more;
  std::memcpy(to, &rows, sizeof rows);
}

VISMEM_INLINE void addTo(Rows& sum, double factor, const double* column) {
  Rows rows;
  std::memcpy(&rows, column, sizeof rows);
  sum += factor * rows;
}

}  // namespace

VISMEM_ALL_WIDTHS void addColumns(double* to, int rows, const ScaledColumn* columns, int count) {
  int i = 0;
  for (; i + kKernelRows < rows; i += 2 * kKernelRows) {
    Rows low{};
    Rows high{};
    for (int k = 0; k < count; ++k) {
      addTo(low, columns[k].factor, columns[k].column + i);
      addTo(high, columns[k].factor, columns[k].column + i + kKernelRows);
    }
    add(to + i, low);
    add(to + i + kKernelRows, high);
  }
  if (i >= rows) return;
  Rows sum{};
  for (int k = 0; k < count; ++k) addTo(sum, columns[k].factor, columns[k].column + i);
  add(to + i, sum);
}

VISMEM_ALL_WIDTHS void subtractSquare(double* P, const double* W, double* panels, std::ptrdiff_t stride,
                                      int n, int m) {
  // Blocks of kKernelRows rows of W, one behind the other, each column by column.
  double* to = panels;
  for (int i = 0; i < n; i += kKernelRows) {
    for (int k = 0; k < m; ++k, to += kKernelRows) std::memcpy(to, W + k * stride + i, sizeof(Rows));
  }
  for (int j = 0; j < n; j += kColumns) {
    const int diagonal = j - j % kKernelRows;
    const double* factors = panels + static_cast<std::ptrdiff_t>(diagonal) * m + j % kKernelRows;
    for (int i = diagonal; i < n; i += kKernelRows) {
      Rows sums[kColumns] = {};
      const double* panel = panels + static_cast<std::ptrdiff_t>(i) * m;
      for (int k = 0; k < m; ++k) {
        Rows rows;
        std::memcpy(&rows, panel + kKernelRows * k, sizeof rows);
        for (int c = 0; c < kColumns; ++c) sums[c] -= factors[kKernelRows * k + c] * rows;
      }
      for (int c = 0; c < kColumns; ++c) add(P + (j + c) * stride + i, sums[c]);
    }
  }
  // The upper triangle, in blocks that fit the cache.
  for (int j = 0; j < n; j += kKernelRows) {
    for (int i = j; i < n; i += kKernelRows) {
      for (int c = j; c < j + kKernelRows; ++c) {
        for (int r = std::max(i, c + 1); r < i + kKernelRows; ++r) P[r * stride + c] = P[c * stride + r];
      }
    }
  }
}

}  // namespace vismem
