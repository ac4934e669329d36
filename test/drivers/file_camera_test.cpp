// The file camera beyond its contract: order, stamps, sizes, missing and defective files.
// Tests C1.
#include "drivers/camera_files/file_camera.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "common/config/config_error.h"
#include "common/drivers/host_clock.h"
#include "drivers/camera_files/image_folder.h"
#include "drivers/camera_files/natural_order.h"
#include "drivers/camera_files/video_source.h"
#include "support/mjpeg_server.h"
#include "support/pictures.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using testing::ElementsAre;
using testing::HasSubstr;
using Clock = std::chrono::steady_clock;
namespace fs = std::filesystem;

constexpr auto kPatience = 20s;

std::unique_ptr<FrameSource> cameraOf(const std::string& keys) {
  const auto properties = Properties::parse(keys, "test.cfg");
  ConfigReader config(properties);
  auto camera = makeFileCamera(config);
  config.finish();
  return camera;
}

std::string problemOf(const std::string& keys) {
  try {
    cameraOf(keys);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "";
}

std::unique_ptr<FrameSource> started(const std::string& keys, const FrameRequest& request = {0, 0, 200.0}) {
  auto camera = cameraOf(keys);
  EXPECT_TRUE(camera->configure(request).ok());
  EXPECT_TRUE(camera->start().ok());
  return camera;
}

FrameResult awaitFrame(FrameSource& camera) {
  FrameResult result;
  for (const auto deadline = Clock::now() + kPatience; Clock::now() < deadline;) {
    result = camera.next(100ms);
    if (result.frame) return result;
  }
  ADD_FAILURE() << "no frame: " << result.message;
  result.frame = Frame{};
  return result;
}

/// Waits until the camera gives a reason with this text.
std::string awaitReason(FrameSource& camera, const std::string& text) {
  std::string message;
  for (const auto deadline = Clock::now() + kPatience; Clock::now() < deadline;) {
    message = camera.next(50ms).message;
    if (message.find(text) != std::string::npos) return message;
  }
  return message;
}

int numberOf(const Frame& frame) {
  return frame.image.empty() ? -1 : frame.image.at<cv::Vec3b>(0, 0)[0];
}

TEST(NaturalOrder, NumbersCountAsNumbers) {
  EXPECT_TRUE(naturallyBefore("frame2.png", "frame10.png"));
  EXPECT_FALSE(naturallyBefore("frame10.png", "frame2.png"));
  EXPECT_TRUE(naturallyBefore("a9b2", "a10b1"));
  EXPECT_TRUE(naturallyBefore("007", "8"));
  EXPECT_TRUE(naturallyBefore("08", "8")) << "ordered as text";
  EXPECT_FALSE(naturallyBefore("8", "08"));
  EXPECT_TRUE(naturallyBefore("a", "a1"));
  EXPECT_FALSE(naturallyBefore("x", "x"));
  // Longer than any integer type.
  EXPECT_TRUE(naturallyBefore("9999999999999999999998", "9999999999999999999999"));
}

TEST(FileCamera, GivesAFoldersImagesInNaturalOrderThenTheEnd) {
  const TemporaryFolder folder;
  for (const int i : {10, 2, 1}) writePicture(folder / ("f" + std::to_string(i) + ".png"), 10 * i);
  writePicture(folder / ".hidden.png", 5);
  std::ofstream(folder / "notes.txt") << "no image\n";
  fs::create_directories(folder.path() / "sub.png");
  auto camera = started("Source=" + folder.path().string() + "\nLoop=no\n", {0, 0, 20.0});
  std::vector<int> numbers;
  FrameResult result;
  for (const auto deadline = Clock::now() + kPatience; Clock::now() < deadline;) {
    result = camera->next(100ms);
    if (result.state == SourceState::kFinished) break;
    if (result.frame) numbers.push_back(numberOf(*result.frame));
  }
  EXPECT_THAT(numbers, ElementsAre(10, 20, 100));
  EXPECT_EQ(result.state, SourceState::kFinished);
  EXPECT_EQ(result.message, "end of image folder " + folder.path().string());
}

TEST(FileCamera, BeginsAgainAtTheEndAndStampsGoOn) {
  const TemporaryFolder folder;
  writePicture(folder / "1.png", 10);
  writePicture(folder / "2.png", 20);
  // A slow pace, so that none is passed over on a busy machine.
  auto camera = started("Source=" + folder.path().string() + "\nStamps=own\n", {0, 0, 10.0});
  std::vector<int> numbers;
  std::vector<StampUs> stamps;
  for (int i = 0; i < 5; ++i) {
    const Frame frame = *awaitFrame(*camera).frame;
    numbers.push_back(numberOf(frame));
    stamps.push_back(frame.stamp_us);
  }
  EXPECT_THAT(numbers, ElementsAre(10, 20, 10, 20, 10));
  EXPECT_THAT(stamps, ElementsAre(0, 100'000, 200'000, 300'000, 400'000));
}

TEST(FileCamera, AStampFileSaysWhichWhenAndHowFast) {
  const TemporaryFolder folder;
  writePicture(folder / "b.png", 20);
  writePicture(folder / "a.png", 10);
  writePicture(folder / "c.png", 30);
  std::ofstream(folder / "stamps.txt")
      << "# seconds file\n1257894000.5 b.png\n\n1257894000.75\ta.png # last\r\n";
  auto camera = cameraOf("Source=" + folder.path().string() + "\nStamps=own\nLoop=no\n");
  const PortReply reply = camera->configure({0, 0, 30.0});
  EXPECT_EQ(reply.kind, PortReply::Kind::kAdjusted);
  EXPECT_EQ(reply.message, "4 Hz, the pictures' own rate");
  camera->start();
  const Frame first = *awaitFrame(*camera).frame;
  const Frame second = *awaitFrame(*camera).frame;
  EXPECT_EQ(numberOf(first), 20);
  EXPECT_EQ(first.stamp_us, 1'257'894'000'500'000);
  EXPECT_EQ(numberOf(second), 10);
  EXPECT_EQ(second.stamp_us, 1'257'894'000'750'000);
  EXPECT_EQ(awaitReason(*camera, "end of"), "end of image folder " + folder.path().string());
}

TEST(FileCamera, ABadStampFileIsNamedByLine) {
  const TemporaryFolder folder;
  writePicture(folder / "a.png", 10);
  for (const auto& [text, problem] : std::vector<std::pair<std::string, std::string>>{
           {"1.5 a.png\nsoon b.png\n", "stamps.txt:2: \"soon b.png\" (must be SECONDS FILE)"},
           {"1.5 a.png\n1.5 b.png\n", "stamps.txt:2: the stamp is not after the one before it"},
           {"nan a.png\n", "stamps.txt:1: \"nan a.png\" (must be SECONDS FILE)"},
           {"17\n", "stamps.txt:1: \"17\" (must be SECONDS FILE)"},
           {"# nothing\n", "stamps.txt: names no image"}}) {
    std::ofstream(folder / "stamps.txt") << text;
    auto camera = started("Source=" + folder.path().string() + "\n");
    EXPECT_THAT(awaitReason(*camera, problem), HasSubstr(problem));
  }
}

TEST(FileCamera, HostStampsAreTheTimeWhenAPictureFellDue) {
  const TemporaryFolder folder;
  writePicture(folder / "1.png", 10);
  const StampUs before_us = hostClock_us();
  auto camera = started("Source=" + (folder / "1.png") + "\n");
  const Frame frame = *awaitFrame(*camera).frame;
  EXPECT_GE(frame.stamp_us, before_us);
  EXPECT_LE(frame.stamp_us, hostClock_us());
}

TEST(FileCamera, NamesAndSkipsWhatIsBrokenOrLost) {
  const TemporaryFolder folder;
  writePicture(folder / "1.jpg", 50);
  writePicture(folder / "5.jpg", 60);
  std::ofstream(folder / "2.jpg") << "this is no picture";
  std::ofstream(folder / "3.png") << "";
  {
    std::ifstream whole(folder / "1.jpg", std::ios::binary);
    const std::string bytes((std::istreambuf_iterator<char>(whole)), std::istreambuf_iterator<char>());
    std::ofstream(folder / "4.jpg", std::ios::binary) << bytes.substr(0, bytes.size() / 2);
  }
  auto camera = started("Source=" + folder.path().string() + "\n", {0, 0, 10.0});
  EXPECT_EQ(awaitFrame(*camera).message, "");
  const FrameResult after = awaitFrame(*camera);
  EXPECT_NEAR(numberOf(*after.frame), 60, 4);
  EXPECT_THAT(after.message,
              testing::AllOf(HasSubstr("2.jpg: cannot be decoded"), HasSubstr("3.png: is empty"),
                             HasSubstr("4.jpg: is a JPEG file cut short")));
  // One that should be there, and is not.
  std::ofstream(folder / "stamps.txt") << "0.0 1.jpg\n0.1 gone.jpg\n0.2 5.jpg\n";
  auto listed = started("Source=" + folder.path().string() + "\n");
  EXPECT_EQ(awaitReason(*listed, "gone.jpg"), (folder / "gone.jpg") + ": cannot be read");
}

TEST(FileCamera, WaitsForAFolderThatIsNotThereAndForOneThatGoes) {
  const TemporaryFolder parent;
  const fs::path folder = parent.path() / "walk";
  auto camera = started("Source=" + folder.string() + "\n");
  EXPECT_EQ(awaitReason(*camera, "no such"), folder.string() + ": no such file or folder");
  fs::create_directories(folder);
  EXPECT_EQ(awaitReason(*camera, "holds"), folder.string() + ": the folder holds no image");
  writePicture((folder / "1.png").string(), 10);
  EXPECT_EQ(numberOf(*awaitFrame(*camera).frame), 10);
  // At once: emptied first, it would be a folder that holds no image for a moment.
  fs::rename(folder, parent.path() / "moved");
  EXPECT_THAT(awaitReason(*camera, "walk:"),
              testing::AnyOf(HasSubstr("it has gone"), HasSubstr("no such file or folder")));
  fs::create_directories(folder);
  writePicture((folder / "1.png").string(), 20, 32, 32);
  const Frame back = *awaitFrame(*camera).frame;
  EXPECT_EQ(numberOf(back), 20);
  EXPECT_EQ(back.image.size(), cv::Size(32, 32)) << "what comes back may be another";
}

TEST(FileCamera, ScalesToWhatIsAskedForWithinThePicturesShape) {
  const TemporaryFolder folder;
  writePicture(folder / "1.png", 10, 640, 480);
  const std::string source = "Source=" + (folder / "1.png") + "\n";
  auto camera = cameraOf(source);
  EXPECT_EQ(camera->configure({320, 240, 0.0}).kind, PortReply::Kind::kAccepted);
  EXPECT_EQ(camera->configure({160, 0, 0.0}).kind, PortReply::Kind::kAccepted);
  EXPECT_EQ(camera->capabilities().height, 120);
  const PortReply wide = camera->configure({640, 360, 0.0});
  EXPECT_EQ(wide.kind, PortReply::Kind::kAdjusted);
  EXPECT_EQ(wide.message, "480x360, of the shape of the pictures");
  camera->start();
  EXPECT_EQ(awaitFrame(*camera).frame->image.size(), cv::Size(480, 360));
  EXPECT_EQ(camera->configure({}).message, "the camera runs; stop it before it is configured");
  auto absent = cameraOf("Source=" + (folder / "absent") + "\n");
  EXPECT_EQ(absent->configure({320, 240, 0.0}).message,
            "no picture was seen yet: they will be scaled to fit");
  EXPECT_THAT(absent->configure({0, 0, 5000.0}).message, HasSubstr("1000 Hz, the most there is"));
}

TEST(FileCamera, APictureOfAnotherShapeIsNamedAndSkipped) {
  const TemporaryFolder folder;
  writePicture(folder / "1.png", 10, 64, 48);
  writePicture(folder / "2.png", 20, 48, 64);
  writePicture(folder / "3.png", 30, 128, 96);
  auto camera = started("Source=" + folder.path().string() + "\n", {0, 0, 10.0});
  awaitFrame(*camera);
  const FrameResult third = awaitFrame(*camera);
  EXPECT_EQ(numberOf(*third.frame), 30);
  EXPECT_EQ(third.frame->image.size(), cv::Size(64, 48)) << "the same shape is scaled";
  EXPECT_EQ(third.message,
            (folder / "2.png") + ": has 48x64 pixels, which does not fit the 64x48 of the others");
}

TEST(FileCamera, GivesTheFilesOwnJpegToWhoAsksForIt) {
  const TemporaryFolder folder;
  writePicture(folder / "1.jpg", 90);
  auto camera = started("Source=" + (folder / "1.jpg") + "\n", {0, 0, 100.0, true});
  const Frame frame = *awaitFrame(*camera).frame;
  ASSERT_TRUE(frame.native);
  EXPECT_TRUE(frame.image.empty());
  EXPECT_EQ(frame.native->format, NativeFormat::kJpeg);
  EXPECT_EQ(frame.native->bytes.size(), fs::file_size(folder / "1.jpg"));
  auto scaled = started("Source=" + (folder / "1.jpg") + "\n", {32, 24, 100.0, true});
  EXPECT_FALSE(awaitFrame(*scaled).frame->native) << "scaled pictures are new ones";
}

TEST(FileCamera, AVideoKeepsItsRateAndTimes) {
  const TemporaryFolder folder;
  writeVideo(folder / "walk.avi", 6, 25.0);
  auto camera = cameraOf("Source=" + (folder / "walk.avi") + "\nStamps=own\nLoop=no\n");
  EXPECT_EQ(camera->configure({0, 0, 50.0}).message, "25 Hz, the pictures' own rate");
  camera->start();
  std::vector<StampUs> stamps;
  FrameResult result;
  for (const auto deadline = Clock::now() + kPatience; Clock::now() < deadline;) {
    result = camera->next(100ms);
    if (result.state == SourceState::kFinished) break;
    if (result.frame) stamps.push_back(result.frame->stamp_us);
  }
  EXPECT_EQ(result.state, SourceState::kFinished) << result.message;
  ASSERT_GE(stamps.size(), 2U);
  for (std::size_t i = 1; i < stamps.size(); ++i) {
    const StampUs step_us = stamps[i] - stamps[i - 1];
    EXPECT_EQ(step_us % 40'000, 0) << step_us;
    EXPECT_GT(step_us, 0);
  }
}

TEST(FileCamera, AFileThatIsNoVideoIsAReason) {
  const TemporaryFolder folder;
  std::ofstream(folder / "walk.avi") << "this is no video";
  auto camera = started("Source=" + (folder / "walk.avi") + "\n");
  EXPECT_EQ(awaitReason(*camera, "no video"), (folder / "walk.avi") + ": is no video");
  auto absent = started("Source=" + (folder / "absent.mp4") + "\n");
  EXPECT_EQ(awaitReason(*absent, "no such"), (folder / "absent.mp4") + ": no such file");
}

TEST(FileCamera, AStreamThatStallsOrHangsUpIsNamedAndComesBack) {
  MjpegServer server(MjpegServer::Manner::kHangsUp);
  auto camera = started("Source=" + server.url() + "\nReadTimeout_s=0.3\nOpenTimeout_s=1\n", {});
  awaitFrame(*camera);
  EXPECT_EQ(awaitReason(*camera, "no more"), "stream " + server.url() + ": no more pictures come");
  awaitFrame(*camera);
  server.setManner(MjpegServer::Manner::kStalls);
  EXPECT_EQ(awaitReason(*camera, "no more"), "stream " + server.url() + ": no more pictures come");
  server.setManner(MjpegServer::Manner::kGarbage);
  EXPECT_EQ(awaitReason(*camera, "cannot"), "stream " + server.url() + ": cannot be opened");
  server.setManner(MjpegServer::Manner::kSteady);
  awaitFrame(*camera);
}

TEST(FileCamera, AStreamThatIsGoneIsWaitedForAndReturns) {
  auto server = std::make_unique<MjpegServer>(MjpegServer::Manner::kSteady);
  const int port = server->port();
  auto camera = started("Source=" + server->url() + "\nReadTimeout_s=0.3\n", {});
  awaitFrame(*camera);
  server.reset();
  EXPECT_THAT(awaitReason(*camera, "cannot be opened"), HasSubstr("cannot be opened"));
  server = std::make_unique<MjpegServer>(MjpegServer::Manner::kSteady, port);
  const auto back = Clock::now();
  awaitFrame(*camera);
  EXPECT_LT(Clock::now() - back, 5s) << "the back-off ends at a second";
}

TEST(FileCamera, StopDoesNotWaitForAStreamThatIsSilent) {
  MjpegServer silent(MjpegServer::Manner::kSilent);
  auto camera = started("Source=" + silent.url() + "\nOpenTimeout_s=2\n", {});
  for (const auto deadline = Clock::now() + kPatience;
       silent.connections() == 0 && Clock::now() < deadline;) {
    std::this_thread::sleep_for(5ms);
  }
  ASSERT_GT(silent.connections(), 0) << "it is being opened";
  const auto began = Clock::now();
  camera->stop();
  EXPECT_LT(Clock::now() - began, 1s);
  // It may be started again meanwhile.
  EXPECT_TRUE(camera->start().ok());
  camera->stop();
  camera.reset();
  EXPECT_LT(Clock::now() - began, 2s + 3s) << "the destructor waits for the time-out at most";
}

TEST(FileCamera, AddressesAreShownWithoutTheirPassword) {
  EXPECT_EQ(NetworkStream("rtsp://user:secret@10.0.0.1/live", {}).name(), "stream rtsp://10.0.0.1/live");
  EXPECT_EQ(NetworkStream("http://10.0.0.1/a@b.mjpg", {}).name(), "stream http://10.0.0.1/a@b.mjpg");
}

TEST(FileCamera, NamesWhatIsWrongWithItsKeys) {
  EXPECT_THAT(problemOf(""), HasSubstr("missing key \"Source\" (must be a folder of images"));
  EXPECT_THAT(problemOf("Source=x\nStamps=mine\n"), HasSubstr("Stamps = mine (must be one of: host, own)"));
  EXPECT_THAT(problemOf("Source=rtsp://a/b\nStamps=own\n"), HasSubstr("a stream has no stamps of its own"));
  EXPECT_THAT(problemOf("Source=x\nOpenTimeout_s=0\n"), HasSubstr("OpenTimeout_s = 0 (must be 0.1..60)"));
}

TEST(FittingSize, KeepsTheShape) {
  EXPECT_EQ(fittingSize({640, 480}, {0, 0}), cv::Size(640, 480));
  EXPECT_EQ(fittingSize({640, 480}, {320, 240}), cv::Size(320, 240));
  EXPECT_EQ(fittingSize({640, 480}, {0, 120}), cv::Size(160, 120));
  EXPECT_EQ(fittingSize({640, 480}, {100, 1000}), cv::Size(100, 75));
  EXPECT_EQ(fittingSize({1000, 10}, {10, 10}), cv::Size(10, 1)) << "never nothing";
}

}  // namespace
}  // namespace vismem
