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

TEST(CovarianceKernels, SubtractAProductAndStaySymmetric) {
  std::mt19937_64 random(2);
  const auto symmetric = [&] {
    const Eigen::MatrixXd any = randomMatrix(kStride, random);
    return Eigen::MatrixXd(any + any.transpose());
  };
  for (const int n : {1, 4, 8, 15, 27, 32}) {
    for (const std::vector<int>& columns :
         {std::vector<int>{n - 1}, {0, n / 2, n / 3, n - 1, n / 4}, std::vector<int>(20, n / 2)}) {
      const auto count = static_cast<int>(columns.size());
      const Eigen::MatrixXd M = symmetric();
      const Eigen::MatrixXd before = symmetric();
      Eigen::MatrixXd P = before;
      Eigen::MatrixXd workspace(kStride, 2 * (count + kKernelRows));
      subtractProduct(P.data(), columns.data(), count, M.data(), workspace.data(), kStride, n);
      const auto product_with = [&](int i, int j) {
        double sum = 0.0;
        for (int k = 0; k < count; ++k) sum += product(M(j, k), before(i, columns[k]));
        return sum;
      };
      for (int i = 0; i < n; ++i) {
        for (int j = 0; j <= i; ++j) {
          double sum = 0.0;
          for (int k = 0; k < count; ++k) sum += product(before(j, columns[k]), product_with(i, k));
          EXPECT_EQ(P(i, j), before(i, j) - sum) << i << " " << j << " of " << n;
          EXPECT_EQ(P(j, i), P(i, j));
        }
      }
      EXPECT_EQ(P.topRightCorner(n, 1), before.topRightCorner(n, 1)) << "beyond n";
    }
  }
}

}  // namespace
}  // namespace vismem
