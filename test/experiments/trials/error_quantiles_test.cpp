#include "experiments/trials/error_quantiles.h"

#include <gtest/gtest.h>

#include "experiments/trials/measured_errors.h"

namespace vismem {
namespace {

TEST(ErrorQuantiles, AreTheErrorsAtTheirSharesAndBetweenThemInProportion) {
  const ErrorQuantiles& errors = kMeasuredAlongFloor[1];
  for (std::size_t i = 0; i < ErrorQuantiles::kShares.size(); ++i) {
    EXPECT_DOUBLE_EQ(errors.at(ErrorQuantiles::kShares[i]), errors.px[i]);
  }
  EXPECT_DOUBLE_EQ(errors.at(0.625), 0.5 * (errors.px[5] + errors.px[6]));
  EXPECT_EQ(errors.at(0.0), errors.px.front());
  EXPECT_EQ(errors.at(1.0), errors.px.back());
}

}  // namespace
}  // namespace vismem
