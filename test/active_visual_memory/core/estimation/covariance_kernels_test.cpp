// Tests M6, M7.
#include "active_visual_memory/core/estimation/covariance_kernels.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <random>
#include <vector>

namespace vismem {
namespace {

constexpr int kStride = 40;

Eigen::MatrixXd randomMatrix(int columns, std::mt19937_64& random) {
  std::normal_distribution<double> normal(0.0, 1.0);
  return Eigen::MatrixXd::NullaryExpr(kStride, columns, [&] { return normal(random); });
}

// A fused operation would round once only.
double product(double a, double b) {
  volatile const double rounded = a * b;
  return rounded;
}

TEST(CovarianceKernels, SumColumnsInTheirOrder) {
  std::mt19937_64 random(1);
  const Eigen::MatrixXd from = randomMatrix(13, random);
  for (const int rows : {1, 7, 8, 9, 16, 17, 31}) {
    std::vector<ScaledColumn> columns;
    for (int k = 0; k < 13; ++k) columns.push_back({0.3 * k - 1.0, from.col(k).data()});
    Eigen::VectorXd to = from.col(3);
    addColumns(to.data(), rows, columns.data(), static_cast<int>(columns.size()));
    for (int i = 0; i < rows; ++i) {
      double sum = 0.0;
      for (const ScaledColumn& one : columns) sum += product(one.factor, one.column[i]);
      EXPECT_EQ(to[i], from(i, 3) + sum) << i << " of " << rows;
    }
    EXPECT_EQ(to.tail(kStride - paddedRows(rows)), from.col(3).tail(kStride - paddedRows(rows))) << rows;
  }
}

TEST(CovarianceKernels, SubtractASquareAndStaySymmetric) {
  std::mt19937_64 random(2);
  for (const int n : {1, 4, 8, 15, 27, 32}) {
    for (const int m : {1, 5, 20}) {
      Eigen::MatrixXd W = randomMatrix(m, random);
      W.middleRows(n, kKernelRows).setZero();
      const Eigen::MatrixXd any = randomMatrix(kStride, random);
      const Eigen::MatrixXd before = any + any.transpose();
      Eigen::MatrixXd P = before;
      Eigen::MatrixXd workspace(kStride, m);
      subtractSquare(P.data(), W.data(), workspace.data(), kStride, n, m);
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j <= i; ++j) {
          double sum = 0.0;
          for (int k = 0; k < m; ++k) sum -= product(W(j, k), W(i, k));
          EXPECT_EQ(P(i, j), before(i, j) + sum) << i << " " << j << " of " << n;
          EXPECT_EQ(P(j, i), P(i, j));
        }
      }
      EXPECT_EQ(P.topRightCorner(n, 1), before.topRightCorner(n, 1)) << "beyond n";
    }
  }
}

}  // namespace
}  // namespace vismem
