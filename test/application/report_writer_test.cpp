#include "application/app/report_writer.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "common/geometry/angles.h"

namespace vismem {
namespace {

class Report : public testing::Test {
 protected:
  Report() {
    options_.world = "corridor.world";
    options_.seed = 7;
    options_.out = std::filesystem::path(testing::TempDir()) / ("report_" + std::to_string(getpid()));
    std::filesystem::create_directories(options_.out);
    summary_.seconds = 12.34567;
    summary_.memory_segments = 42;
  }
  ~Report() override { std::filesystem::remove_all(options_.out); }
  RunOptions options_;
  RunSummary summary_;
};

TEST_F(Report, UnknownValuesAreNull) {
  const nlohmann::json json = resultJson(options_, summary_);
  EXPECT_EQ(json["world"], "corridor");
  EXPECT_EQ(json["seed"], 7);
  EXPECT_EQ(json["seconds"], 12.346);
  EXPECT_EQ(json["memory_segments"], 42);
  EXPECT_TRUE(json["position_error_m"].is_null());
  EXPECT_TRUE(json["recovered"].is_null()) << "no truth";
  EXPECT_FALSE(json.contains("map_projection_px"));
}

TEST_F(Report, KeysCarryTheirUnits) {
  summary_.score.errors.push_back({});
  summary_.score.recovered = true;
  summary_.score.position_error_m = 0.012345;
  summary_.score.heading_error_rad = degToRad(1.5);
  summary_.projection.emplace();
  summary_.projection->detected_to_map_px = 1.234;
  const nlohmann::json json = resultJson(options_, summary_);
  EXPECT_EQ(json["position_error_m"], 0.0123);
  EXPECT_EQ(json["heading_error_deg"], 1.5);
  EXPECT_EQ(json["recovered"], true);
  EXPECT_EQ(json["map_projection_px"], 1.23);
}

TEST_F(Report, HasTheFilesThatARunHasDataFor) {
  RunRecord record;
  append(record.odometry, {0, {0, 0, 0}});
  append(record.odometry, {kSecondUs, {1, 0, 0}});
  RunMap map;
  map.map.segments.push_back({{{0, 1, 0}, {5, 1, 0}}, "skirting", 0.0});
  RunFiles files(options_.out);
  EXPECT_THAT(writeReport(options_, files, record, summary_, map), testing::IsEmpty());
  for (const char* file :
       {"trajectory.tum", "odometry.tum", "memory.csv", "primitives.csv", "races.csv", "result.json"}) {
    EXPECT_TRUE(std::filesystem::exists(options_.out / file)) << file;
  }
  EXPECT_FALSE(cv::imread((options_.out / "top_view.png").string()).empty());
  for (const char* file : {"truth.tum", "error.png", "last_image.png"}) {
    EXPECT_FALSE(std::filesystem::exists(options_.out / file)) << file << ": no truth, no image";
  }
  std::ifstream in(options_.out / "result.json");
  EXPECT_EQ(nlohmann::json::parse(in), resultJson(options_, summary_));
  options_.out /= "nowhere";
  EXPECT_THAT(writeReport(options_, files, record, summary_, map),
              testing::ElementsAre(testing::HasSubstr("nowhere/top_view.png"),
                                   testing::HasSubstr("nowhere/result.json")))
      << "one failing file does not stop the others";
}

}  // namespace
}  // namespace vismem
