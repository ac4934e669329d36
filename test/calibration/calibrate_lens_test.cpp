// calibrate lens as a user runs it; what it writes is read by camera_server's own reader and by camera_server
// itself.
#include <gmock/gmock.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "calibration/calibrate_run.h"
#include "calibration/core/target/board_file.h"
#include "camera_server/core/camera_info.h"
#include "support/component_process.h"
#include "support/lens_trials.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using ::testing::HasSubstr;

ToolRun calibrateLensWith(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "lens");
  return runCalibrate(std::move(arguments));
}

std::string textOf(const std::string& file) {
  std::ifstream stream(file);
  return {std::istreambuf_iterator<char>(stream), {}};
}

class CalibrateLensTool : public testing::Test {
 protected:
  static constexpr int kImages = 18;

  static void SetUpTestSuite() {
    folder_ = new TemporaryFolder;
    lens_ = intrinsicsFromFieldOfView(640, 480, 1.1);
    lens_.k1 = -0.2;
    lens_.k2 = 0.03;
    std::filesystem::create_directories(*folder_ / "images");
    BoardFile board;
    board.nominal.square_m.setConstant(0.029);
    board.ruler_mm = Eigen::Vector2d(100.0, 100.0);
    std::ofstream(*folder_ / "board.json") << writeBoardFile(board);
    const BoardRenderer renderer(lens_);
    std::mt19937 random(21);
    const PixelGrid places = pixelGrid(640, 480, 5, 4);
    for (int i = 0; i < kImages; ++i) {
      const BoardScene scene = drawScene(
          lens_, board.measured(), places.px[static_cast<std::size_t>(7 * i) % places.px.size()], random);
      cv::imwrite(*folder_ / ("images/view" + std::to_string(i) + ".png"), renderer.render(scene, random));
    }
  }
  static void TearDownTestSuite() { delete folder_; }

  static inline TemporaryFolder* folder_ = nullptr;
  static inline CameraIntrinsics lens_;
};

TEST_F(CalibrateLensTool, WritesALensThatCameraServerReads) {
  const TemporaryFolder out;
  const ToolRun run = calibrateLensWith(
      {"--board", *folder_ / "board.json", "--images", *folder_ / "images", "--out", out / "lens"});
  ASSERT_EQ(run.code, 0) << run.out << run.error;
  EXPECT_THAT(run.out, HasSubstr("view0.png: accepted"));
  EXPECT_THAT(run.out, HasSubstr("cm on the floor at 3 m"));
  const json summary = run.summary();
  EXPECT_EQ(summary["file"].get<std::string>(), out / "lens/camera.yaml");
  EXPECT_GE(summary["views"].get<int>(), 12);
  const CameraIntrinsics found = parseCameraInfo(textOf(out / "lens/camera.yaml"), "camera.yaml");
  EXPECT_LT(projectionDifference(lens_, found, pixelGrid(640, 480)).worst_px, 0.5);
  for (const char* picture : {"lens/uncertainty.png", "lens/residuals.png", "lens/progress.png"}) {
    EXPECT_EQ(cv::imread(out / picture).size(), cv::Size(640, 480)) << picture;
  }
  EXPECT_EQ(json::parse(textOf(out / "lens/report.json"))["models"].size(), 4u);

  // The server itself accepts it.
  ComponentProcess server(
      "camera_server",
      {"--CameraServer.Endpoints=tcp -h 127.0.0.1 -p 0", "--CameraServer.Camera.cameraA.Driver=files",
       "--CameraServer.Camera.cameraA.Source=" + *folder_ / "images",
       "--CameraServer.Camera.cameraA.Calibration=" + out / "lens/camera.yaml"});
  EXPECT_TRUE(server.waitUntilReady());
}

TEST_F(CalibrateLensTool, GoesOnWhereItStopped) {
  const TemporaryFolder out;
  std::filesystem::create_directories(out / "few");
  for (int i = 0; i < 8; ++i) {
    const std::string name = "view" + std::to_string(i) + ".png";
    std::filesystem::copy(*folder_ / ("images/" + name), out / ("few/" + name));
  }
  const ToolRun first =
      calibrateLensWith({"--board", *folder_ / "board.json", "--images", out / "few", "--out", out / "lens"});
  ASSERT_EQ(first.code, 0) << first.out << first.error;
  EXPECT_FALSE(first.summary()["complete"].get<bool>());
  EXPECT_THAT(first.out, HasSubstr("Not complete"));
  const int before = first.summary()["views"].get<int>();
  const ToolRun second = calibrateLensWith({"--board", *folder_ / "board.json", "--images",
                                            *folder_ / "images", "--out", out / "lens", "--json-lines"});
  ASSERT_EQ(second.code, 0) << second.out << second.error;
  // The first images are known by now.
  EXPECT_THAT(second.out, HasSubstr("the same as a view before"));
  EXPECT_GT(second.summary()["views"].get<int>(), before);
  std::istringstream lines(second.out);
  for (std::string line; std::getline(lines, line);) EXPECT_TRUE(json::parse(line).contains("event")) << line;
  // Without images: solved anew from the kept views.
  const ToolRun third = calibrateLensWith({"--board", *folder_ / "board.json", "--out", out / "lens"});
  ASSERT_EQ(third.code, 0) << third.error;
  EXPECT_EQ(third.summary()["views"].get<int>(), second.summary()["views"].get<int>());
  EXPECT_EQ(third.summary()["held_out_rms_px"].get<double>(),
            second.summary()["held_out_rms_px"].get<double>());
  // Another ruler makes another board.
  const ToolRun other = calibrateLensWith(
      {"--board", *folder_ / "board.json", "--ruler-mm", "97", "97", "--out", out / "lens"});
  EXPECT_EQ(other.code, 2);
  EXPECT_THAT(other.error, HasSubstr("another board or of another ruler"));
}

TEST_F(CalibrateLensTool, WrongInputNamesItself) {
  const TemporaryFolder out;
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), {"--out", out / "lens"});
    return calibrateLensWith(more);
  };
  ToolRun run = with({"--board", out / "none.json"});
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.error, HasSubstr("none.json: cannot be read"));
  run = with({"--board", *folder_ / "board.json", "--images", out / "nothing"});
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.error, HasSubstr("must be a folder with images"));
  run = with({"--board", *folder_ / "board.json"});
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.error, HasSubstr("one of --images, --bag and --camera"));
  run = with({"--board", *folder_ / "board.json", "--images", "a", "--bag", "b"});
  EXPECT_EQ(run.code, 2);
  run = with({"--board", *folder_ / "board.json", "--camera", "no proxy"});
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.error, HasSubstr("must be a proxy"));
  EXPECT_THAT(run.error, Not(HasSubstr(".cpp")));
  std::filesystem::create_directories(out / "damaged");
  std::ofstream(out / "damaged/views.json") << "{";
  run = calibrateLensWith({"--board", *folder_ / "board.json", "--out", out / "damaged"});
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.error, HasSubstr("must be as calibrate lens writes it"));
  // Images without a board: no lens, and what they were.
  std::filesystem::create_directories(out / "white");
  cv::imwrite(out / "white/a.png", cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(255)));
  run = with({"--board", *folder_ / "board.json", "--images", out / "white"});
  EXPECT_EQ(run.code, 1);
  EXPECT_THAT(run.error, HasSubstr("1 images: no board is seen"));
}

// Live over Ice: a board that is still for a while at each place.
TEST_F(CalibrateLensTool, ReadsARunningCamera) {
  const TemporaryFolder out;
  constexpr int kStill = 12;
  std::filesystem::create_directories(out / "live");
  for (int i = 0; i < kImages * kStill; ++i) {
    const std::string from = *folder_ / ("images/view" + std::to_string(i / kStill) + ".png");
    std::filesystem::create_symlink(from, out / ("live/" + std::to_string(i) + ".png"));
  }
  ComponentProcess server(
      "camera_server",
      {"--CameraServer.Endpoints=tcp -h 127.0.0.1 -p 0", "--CameraServer.Camera.cameraA.Driver=files",
       "--CameraServer.Camera.cameraA.Source=" + out / "live", "--CameraServer.Camera.cameraA.Rate_hz=10"});
  ASSERT_TRUE(server.waitUntilReady());
  const ToolRun run =
      calibrateLensWith({"--board", *folder_ / "board.json", "--camera", server.proxy("cameraA"), "--seconds",
                         "25", "--out", out / "lens", "--json-lines"});
  ASSERT_EQ(run.code, 0) << run.out << run.error;
  EXPECT_GE(run.summary()["views"].get<int>(), 5);
  // Where one place follows another, the board has moved.
  EXPECT_THAT(run.out, HasSubstr("the board moves"));
  EXPECT_THAT(run.out, HasSubstr("\"target_px\""));
}

}  // namespace
}  // namespace vismem
