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

/// P -= A M A^T, where A are columns of P.
/// @param P          n x n, symmetric; columns `stride` apart, a multiple of kKernelRows and at least n.
/// @param columns    `count` indices of the columns of A.
/// @param M          count x count, symmetric; columns `stride` apart, read up to paddedRows(count).
/// @param workspace  of 2 * stride * (count + kKernelRows).
void subtractProduct(double* P, const int* columns, int count, const double* M, double* workspace,
                     std::ptrdiff_t stride, int n);

}  // namespace vismem
