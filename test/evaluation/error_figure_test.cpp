#include "evaluation/figures/error_figure.h"

#include <gmock/gmock.h>

#include "common/geometry/angles.h"
#include "support/picture_probe.h"

namespace vismem {
namespace {

TEST(ErrorFigure, DrawsCurvesLimitsAndTheSettlingTime) {
  ErrorFigure figure;
  figure.title = "corridor, seed 7: error over time";
  for (int i = 0; i <= 300; ++i) {
    const double t = 0.2 * i;
    PoseError e{toStampUs(t), 0.0, 0.0, 0.5};
    e.position_m = t < 12.0 ? 4.0 + std::sin(t) : 0.08 + 0.04 * std::sin(t);
    e.heading_rad = degToRad(t < 12.0 ? 120.0 : 2.0 + std::cos(2 * t));
    if (t > 4.0 && t < 5.0) e.position_m.reset(), e.heading_rad.reset();
    figure.score.errors.push_back(e);
  }
  figure.score.settled_after_s = 12.0;
  figure.score.position_error_m = 0.081;
  figure.score.heading_error_rad = degToRad(2.03);
  const cv::Mat picture = drawErrors(figure);
  keep(picture, "error.png");
  EXPECT_LT(distanceTo(picture, positionErrorPx(figure, 8.0, 4.0 + std::sin(8.0)), colors::kEstimate), 40);
  EXPECT_LT(distanceTo(picture, headingErrorPx(figure, 8.0, degToRad(120.0)), colors::kEstimate), 40);
  EXPECT_LT(distanceTo(picture, positionErrorPx(figure, 12.0, 1.5), colors::kTruth), 40)
      << "the settling time";
  EXPECT_GT(distanceTo(picture, positionErrorPx(figure, 14.0, 8.0), colors::kEstimate), 100);
  // Images without a pose: red at the top border, no curve.
  EXPECT_LT(distanceTo(picture, positionErrorPx(figure, 4.4, 30.0) + Eigen::Vector2d(0, 4), colors::kLost, 2),
            60);
}

TEST(ErrorFigure, AxesFitTheErrors) {
  EXPECT_THAT(logarithmicTicks({0.004, 0.5}),
              testing::Pointwise(testing::DoubleNear(1e-9), {0.003, 0.01, 0.03, 0.1, 0.3, 1.0}));
  EXPECT_THAT(logarithmicTicks({0.5}), testing::Pointwise(testing::DoubleNear(1e-9), {0.3, 1.0, 3.0}))
      << "a whole decade at least";
  // Of any size: the curve stays inside and uses the height.
  for (const double scale : {0.002, 1.0, 400.0}) {
    ErrorFigure figure;
    for (int i = 0; i <= 10; ++i)
      figure.score.errors.push_back({toStampUs(i), scale * (1.0 + i), degToRad(1.0 + i), 0.5});
    const double low = positionErrorPx(figure, 0.0, scale).y();
    const double high = positionErrorPx(figure, 0.0, 11.0 * scale).y();
    EXPECT_GT(low - high, 50.0) << scale;
    EXPECT_GT(high, positionErrorPx(figure, 0.0, 1e9).y()) << "not on the border";
    EXPECT_LT(low, positionErrorPx(figure, 0.0, 1e-9).y());
  }
}

TEST(ErrorFigure, SaysWhenThereIsNothingToShow) {
  EXPECT_FALSE(drawErrors({}).empty());
}

}  // namespace
}  // namespace vismem
