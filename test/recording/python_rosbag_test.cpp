// Tests C1. Recordings of ours as Debian's python3-rosbag reads them: `rosbag info`, and every message
// decoded there.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "common/recording/bag_encoder.h"
#include "common/recording/file_sink.h"
#include "common/recording/ros_messages.h"
#include "support/build_paths.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

using nlohmann::json;
using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;

std::string output(const std::string& command) {
  std::string text;
  FILE* pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return text;
  std::array<char, 4096> piece{};
  while (const std::size_t n = fread(piece.data(), 1, piece.size(), pipe)) text.append(piece.data(), n);
  return pclose(pipe) == 0 ? text : "";
}

RosPose somePose() {
  return {{1.5, -2.5, 0.25}, {0.0, 0.0, 0.6, 0.8}};
}

/// One message of each type, two chunks, the last of them without anything but a text.
void write(const std::string& file, BagCompression compression) {
  FileSink sink(file, /*durable=*/false);
  BagEncoder bag(sink, compression);
  const RosHeader header{1'234'567, "camera_optical_frame"};
  const auto add = [&](const char* topic, const char* type, const Bytes& bytes) {
    bag.add({topic, type}, 1'234'567, bytes);
  };
  RosImage image{header, 2, 3, "rgb8", 9, {}};
  for (int i = 0; i < 18; ++i) image.data.push_back(static_cast<std::uint8_t>(10 * i));
  add("/camera/image_raw", kRawImageType, serialize(image));
  add("/camera/image_raw/compressed", kCompressedImageType,
      serialize(RosCompressedImage{header, "jpeg", image.data}));
  RosCameraInfo info;
  info.header = header;
  info.width = 3;
  info.height = 2;
  info.d = {0.1, 0.2, 0.3, 0.4, 0.5};
  info.k = {1, 2, 3, 4, 5, 6, 7, 8, 9};
  info.p = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  add("/camera/camera_info", kCameraInfoType, serialize(info));
  add("/joint_states", kJointStateType,
      serialize(RosJointState{{1'234'567, ""}, {"pan", "tilt"}, {0.5, -0.25}}));
  RosOdometry odometry;
  odometry.header = {1'234'567, "odom"};
  odometry.child_frame_id = "base_footprint";
  odometry.pose = somePose();
  odometry.v_mps = 0.3;
  odometry.w_radps = -0.4;
  add("/odom", kOdometryType, serialize(odometry));
  RosPoseWithCovariance pose{{1'234'567, "map"}, somePose(), {}};
  for (std::size_t i = 0; i < 36; ++i) pose.covariance[i] = static_cast<double>(i);
  add("/localization/pose", kPoseType, serialize(pose));
  add("/tf", kTransformType, serialize(std::vector<RosTransform>{{{1'234'567, "map"}, "odom", somePose()}}));
  RosMarker marker;
  marker.header = {1'234'567, "odom"};
  marker.ns = "segments";
  marker.id = 7;
  marker.points = {{1, 2, 3}, {4, 5, 6}};
  marker.colors = {{0.25F, 0.5F, 0.75F, 1.0F}, {1.0F, 0.0F, 0.0F, 1.0F}};
  add("/memory/segments", kMarkersType, serialize(std::vector<RosMarker>{marker}));
  bag.closeChunk();
  bag.add({"/recorder/marks", kStringType}, 2'000'000, serialize(std::string("{\"text\": \"hello\"}")));
  bag.add({"/recorder/marks", kStringType}, 0, serialize(std::string("at the very beginning")));
  bag.finish();
}

TEST(PythonRosbag, ReadsEveryMessage) {
  if (output("/usr/bin/python3 -c 'import rosbag; print(1)' 2>/dev/null") != "1\n") {
    GTEST_SKIP() << "python3-rosbag is not installed: scripts/setup installs it";
  }
  const TemporaryFolder folder;
  for (const auto compression : {BagCompression::kNone, BagCompression::kLz4}) {
    const std::string file = folder / (std::string(nameOf(compression)) + ".bag");
    write(file, compression);
    const std::string text =
        output("/usr/bin/python3 " VISMEM_SOURCE_DIR "/test/recording/read_bag.py " + file);
    ASSERT_FALSE(text.empty());
    const json read = json::parse(text);
    EXPECT_THAT(read.at("info").get<std::string>(),
                AllOf(ContainsRegex("messages: +10"),
                      ContainsRegex(std::string("compression: +") + nameOf(compression)),
                      HasSubstr("/memory/segments"), HasSubstr("visualization_msgs/MarkerArray")));
    const json& topics = read.at("topics");
    const auto only = [&](const std::string& topic) { return topics.at(topic).at(0).at("message"); };
    EXPECT_EQ(topics.at("/odom").at(0).at("recorded_ns"), 1'234'567'000);

    json image = only("/camera/image_raw");
    EXPECT_EQ(image.at("stamp_us"), 1'234'567);
    EXPECT_EQ(image.at("size"), json({3, 2}));
    EXPECT_EQ(image.at("step"), 9);
    EXPECT_EQ(image.at("encoding"), "rgb8");
    // printf '\x00\x0a\x14...' | md5sum of the bytes 0, 10, 20 .. 170.
    EXPECT_EQ(image.at("md5"), only("/camera/image_raw/compressed").at("md5"));
    EXPECT_EQ(
        image.at("md5").get<std::string>(),
        output(
            "/usr/bin/python3 -c \"import hashlib; print(hashlib.md5(bytes(range(0, 180, 10))).hexdigest(), "
            "end='')\""));
    EXPECT_EQ(only("/camera/image_raw/compressed").at("format"), "jpeg");
    const json info = only("/camera/camera_info");
    EXPECT_EQ(info.at("D"), json({0.1, 0.2, 0.3, 0.4, 0.5}));
    EXPECT_EQ(info.at("K"), json({1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0}));
    EXPECT_EQ(info.at("P").at(11), 12.0);
    EXPECT_EQ(only("/joint_states").at("positions"), json({0.5, -0.25}));
    const json pose({1.5, -2.5, 0.25, 0.0, 0.0, 0.6, 0.8});
    EXPECT_EQ(only("/odom").at("pose"), pose);
    EXPECT_EQ(only("/odom").at("v"), 0.3);
    EXPECT_EQ(only("/odom").at("w"), -0.4);
    EXPECT_EQ(only("/localization/pose").at("pose"), pose);
    EXPECT_EQ(only("/localization/pose").at("covariance").at(35), 35.0);
    EXPECT_EQ(only("/tf").at(0).at("child"), "odom");
    EXPECT_EQ(only("/tf").at(0).at("translation"), json({1.5, -2.5, 0.25}));
    EXPECT_EQ(only("/tf").at(0).at("rotation"), json({0.0, 0.0, 0.6, 0.8}));
    const json marker = only("/memory/segments").at(0);
    EXPECT_EQ(marker.at("ns"), "segments");
    EXPECT_EQ(marker.at("id"), 7);
    EXPECT_EQ(marker.at("type"), 5);
    EXPECT_EQ(marker.at("points"), json({{1.0, 2.0, 3.0}, {4.0, 5.0, 6.0}}));
    EXPECT_EQ(marker.at("colors").at(0), json({0.25, 0.5, 0.75, 1.0}));
    EXPECT_EQ(topics.at("/recorder/marks").size(), 2u) << "a message at time 0 is not passed over";
    EXPECT_EQ(topics.at("/recorder/marks").at(0).at("message"), "at the very beginning");
  }
}

}  // namespace
}  // namespace vismem
