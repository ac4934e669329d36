// The pure parts of the driver of V4L2 cameras: formats, the choice of a mode, motion JPEG.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <linux/videodev2.h>

#include <opencv2/core.hpp>

#include "common/image_codec/image_codec.h"
#include "common/image_codec/jpeg_header.h"
#include "common/v4l2/v4l2_controls.h"
#include "drivers/camera_v4l2/motion_jpeg.h"
#include "drivers/camera_v4l2/stream_mode.h"

namespace vismem {
namespace {

using v4l2::Choice;
using v4l2::Interval;
using v4l2::Mode;
using v4l2::PictureLayout;

Mode mode(std::uint32_t fourcc, int width, int height, std::vector<unsigned> rates_hz) {
  Mode result;
  result.format = *v4l2::formatOf(fourcc);
  result.width = width;
  result.height = height;
  for (const unsigned rate : rates_hz) result.rates.push_back({1, rate});
  return result;
}

/// Red on the left, blue on the right, each two pixels wide, in the bytes of each format.
struct Example {
  std::uint32_t fourcc;
  int stride;
  std::vector<std::uint8_t> bytes;
};

class Formats : public testing::TestWithParam<Example> {};

// BT.601, Y in 16..235: red is Y 82, U 90, V 240; blue is Y 41, U 240, V 110.
INSTANTIATE_TEST_SUITE_P(
    V4l2, Formats,
    testing::Values(Example{V4L2_PIX_FMT_YUYV,
                            8,
                            {82, 90, 82, 240, 41, 240, 41, 110,  //
                             82, 90, 82, 240, 41, 240, 41, 110}},
                    Example{V4L2_PIX_FMT_YUYV,
                            10,
                            {82, 90, 82, 240, 41, 240, 41, 110, 0, 0,  //
                             82, 90, 82, 240, 41, 240, 41, 110}},
                    Example{V4L2_PIX_FMT_UYVY,
                            8,
                            {90, 82, 240, 82, 240, 41, 110, 41,  //
                             90, 82, 240, 82, 240, 41, 110, 41}},
                    Example{V4L2_PIX_FMT_NV12, 4, {82, 82, 41, 41, 82, 82, 41, 41, 90, 240, 240, 110}},
                    Example{V4L2_PIX_FMT_RGB24, 12, {255, 0, 0, 255, 0, 0, 0, 0, 255, 0, 0, 255,  //
                                                     255, 0, 0, 255, 0, 0, 0, 0, 255, 0, 0, 255}},
                    Example{V4L2_PIX_FMT_BGR24, 13, {0, 0, 255, 0, 0, 255, 255, 0, 0, 255, 0, 0, 9,  //
                                                     0, 0, 255, 0, 0, 255, 255, 0, 0, 255, 0, 0}}),
    [](const auto& which) {
      return v4l2::fourccText(which.param.fourcc) + "_" + std::to_string(which.param.stride);
    });

TEST_P(Formats, BecomeTheSamePixels) {
  const PictureLayout layout{*v4l2::formatOf(GetParam().fourcc), 4, 2, GetParam().stride};
  std::string problem;
  const auto picture = v4l2::pictureOf(layout, GetParam().bytes, problem);
  ASSERT_TRUE(picture) << problem;
  const DecodedImage decoded = decodeImage(*picture);
  ASSERT_EQ(decoded.error, "");
  ASSERT_EQ(decoded.image.size(), cv::Size(4, 2));
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 4; ++x) {
      const auto pixel = decoded.image.at<cv::Vec3b>(y, x);
      // Whole numbers of Y, U, V are within 3 of the colour.
      EXPECT_NEAR(pixel[0], x < 2 ? 255 : 0, 3) << x << " " << y;
      EXPECT_NEAR(pixel[1], 0, 3);
      EXPECT_NEAR(pixel[2], x < 2 ? 0 : 255, 3);
    }
  }
}

TEST_P(Formats, RefuseABufferThatIsNotFull) {
  const PictureLayout layout{*v4l2::formatOf(GetParam().fourcc), 4, 2, GetParam().stride};
  auto bytes = GetParam().bytes;
  const std::string whole = std::to_string(bytes.size());
  bytes.pop_back();
  std::string problem;
  EXPECT_FALSE(v4l2::pictureOf(layout, bytes, problem));
  EXPECT_EQ(problem, "has " + std::to_string(bytes.size()) + " bytes of " + whole);
}

TEST(V4l2Formats, GreyStaysGrey) {
  std::string problem;
  const auto picture = v4l2::pictureOf({*v4l2::formatOf(V4L2_PIX_FMT_GREY), 2, 1, 0},
                                       std::vector<std::uint8_t>{7, 9}, problem);
  ASSERT_TRUE(picture);
  EXPECT_EQ(decodeImage(*picture).image.type(), CV_8UC1);
  EXPECT_EQ(v4l2::formatOf(V4L2_PIX_FMT_H264), nullptr);
  EXPECT_EQ(v4l2::fourccText(V4L2_PIX_FMT_H264), "H264");
  EXPECT_EQ(v4l2::fourccText(0x01020304), "????");
}

std::vector<std::uint8_t> jpeg(int width, int height) {
  cv::Mat image(height, width, CV_8UC3);
  for (int x = 0; x < width; ++x) image.col(x).setTo(cv::Scalar(5 * x, 90, 255 - 5 * x));
  return encodeJpeg(image, 90);
}

/// Without the segments of its Huffman tables.
std::vector<std::uint8_t> withoutTables(const std::vector<std::uint8_t>& file) {
  std::vector<std::uint8_t> bytes(file.begin(), file.begin() + 2);
  std::size_t at = 2;
  while (file[at + 1] != 0xDA) {
    const std::size_t end = at + 2 + (static_cast<std::size_t>(file[at + 2]) << 8U | file[at + 3]);
    if (file[at + 1] != 0xC4)
      bytes.insert(bytes.end(), file.begin() + static_cast<long>(at), file.begin() + static_cast<long>(end));
    at = end;
  }
  bytes.insert(bytes.end(), file.begin() + static_cast<long>(at), file.end());
  return bytes;
}

TEST(MotionJpeg, StaysByteForByteIfItIsWhole) {
  const auto file = jpeg(32, 16);
  auto bytes = file;
  v4l2::completeJpeg(bytes);
  EXPECT_EQ(bytes, file);
}

TEST(MotionJpeg, GetsTheStandardsTablesWhereItHasNone) {
  const auto file = jpeg(32, 16);
  auto bytes = withoutTables(file);
  ASSERT_LT(bytes.size(), file.size());
  v4l2::completeJpeg(bytes);
  const DecodedImage decoded = decodeImage({NativeFormat::kJpeg, 32, 16, 0, bytes});
  ASSERT_EQ(decoded.error, "");
  const DecodedImage original = decodeImage({NativeFormat::kJpeg, 32, 16, 0, file});
  EXPECT_EQ(cv::norm(decoded.image, original.image, cv::NORM_INF), 0.0);
}

TEST(MotionJpeg, LosesWhatStandsBehindIt) {
  const auto file = jpeg(32, 16);
  auto bytes = file;
  bytes.insert(bytes.end(), {1, 2, 3, 0, 0});
  EXPECT_NE(readJpegHeader(bytes).error, "") << "other readers take that for a broken file";
  v4l2::completeJpeg(bytes);
  EXPECT_EQ(bytes, file);
}

TEST(MotionJpeg, LeavesGarbageAlone) {
  for (const std::vector<std::uint8_t>& garbage : {std::vector<std::uint8_t>{},
                                                   {0xFF},
                                                   {0xFF, 0xD8},
                                                   {0xFF, 0xD8, 0xFF, 0xE0, 0xFF, 0xFF, 1, 2},
                                                   {0, 1, 2, 3, 4, 5}}) {
    auto bytes = garbage;
    v4l2::completeJpeg(bytes);
    EXPECT_EQ(bytes, garbage);
  }
}

TEST(MotionJpeg, OfAnotherSizeOrCutShortIsNoPicture) {
  const PictureLayout layout{*v4l2::formatOf(V4L2_PIX_FMT_MJPEG), 32, 16, 0};
  std::string problem;
  EXPECT_FALSE(v4l2::pictureOf(layout, jpeg(16, 16), problem));
  EXPECT_EQ(problem, "has 16x16 pixels, not the 32x16 of the others");
  auto bytes = jpeg(32, 16);
  bytes.resize(bytes.size() / 2);
  EXPECT_FALSE(v4l2::pictureOf(layout, bytes, problem));
  EXPECT_THAT(problem, testing::HasSubstr("cut short"));
}

/// The modes of a usual USB 2 webcam: large raw images at low rates only.
std::vector<Mode> webcam() {
  return {mode(V4L2_PIX_FMT_MJPEG, 1280, 720, {30, 15}), mode(V4L2_PIX_FMT_MJPEG, 640, 480, {30}),
          mode(V4L2_PIX_FMT_YUYV, 640, 480, {30, 15}), mode(V4L2_PIX_FMT_YUYV, 1280, 720, {10, 5}),
          mode(V4L2_PIX_FMT_YUYV, 320, 240, {30})};
}

TEST(V4l2Mode, IsTheUsualOneWhereAllIsLeftOpen) {
  const Choice choice = v4l2::chooseMode(webcam(), {});
  EXPECT_STREQ(choice.mode.format.name, "YUYV");
  EXPECT_EQ(choice.mode.width, 640);
  EXPECT_EQ(choice.interval.rate_hz(), 30.0);
}

TEST(V4l2Mode, IsCompressedOnlyWhereRawIsTooSlow) {
  EXPECT_STREQ(v4l2::chooseMode(webcam(), {1280, 720, 30.0}).mode.format.name, "MJPEG");
  EXPECT_STREQ(v4l2::chooseMode(webcam(), {1280, 720, 0.0}).mode.format.name, "MJPEG");
  const Choice slow = v4l2::chooseMode(webcam(), {1280, 720, 10.0});
  EXPECT_STREQ(slow.mode.format.name, "YUYV");
  EXPECT_EQ(slow.interval.rate_hz(), 10.0);
}

TEST(V4l2Mode, HasTheNearestSizeBeforeAnythingElse) {
  const Choice choice = v4l2::chooseMode(webcam(), {300, 200, 30.0});
  EXPECT_EQ(choice.mode.width, 320);
  EXPECT_EQ(v4l2::chooseMode(webcam(), {0, 700, 0.0}).mode.width, 1280);
}

TEST(V4l2Mode, TakesAnyRateOfARange) {
  Mode range = mode(V4L2_PIX_FMT_GREY, 64, 48, {});
  range.fastest = Interval{1, 60};
  range.slowest = Interval{1, 1};
  EXPECT_NEAR(v4l2::chooseMode({range}, {0, 0, 29.97}).interval.rate_hz(), 29.97, 1e-9);
  EXPECT_EQ(v4l2::chooseMode({range}, {0, 0, 90.0}).interval.rate_hz(), 60.0);
  EXPECT_EQ(v4l2::chooseMode({range}, {0, 0, 0.1}).interval.rate_hz(), 1.0);
  const Mode untold = mode(V4L2_PIX_FMT_GREY, 64, 48, {});
  EXPECT_EQ(v4l2::chooseMode({untold}, {}).interval.rate_hz(), 0.0);
  EXPECT_EQ(v4l2::chooseMode({untold}, {0, 0, 12.5}).interval.rate_hz(), 12.5);
}

TEST(V4l2Mode, KeepsToStepsOfSizes) {
  EXPECT_EQ(v4l2::nearestInSteps(330, 16, 640, 16), 336);
  EXPECT_EQ(v4l2::nearestInSteps(9999, 16, 650, 16), 640);
  EXPECT_EQ(v4l2::nearestInSteps(1, 16, 640, 16), 16);
  EXPECT_EQ(v4l2::nearestInSteps(333, 1, 640, 1), 333);
  EXPECT_EQ(v4l2::nearestInSteps(333, 16, 640, 0), 333) << "of any size";
}

TEST(V4l2Mode, AnswersWhatBecameOfTheRequest) {
  EXPECT_EQ(v4l2::replyTo({640, 480, 30.0}, 640, 480, 30.0).kind, PortReply::Kind::kAccepted);
  EXPECT_EQ(v4l2::replyTo({}, 640, 480, 0.0).kind, PortReply::Kind::kAccepted);
  EXPECT_EQ(v4l2::replyTo({320, 240, 25.0}, 320, 180, 30.0).message,
            "320x180, the nearest that the camera offers; 30 Hz, the nearest that the camera offers");
  EXPECT_EQ(v4l2::replyTo({0, 0, 25.0}, 320, 180, 0.0).message, "the rate is the camera's own");
}

TEST(V4l2Controls, AreNamedAsV4l2CtlNamesThem) {
  EXPECT_EQ(controlName("Exposure Time, Absolute"), "exposure_time_absolute");
  EXPECT_EQ(controlName("White Balance, Automatic"), "white_balance_automatic");
  EXPECT_EQ(controlName("LED1 Mode"), "led1_mode");
  EXPECT_EQ(controlName(" (Gain) "), "gain");
}

}  // namespace
}  // namespace vismem
