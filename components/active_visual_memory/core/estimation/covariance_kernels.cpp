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
constexpr int kColumns = 4;  // of a product at once

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

/// The columns of a product: sums[c] = sum over k of factors[k * step + c] * column k of the panel.
VISMEM_INLINE void multiply(Rows* sums, const double* panel, const double* factors, std::ptrdiff_t step,
                            int count) {
  for (int c = 0; c < kColumns; ++c) sums[c] = Rows{};
  for (int k = 0; k < count; ++k) {
    Rows rows;
    std::memcpy(&rows, panel + kKernelRows * k, sizeof rows);
    for (int c = 0; c < kColumns; ++c) sums[c] += factors[k * step + c] * rows;
  }
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

VISMEM_ALL_WIDTHS void subtractProduct(double* P, const int* columns, int count, const double* M,
                                       double* workspace, std::ptrdiff_t stride, int n) {
  // Panels of kKernelRows rows, one behind the other, each column by column: of A, and of A M.
  const std::ptrdiff_t size = static_cast<std::ptrdiff_t>(kKernelRows) * count;
  double* const A = workspace;
  double* const AM = A + paddedRows(n) / kKernelRows * size;
  Rows sums[kColumns];
  for (int i = 0; i < n; i += kKernelRows) {
    double* const panel = A + i / kKernelRows * size;
    for (int k = 0; k < count; ++k) {
      double* const to = panel + kKernelRows * k;
      std::memcpy(to, P + columns[k] * stride + i, sizeof(Rows));
      for (int r = n - i; r < kKernelRows; ++r) to[r] = 0.0;
    }
    for (int j = 0; j < count; j += kColumns) {
      multiply(sums, panel, M + j, stride, count);
      std::memcpy(AM + i / kKernelRows * size + kKernelRows * j, sums, sizeof sums);
    }
  }
  for (int j = 0; j < n; j += kColumns) {
    const int diagonal = j / kKernelRows;
    const double* const factors = A + diagonal * size + j % kKernelRows;
    for (int i = diagonal; i * kKernelRows < n; ++i) {
      multiply(sums, AM + i * size, factors, kKernelRows, count);
      for (int c = 0; c < kColumns; ++c) add(P + (j + c) * stride + i * kKernelRows, -sums[c]);
    }
  }
  // The upper triangle, in blocks that fit the cache.
  for (int j = 0; j < n; j += kKernelRows) {
    for (int r = j; r < paddedRows(n); ++r) {
      for (int c = j; c < std::min(j + kKernelRows, r); ++c) P[r * stride + c] = P[c * stride + r];
    }
  }
}

}  // namespace vismem
