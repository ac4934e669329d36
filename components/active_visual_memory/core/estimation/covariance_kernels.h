/// @file Dense loops of the map filter, for the widest vectors of the processor. Pure. See M6, M7.
/// Each entry is the same sum in the same order for any width of the vectors: all processors give the same
/// bits.
#pragma once

#include <cstddef>

namespace vismem {

/// Rows that a kernel handles at once: it reads and writes up to the next multiple, counted from the first
/// row.
inline constexpr int kKernelRows = 8;
constexpr int paddedRows(int rows) {
  return (rows + kKernelRows - 1) / kKernelRows * kKernelRows;
}

/// A column of a matrix with its factor.
struct ScaledColumn {
  double factor = 0.0;
  const double* column = nullptr;
};

/// to += sum of factor * column of `count` columns, over `rows` rows.
void addColumns(double* to, int rows, const ScaledColumn* columns, int count);

/// P -= W W^T. @param P n x n, symmetric. @param W n x m. Both column by column, `stride` apart, a multiple
/// of kKernelRows and at least n; W is 0 in the rows from n to the next multiple.
/// @param workspace  as large as m columns of W.
void subtractSquare(double* P, const double* W, double* workspace, std::ptrdiff_t stride, int n, int m);

}  // namespace vismem
