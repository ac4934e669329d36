// Tests C1, C2. The recorder's configuration: the shipped files, and what is wrong with others.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>

#include "common/config/config_error.h"
#include "recorder/app/config.h"
#include "support/build_paths.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

RecorderConfig read(const Properties& properties) {
  ConfigReader config(properties);
  ConfigReader reader = config.group("Recorder");
  reader.known("Endpoints");
  reader.known("WebEndpoints");
  RecorderConfig result = readRecorderConfig(reader);
  config.finish();
  return result;
}

std::vector<std::string> problemsOf(const std::string& text) {
  try {
    read(Properties::parse(text, "recorder.cfg"));
  } catch (const ConfigError& error) {
    return error.problems();
  }
  return {};
}

TEST(RecorderConfig, EveryShippedFileIsRead) {
  // Maps are named from the project's root.
  fs::current_path(VISMEM_SOURCE_DIR);
  int files = 0;
  for (const auto& setup : fs::directory_iterator("cfg")) {
    const fs::path file = setup.path() / "recorder.cfg";
    if (!fs::exists(file)) continue;
    const RecorderConfig config = read(Properties::load(file));
    ASSERT_EQ(config.cameras.size(), 1u) << file;
    EXPECT_EQ(config.cameras[0].topic, "/camera") << file;
    EXPECT_EQ(config.cameras[0].storage, ImageStorage::kCaptured) << file;
    EXPECT_FALSE(config.odometry.empty()) << file;
    EXPECT_LE(config.core.bag.max_chunk_us, kSecondUs) << file;
    ++files;
  }
  EXPECT_EQ(files, 6) << "files, humanoid, nao, replay, robot, sim";
}

TEST(RecorderConfig, SeveralCamerasHaveTheirOwnTopics) {
  const RecorderConfig config =
      read(Properties::parse("Recorder.Cameras.left.Proxy = left:tcp -p 1\n"
                             "Recorder.Cameras.right.Proxy = right:tcp -p 2\n"
                             "Recorder.Cameras.right.Topic = /eyes/right\n"
                             "Recorder.Cameras.right.Images = png\n"
                             "Recorder.Ring.Length_s = 30\n",
                             "recorder.cfg"));
  ASSERT_EQ(config.cameras.size(), 2u);
  EXPECT_EQ(config.cameras[0].topic, "/left");
  EXPECT_EQ(config.cameras[1].topic, "/eyes/right");
  EXPECT_EQ(config.cameras[1].storage, ImageStorage::kPng);
  EXPECT_EQ(config.core.ring_us, 30 * kSecondUs);
}

TEST(RecorderConfig, NamesEachWrongValueWithItsRule) {
  EXPECT_THAT(
      problemsOf("Recorder.Name = ../x\n"
                 "Recorder.Compression = bz2\n"
                 "Recorder.Chunk.Length_s = 2\n"
                 "Recorder.Memory_MB = 0\n"
                 "Recorder.Ring.LostBelow = 0.7\n"
                 "Recorder.Cameras.a.Proxy = a:tcp -p 1\n"
                 "Recorder.Cameras.a.Topic = camera\n"
                 "Recorder.Cameras.b.Images = raw\n"
                 "Recorder.Odometri.Proxy = x\n"),
      ElementsAre(
          HasSubstr("missing key \"Recorder.Cameras.b.Proxy\""),
          HasSubstr("recorder.cfg:1: Recorder.Name = ../x (name = \"../x\" (must be 1..100"),
          HasSubstr("recorder.cfg:2: Recorder.Compression = bz2 (must be one of: none, lz4)"),
          HasSubstr("recorder.cfg:3: Recorder.Chunk.Length_s = 2 (must be 0.01..1)"),
          HasSubstr("recorder.cfg:4: Recorder.Memory_MB = 0 (must be 1..65536)"),
          HasSubstr(
              "recorder.cfg:5: Recorder.Ring.LostBelow = 0.7 (must be less than Recorder.Ring.SureAbove)"),
          HasSubstr("recorder.cfg:7: Recorder.Cameras.a.Topic = camera (must begin with '/'"),
          HasSubstr("recorder.cfg:9: unknown key \"Recorder.Odometri.Proxy\" (did you mean")));
}

TEST(RecorderConfig, TwoCamerasDoNotShareATopic) {
  EXPECT_THAT(problemsOf("Recorder.Cameras.a.Proxy = a:tcp -p 1\n"
                         "Recorder.Cameras.a.Topic = /camera\n"
                         "Recorder.Cameras.b.Proxy = b:tcp -p 1\n"
                         "Recorder.Cameras.b.Topic = /camera\n"),
              ElementsAre(HasSubstr("Recorder.Cameras.b.Topic = /camera (is that of camera a already)")));
}

}  // namespace
}  // namespace vismem
