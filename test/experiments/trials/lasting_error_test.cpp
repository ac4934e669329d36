#include "experiments/trials/lasting_error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "experiments/trials/gaussian.h"

namespace vismem {
namespace {

TEST(LastingError, HasMeanSpreadAndQuantiles) {
  LastingError error;
  EXPECT_EQ(error.mean(), 0.0);
  EXPECT_EQ(error.quantile(0.5), 0.0);
  // 0, 1, 2, 3, 4: mean 2, variance (4 + 1 + 0 + 1 + 4) / 5 = 2.
  for (int i = 0; i < 5; ++i) error.add(i, 0.0, i);
  EXPECT_DOUBLE_EQ(error.mean(), 2.0);
  EXPECT_NEAR(error.standardDeviation(), std::sqrt(2.0), 1e-12);
  EXPECT_DOUBLE_EQ(error.quantile(0.0), 0.0);
  EXPECT_DOUBLE_EQ(error.quantile(0.5), 2.0);
  EXPECT_DOUBLE_EQ(error.quantile(1.0), 4.0);
}

TEST(LastingError, CorrelatesErrorsOfOneThingOverTime) {
  RandomEngine engine(1);
  LastingError constant;
  LastingError fresh;
  for (int thing = 0; thing < 50; ++thing) {
    const double of_thing = standardNormal(engine);
    for (int i = 0; i < 40; ++i) {
      constant.add(thing, 0.1 * i, of_thing);
      fresh.add(thing, 0.1 * i, standardNormal(engine));
    }
  }
  EXPECT_GT(constant.correlation(0), 0.95) << "0.1 s apart";
  EXPECT_GT(constant.correlation(1), 0.95) << "1 s apart";
  EXPECT_NEAR(fresh.correlation(0), 0.0, 0.1);
  EXPECT_EQ(fresh.correlation(3), 0.0) << "no two images lie 10 s apart";
}

TEST(LastingError, AnErrorOfTheThingItselfIsEqualInAllRuns) {
  RandomEngine engine(2);
  LastingError of_map;
  LastingError of_run;
  std::vector<double> map_errors;
  for (int thing = 0; thing < 50; ++thing) map_errors.push_back(standardNormal(engine));
  for (int run = 0; run < 4; ++run) {
    of_map.beginRun();
    of_run.beginRun();
    for (int thing = 0; thing < 50; ++thing) {
      const double in_this_run = standardNormal(engine);
      for (int i = 0; i < 20; ++i) {
        of_map.add(thing, 0.1 * i, map_errors[static_cast<std::size_t>(thing)]);
        of_run.add(thing, 0.1 * i, in_this_run);
      }
    }
  }
  EXPECT_GT(of_map.correlationBetweenRuns(), 0.95);
  EXPECT_NEAR(of_run.correlationBetweenRuns(), 0.0, 0.2);
}

}  // namespace
}  // namespace vismem
