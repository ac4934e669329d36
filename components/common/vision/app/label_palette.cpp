// label_palette: what a palette makes of an image: its colour classes and its labelled segments (V3).
#include <CLI/CLI.hpp>
#include <exception>
#include <iostream>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/vision/app/drawing.h"
#include "common/vision/palette.h"
#include "common/vision/segment_extractor.h"

namespace {

using namespace vismem;

/// Distinct colours by turning the hue by the golden angle.
cv::Scalar colorOf(int index) {
  cv::Mat hsv(1, 1, CV_8UC3, cv::Scalar((index * 68 + 5) % 180, 230, 255));
  cv::cvtColor(hsv, hsv, cv::COLOR_HSV2BGR);
  const auto& bgr = hsv.at<cv::Vec3b>(0, 0);
  return {static_cast<double>(bgr[0]), static_cast<double>(bgr[1]), static_cast<double>(bgr[2])};
}

/// Classes as flat colours (their own mean in the image); pixels of no class dark.
cv::Mat classPicture(const cv::Mat& image, const Palette& palette) {
  std::vector<cv::Vec3d> sum(palette.classCount() + 1);
  std::vector<int> count(sum.size(), 0);
  cv::Mat classes(image.size(), CV_8UC1);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const auto& c = image.at<cv::Vec3b>(y, x);
      const ColorClass found = palette.classOf(c[0], c[1], c[2]);
      classes.at<std::uint8_t>(y, x) = found;
      sum[found] += cv::Vec3d(c[0], c[1], c[2]);
      ++count[found];
    }
  }
  cv::Mat picture(image.size(), CV_8UC3, cv::Scalar(30, 30, 30));
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const ColorClass found = classes.at<std::uint8_t>(y, x);
      if (found == kNoColorClass) continue;
      const cv::Vec3d mean = sum[found] / count[found];
      picture.at<cv::Vec3b>(y, x) =
          cv::Vec3b(cv::saturate_cast<std::uint8_t>(mean[0]), cv::saturate_cast<std::uint8_t>(mean[1]),
                    cv::saturate_cast<std::uint8_t>(mean[2]));
    }
  }
  return picture;
}

int run(const std::string& image_file, const std::string& palette_file, const std::string& detector,
        const std::string& out) {
  const auto palette = std::make_shared<const Palette>(loadPalette(palette_file));
  cv::Mat image = cv::imread(image_file, cv::IMREAD_COLOR);
  if (image.empty()) {
    std::cerr << "label_palette: " << image_file << ": not an image that can be read\n";
    return 1;
  }
  cv::cvtColor(image, image, cv::COLOR_BGR2RGB);
  const auto intrinsics = intrinsicsFromFieldOfView(image.cols, image.rows, 1.0);  // no distortion: as seen
  ExtractorParams params;
  params.detector = detector;
  const auto segments = SegmentExtractor(params, palette).extract(image, intrinsics);

  cv::Mat left = magnifiedForDrawing(image);
  cv::Mat right = magnifiedForDrawing(classPicture(image, *palette));
  const auto labels = palette->labels();
  std::map<Label, int> counts;
  for (const auto& segment : segments) {
    ++counts[segment.label];
    cv::Scalar color(160, 160, 160);
    for (std::size_t i = 0; i < labels.size(); ++i) {
      if (labels[i] == segment.label) color = colorOf(static_cast<int>(i));
    }
    drawSegment(left, image, segment.px, color);
    if (segment.label != kUnknownLabel) drawSegment(right, image, segment.px, color);
  }
  int line_y = 20;
  for (std::size_t i = 0; i < labels.size(); ++i, line_y += 20) {
    cv::putText(left, labels[i] + ": " + std::to_string(counts[labels[i]]), {8, line_y},
                cv::FONT_HERSHEY_SIMPLEX, 0.5, colorOf(static_cast<int>(i)), 1, cv::LINE_AA);
  }
  cv::putText(left, "unknown: " + std::to_string(counts[kUnknownLabel]), {8, line_y},
              cv::FONT_HERSHEY_SIMPLEX, 0.5, cv::Scalar(160, 160, 160), 1, cv::LINE_AA);
  cv::Mat both;
  cv::hconcat(left, right, both);
  if (!cv::imwrite(out, both)) {
    std::cerr << "label_palette: " << out << ": cannot be written\n";
    return 1;
  }
  std::cout << "{\"segments\": " << segments.size() << ", \"labels\": {";
  const char* comma = "";
  for (const auto& [label, count] : counts) {
    std::cout << comma << '"' << label << "\": " << count;
    comma = ", ";
  }
  std::cout << "}}\n";
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  std::string image;
  std::string palette;
  std::string detector = "solis";
  std::string out;
  CLI::App app{
      "Shows an image's colour classes and labelled segments: left the image with its segments (gray: "
      "unknown), right every class in its mean colour (dark: no class)."};
  app.add_option("IMAGE", image, "image to read")->required();
  app.add_option("--palette", palette, "palette file")->required();
  app.add_option("--detector", detector, "solis, chapter or hough")
      ->check(CLI::IsMember(vismem::segmentDetectorNames()));
  app.add_option("--out", out, "PNG to write")->required();
  CLI11_PARSE(app, argc, argv);
  try {
    return run(image, palette, detector, out);
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
