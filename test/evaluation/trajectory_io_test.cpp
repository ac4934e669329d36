#include "evaluation/core/trajectory_io.h"

#include <gmock/gmock.h>

#include <sstream>

#include "support/tum.h"

namespace vismem {
namespace {

TEST(Tum, WritesAHandWorkedLine) {
  // Half a turn: qz = sin(90 deg) = 1, qw = 0.
  std::ostringstream out;
  writeTumRow({1'500'000, {1.0, -2.0, std::numbers::pi}}, out);
  EXPECT_EQ(out.str(), "1.500000 1.000000000 -2.000000000 0 0 0 1.000000000 0.000000000\n");
}

TEST(Tum, ReadsBackWhatItWrote) {
  Trajectory trajectory;
  for (int i = 0; i < 200; ++i) {
    // Stamps of a real clock, with microseconds that a rounded double would lose.
    append(trajectory,
           {1'700'000'000'000'001 + i * 33'333, {0.1 * i, std::sin(i), std::remainder(0.3 * i, 6.28)}});
  }
  std::ostringstream out;
  out << kTumHeader;
  for (const StampedPose& pose : trajectory) writeTumRow(pose, out);
  const Trajectory back = readTum(out.str());
  ASSERT_EQ(back.size(), trajectory.size());
  for (std::size_t i = 0; i < back.size(); ++i) {
    EXPECT_EQ(back[i].stamp_us, trajectory[i].stamp_us);
    EXPECT_NEAR(back[i].pose.x, trajectory[i].pose.x, 1e-8);
    EXPECT_NEAR(back[i].pose.y, trajectory[i].pose.y, 1e-8);
    EXPECT_NEAR(back[i].pose.theta, trajectory[i].pose.theta, 1e-8);
  }
}

TEST(MemoryCsv, HasTheColumnsThatOthersRead) {
  MemorySnapshot memory;
  memory.stamp_us = 12'345'678;
  MemorySegment s;
  s.id = 7;
  s.odom = {{1.0, 2.0, 0.0}, {3.0, 4.0, 0.5}};
  s.label = "skirting";
  s.life = 80.0;
  // Mean variances in the plane: (0.01 + 0.03) / 2 = 0.02 and 0.0004: root of the larger = 0.1414.
  s.P_a.diagonal() << 0.01, 0.03, 1.0;
  s.P_b.diagonal() << 0.0004, 0.0004, 1.0;
  s.P_b(0, 1) = s.P_b(1, 0) = -0.0001;
  s.last_seen_us = 12'000'000;
  s.confirmed = true;
  memory.segments.push_back(s);
  std::ostringstream out;
  writeMemoryRows(memory, out);
  EXPECT_EQ(kMemoryHeader,
            "t_s,id,x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,label,life,position_std_m,last_seen_s,confirmed,"
            "p1_xx_m2,p1_xy_m2,p1_yy_m2,p2_xx_m2,p2_xy_m2,p2_yy_m2\n");
  EXPECT_EQ(out.str(),
            "12.345678,7,1.0000,2.0000,0.0000,3.0000,4.0000,0.5000,skirting,80.0000,0.1414,12.000000,1,"
            "0.01000000,0.00000000,0.03000000,0.00040000,-0.00010000,0.00040000\n");
}

TEST(PrimitivesCsv, HasARowPerShape) {
  MemorySnapshot memory;
  memory.stamp_us = 1'000'000;
  Primitive shape;
  shape.id = 4;
  shape.kind = PrimitiveKind::kTriangle;
  shape.vertices = {{0.0, 0.0}, {0.6, 0.0}, {0.3, 0.9}};
  shape.centre = {0.3, 0.3};
  shape.quality = 0.75;
  shape.life = 50.0;
  memory.primitives.push_back(shape);
  std::ostringstream out;
  writePrimitivesRows(memory, out);
  EXPECT_EQ(
      std::string(kPrimitivesHeader) + out.str(),
      "t_s,id,kind,x_m,y_m,heading_rad,length_m,width_m,radius_m,hidden_vertex,quality,life,vertices_m\n"
      "1.000000,4,triangle,0.3000,0.3000,0.0000,0.0000,0.0000,0.0000,-1,0.7500,50.0000,"
      "0.0000 0.0000; 0.6000 0.0000; 0.3000 0.9000\n");
}

TEST(RacesCsv, HasARowPerRaceAndEstimate) {
  PoseEstimate estimate;
  estimate.stamp_us = 200'000;
  estimate.reliability = 0.5;
  estimate.P << 4e-4, -1e-4, 0.0, -1e-4, 9e-4, 2e-5, 0.0, 2e-5, 1e-6;
  estimate.races.push_back({3, {1.0, 2.0, 0.5}, 0.9, 0.75, 4, 12, true});
  estimate.races.push_back({5, {-1.0, 0.0, 0.0}, 0.4, 0.25, 0, 2, false});
  std::ostringstream out;
  writeRacesRows(estimate, out);
  EXPECT_EQ(
      std::string(kRacesHeader) + out.str(),
      "t_s,race,x_m,y_m,theta_rad,health,weight,victories,age,reliability,xx_m2,xy_m2,yy_m2,xt_mrad,yt_mrad,"
      "tt_rad2\n"
      "0.200000,3,1.000000,2.000000,0.500000,0.900000,0.750000,4,12,0.500000,4.000000e-04,-1.000000e-04,"
      "9.000000e-04,0.000000e+00,2.000000e-05,1.000000e-06\n"
      "0.200000,5,-1.000000,0.000000,0.000000,0.400000,0.250000,0,2,,,,,,,\n");
}

TEST(WriteTextFile, SaysWhichFileCannotBeWritten) {
  try {
    writeTextFile("/proc/absent/file.tum", "text");
    FAIL() << "no error";
  } catch (const std::runtime_error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("cannot write /proc/absent/file.tum"));
  }
}

}  // namespace
}  // namespace vismem
