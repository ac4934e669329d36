#include "calibration/core/body/observability.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace vismem {
namespace {

// Two lengths of which only the sum is measured to 1 mm, and an angle that is measured to 0.01: the
// information is [1 1 0; 1 1 0; 0 0 0] / 1e-6 + [0 0 0; 0 0 0; 0 0 1] / 1e-4.
ParameterInformation sumOnly() {
  ParameterInformation information;
  information.parameters = {4, 5, 6};
  information.matrix = Eigen::Matrix3d::Zero();
  information.matrix.topLeftCorner<2, 2>().setConstant(1e6);
  information.matrix(2, 2) = 1e4;
  return information;
}

TEST(Observability, NamesTheDirectionThatIsNotMeasured) {
  const Observability known = analyse(sumOnly(), {"first", "second", "angle"}, {0.02, 0.02, 0.1});
  EXPECT_FALSE(known.sigma[0]);
  EXPECT_FALSE(known.sigma[1]);
  ASSERT_TRUE(known.sigma[2]);
  EXPECT_NEAR(*known.sigma[2], 0.01, 1e-9);
  ASSERT_EQ(known.unknown.size(), 1U);
  EXPECT_THAT(known.unknown[0].text, testing::AnyOf("first, second", "second, first"));
  EXPECT_THAT(known.unknown[0].parameters, testing::UnorderedElementsAre(4, 5));
  // The sum is known to a millimetre all the same.
  const Eigen::Vector3d sum(1, 1, 0);
  EXPECT_NEAR(std::sqrt(sum.dot(known.covariance * sum)), 1e-3, 1e-6);
}

TEST(Observability, CallsANumberUselessWhenItIsTooUncertain) {
  const Observability known = analyse(sumOnly(), {"first", "second", "angle"}, {0.02, 0.02, 0.005});
  EXPECT_FALSE(known.sigma[2]);
  EXPECT_EQ(known.unknown.size(), 2U);
}

}  // namespace
}  // namespace vismem
