#include "experiments/app/over_runs.h"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace vismem {
namespace {

TEST(OverRuns, SumsUpWhatTheRunsHaveInCommon) {
  const std::vector<nlohmann::json> runs{
      {{"seed", 1}, {"name", "a"}, {"x", {{"p", 1.0}, {"ok", true}}}},
      {{"seed", 2}, {"name", "b"}, {"x", {{"p", 3.0}, {"ok", false}, {"q", 5}, {"r", nullptr}}}}};
  const auto all = overRuns(runs);
  EXPECT_FALSE(all.contains("seed"));
  EXPECT_FALSE(all.contains("name"));
  EXPECT_EQ(all["x"]["p"], (nlohmann::json{{"mean", 2.0}, {"min", 1.0}, {"max", 3.0}, {"runs", 2}}));
  EXPECT_EQ(all["x"]["ok"]["mean"], 0.5);
  EXPECT_EQ(all["x"]["q"]["runs"], 1);
  EXPECT_FALSE(all["x"].contains("r"));
  EXPECT_TRUE(overRuns({}).empty());
}

}  // namespace
}  // namespace vismem
