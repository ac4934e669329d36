// Encoding and decoding of images: YUY2 by hand, JPEG headers, wrong sizes (common/image_codec).
#include "common/image_codec/image_codec.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgcodecs.hpp>

#include "common/image_codec/jpeg_header.h"
#include "common/robot/ports.h"

namespace vismem {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

using Bytes = std::vector<std::uint8_t>;

/// Colours change slowly, as in pictures: chroma is shared by neighbours.
cv::Mat smoothPicture(int width, int height) {
  cv::Mat image(height, width, CV_8UC3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image.at<cv::Vec3b>(y, x) = {static_cast<std::uint8_t>(40 + 2 * x),
                                   static_cast<std::uint8_t>(200 - 3 * y),
                                   static_cast<std::uint8_t>(90 + x + y)};
    }
  }
  return image;
}

TEST(ImageCodec, Yuy2OfColoursWorkedOutByHand) {
  // BT.601: white is 235 128 128, black 16 128 128, red 82 90 240 (66 * 255 / 256 + 16 = 82).
  cv::Mat image(1, 4, CV_8UC3, cv::Scalar(255, 0, 0));
  image.at<cv::Vec3b>(0, 2) = {255, 255, 255};
  image.at<cv::Vec3b>(0, 3) = {0, 0, 0};
  EXPECT_THAT(encodeYuy2(image), ElementsAre(82, 90, 82, 240, 235, 128, 16, 128));
}

TEST(ImageCodec, Yuy2OfAnOddWidthPairsTheLastPixelWithItself) {
  cv::Mat image(1, 3, CV_8UC3, cv::Scalar(255, 0, 0));
  image.at<cv::Vec3b>(0, 2) = {255, 255, 255};
  EXPECT_THAT(encodeYuy2(image), ElementsAre(82, 90, 82, 240, 235, 128, 235, 128));
  EXPECT_EQ(yuy2Bytes(3, 1), 8U);
  EXPECT_EQ(yuy2Bytes(4, 2), 16U);
  EXPECT_THAT(encodeYuy2(cv::Mat(1, 1, CV_8UC1, cv::Scalar(0))), ElementsAre(16, 128, 16, 128));
}

TEST(ImageCodec, Yuy2AndBackKeepsColours) {
  for (const int width : {1, 2, 7, 16, 33}) {
    const cv::Mat image = smoothPicture(width, 9);
    const DecodedImage back = decodeImage(NativeImage{NativeFormat::kYuyv, width, 9, 0, encodeYuy2(image)});
    ASSERT_EQ(back.error, "") << width;
    ASSERT_EQ(back.image.size(), image.size());
    // 219 steps for 256 values, chroma of two pixels: within 4 of 255.
    EXPECT_LE(cv::norm(back.image, image, cv::NORM_INF), 4.0) << width;
  }
}

TEST(ImageCodec, UyvyIsYuyvWithItsBytesSwapped) {
  const cv::Mat image = smoothPicture(8, 4);
  Bytes bytes = encodeYuy2(image);
  const cv::Mat yuyv = decodeImage(NativeImage{NativeFormat::kYuyv, 8, 4, 0, bytes}).image;
  for (std::size_t i = 0; i < bytes.size(); i += 2) std::swap(bytes[i], bytes[i + 1]);
  const cv::Mat uyvy = decodeImage(NativeImage{NativeFormat::kUyvy, 8, 4, 0, bytes}).image;
  EXPECT_EQ(cv::norm(yuyv, uyvy, cv::NORM_INF), 0.0);
}

TEST(ImageCodec, Nv12OfRed) {
  const Bytes bytes{82, 82, 82, 82, 82, 82, 82, 82, 90, 240, 90, 240};
  const DecodedImage red = decodeImage(NativeImage{NativeFormat::kNv12, 4, 2, 0, bytes});
  ASSERT_EQ(red.error, "");
  const auto pixel = red.image.at<cv::Vec3b>(1, 3);
  EXPECT_NEAR(pixel[0], 255, 2);
  EXPECT_NEAR(pixel[1], 0, 2);
  EXPECT_NEAR(pixel[2], 0, 2);
  EXPECT_THAT(decodeImage(NativeImage{NativeFormat::kNv12, 3, 2, 0, bytes}).error, HasSubstr("odd sides"));
}

TEST(ImageCodec, PaddedRowsAreRead) {
  const Bytes bytes{1, 2, 3, 99, 4, 5, 6};  // the last row needs no padding
  const DecodedImage gray = decodeImage(NativeImage{NativeFormat::kGray8, 3, 2, 4, bytes});
  ASSERT_EQ(gray.error, "");
  EXPECT_THAT(tightBytes(gray.image), ElementsAre(1, 2, 3, 4, 5, 6));
}

TEST(ImageCodec, WrongSizesAreReasons) {
  for (const NativeFormat format : {NativeFormat::kRgb8, NativeFormat::kGray8, NativeFormat::kYuyv,
                                    NativeFormat::kUyvy, NativeFormat::kNv12}) {
    EXPECT_THAT(decodeImage(NativeImage{format, 4, 4, 0, Bytes(7)}).error, HasSubstr("has 7 bytes of"));
    EXPECT_THAT(decodeImage(NativeImage{format, 4, 4, 1, Bytes(1000)}).error, HasSubstr("bytes of"));
    EXPECT_THAT(decodeImage(NativeImage{format, -4, 4, 0, Bytes(1000)}).error, HasSubstr("-4x4"));
    EXPECT_THAT(decodeImage(NativeImage{format, 100'000, 4, 0, Bytes(1000)}).error, HasSubstr("100000x4"));
  }
  EXPECT_EQ(decodeImageFile({}).error, "is empty");
  EXPECT_EQ(decodeImageFile(Bytes(100, 'x')).error, "cannot be decoded");
}

TEST(ImageCodec, EncodingLeavesThePixelsAsTheyAre) {
  // A frame's pixels are shared with everyone who has it.
  const cv::Mat picture = smoothPicture(32, 16);
  const cv::Mat before = picture.clone();
  encodeJpeg(picture, 80);
  encodeYuy2(picture);
  EXPECT_EQ(cv::norm(picture, before, cv::NORM_INF), 0.0);
}

TEST(ImageCodec, JpegHeaderHasTheSize) {
  const Bytes jpeg = encodeJpeg(smoothPicture(31, 17), 80);
  const JpegHeader header = readJpegHeader(jpeg);
  EXPECT_EQ(header.error, "");
  EXPECT_EQ(header.width, 31);
  EXPECT_EQ(header.height, 17);
  EXPECT_EQ(header.components, 3);
  EXPECT_EQ(readJpegHeader(encodeJpeg(cv::Mat(8, 8, CV_8UC1, cv::Scalar(5)), 80)).components, 1);
  Bytes padded = jpeg;
  padded.resize(padded.size() + 512, 0);
  EXPECT_EQ(readJpegHeader(padded).error, "") << "cameras pad their buffers";
}

TEST(ImageCodec, EveryCutOfAJpegIsNoticed) {
  const Bytes jpeg = encodeJpeg(smoothPicture(31, 17), 80);
  for (std::size_t size = 0; size < jpeg.size(); ++size) {
    const std::span<const std::uint8_t> cut(jpeg.data(), size);
    EXPECT_NE(readJpegHeader(cut).error, "") << size << " of " << jpeg.size();
    EXPECT_NE(decodeImageFile(cut).error, "") << size << " of " << jpeg.size();
  }
  ASSERT_EQ(decodeImageFile(jpeg).error, "");
}

TEST(ImageCodec, AJpegThatClaimsGigabytesIsNotDecoded) {
  Bytes jpeg = encodeJpeg(smoothPicture(31, 17), 80);
  for (std::size_t i = 0; i + 9 < jpeg.size(); ++i) {
    if (jpeg[i] != 0xFF || jpeg[i + 1] != 0xC0) continue;
    jpeg[i + 5] = jpeg[i + 6] = jpeg[i + 7] = jpeg[i + 8] = 0xFF;
    break;
  }
  EXPECT_THAT(decodeImageFile(jpeg).error, HasSubstr("has 65535x65535 pixels (at most 16384 on a side)"));
}

TEST(ImageCodec, FilesKeepGreyGreyAndDropTransparency) {
  Bytes png;
  ASSERT_TRUE(cv::imencode(".png", cv::Mat(2, 3, CV_8UC1, cv::Scalar(7)), png));
  EXPECT_EQ(decodeImageFile(png).image.type(), CV_8UC1);
  ASSERT_TRUE(cv::imencode(".png", cv::Mat(2, 3, CV_8UC4, cv::Scalar(30, 20, 10, 255)), png));
  const cv::Mat image = decodeImageFile(png).image;
  ASSERT_EQ(image.type(), CV_8UC3);
  EXPECT_EQ(image.at<cv::Vec3b>(0, 0), cv::Vec3b(10, 20, 30));
  ASSERT_TRUE(cv::imencode(".png", cv::Mat(2, 3, CV_16UC1, cv::Scalar(0x1234)), png));
  EXPECT_EQ(decodeImageFile(png).image.type(), CV_8UC1);
}

TEST(FrameRequest, AbsurdOnesAreRejectedWithValueAndRule) {
  const auto reason = [](const FrameRequest& request) {
    const auto reply = rejectAbsurd(request);
    return reply ? reply->message : "";
  };
  EXPECT_EQ(reason({}), "");
  EXPECT_EQ(reason({640, 480, 30.0}), "");
  EXPECT_EQ(reason({-1, 480, 30.0}), "width = -1 (must be 0..16384)");
  EXPECT_EQ(reason({640, 20'000, 30.0}), "height = 20000 (must be 0..16384)");
  EXPECT_EQ(reason({640, 480, -1.0}), "rate = -1 Hz (must be 0 or 0.001..10000)");
  EXPECT_THAT(reason({640, 480, std::nan("")}), HasSubstr("rate = nan Hz"));
  EXPECT_THAT(reason({640, 480, HUGE_VAL}), HasSubstr("rate = inf Hz"));
}

}  // namespace
}  // namespace vismem
