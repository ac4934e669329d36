#include "common/vision/app/palette_picture.h"

#include <cstdio>
#include <opencv2/imgproc.hpp>

#include "common/config/text_format.h"
#include "common/vision/app/drawing.h"

namespace vismem {
namespace {

constexpr int kLine_px = 24;
constexpr int kSwatch_px = 16;
constexpr int kText_px = 8;
const cv::Scalar kUnknownColor(150, 150, 150);
const cv::Scalar kInk(30, 30, 30);

/// Distinct colours by turning the hue by the golden angle.
cv::Scalar colorOf(int index) {
  cv::Mat hsv(1, 1, CV_8UC3, cv::Scalar((index * 68 + 5) % 180, 230, 255));
  cv::cvtColor(hsv, hsv, cv::COLOR_HSV2RGB);
  const auto& rgb = hsv.at<cv::Vec3b>(0, 0);
  return {static_cast<double>(rgb[0]), static_cast<double>(rgb[1]), static_cast<double>(rgb[2])};
}

/// Classes as flat colours, each its own mean in the image; pixels of no class dark.
struct ClassPicture {
  cv::Mat picture;
  std::vector<cv::Scalar> colors;  ///< by class
  std::vector<double> shares;      ///< of the image's pixels, by class
};

ClassPicture classPicture(const cv::Mat& image, const Palette& palette) {
  const auto count = static_cast<std::size_t>(palette.classCount()) + 1;
  std::vector<cv::Vec3d> sum(count);
  ClassPicture result{cv::Mat(image.size(), CV_8UC3), std::vector<cv::Scalar>(count),
                      std::vector<double>(count, 0.0)};
  cv::Mat classes(image.size(), CV_8UC1);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const auto& c = image.at<cv::Vec3b>(y, x);
      const ColorClass found = palette.classOf(c[0], c[1], c[2]);
      classes.at<std::uint8_t>(y, x) = found;
      sum[found] += cv::Vec3d(c[0], c[1], c[2]);
      result.shares[found] += 1.0;
    }
  }
  for (std::size_t i = 0; i < count; ++i) {
    const cv::Vec3d mean =
        i == kNoColorClass || result.shares[i] == 0.0 ? cv::Vec3d(30, 30, 30) : sum[i] / result.shares[i];
    result.colors[i] = cv::Scalar(mean[0], mean[1], mean[2]);
    result.shares[i] /= static_cast<double>(image.total());
  }
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols; ++x) {
      const cv::Scalar& color = result.colors[classes.at<std::uint8_t>(y, x)];
      result.picture.at<cv::Vec3b>(y, x) =
          cv::Vec3b(cv::saturate_cast<std::uint8_t>(color[0]), cv::saturate_cast<std::uint8_t>(color[1]),
                    cv::saturate_cast<std::uint8_t>(color[2]));
    }
  }
  return result;
}

/// Text beside a swatch of its colour.
struct Entry {
  std::string text;
  cv::Scalar color;
};

void drawEntries(cv::Mat& canvas, const std::vector<Entry>& entries, int left, int top) {
  for (const Entry& entry : entries) {
    const cv::Rect swatch(left + kText_px, top + (kLine_px - kSwatch_px) / 2, kSwatch_px, kSwatch_px);
    cv::rectangle(canvas, swatch, entry.color, cv::FILLED);
    cv::rectangle(canvas, swatch, kInk);
    cv::putText(canvas, entry.text, {swatch.br().x + kText_px, top + kLine_px - 7}, cv::FONT_HERSHEY_SIMPLEX,
                0.5, kInk, 1, cv::LINE_AA);
    top += kLine_px;
  }
}

/// Two pictures side by side, each above its entries.
cv::Mat withLegend(const cv::Mat& left, const std::vector<Entry>& below_left, const cv::Mat& right,
                   const std::vector<Entry>& below_right) {
  cv::Mat figure;
  cv::hconcat(left, right, figure);
  const auto lines = static_cast<int>(std::max(below_left.size(), below_right.size()));
  cv::copyMakeBorder(figure, figure, 0, kLine_px * lines + kText_px, 0, 0, cv::BORDER_CONSTANT,
                     cv::Scalar::all(255));
  drawEntries(figure, below_left, 0, left.rows + kText_px / 2);
  drawEntries(figure, below_right, left.cols, left.rows + kText_px / 2);
  return figure;
}

}  // namespace

PalettePicture picturePalette(const cv::Mat& image, const Palette& palette,
                              const std::vector<ImageSegment>& segments) {
  const ClassPicture classes = classPicture(image, palette);
  PalettePicture result;
  result.class_shares = classes.shares;
  cv::Mat left = magnifiedForDrawing(image);
  cv::Mat right = magnifiedForDrawing(classes.picture);
  std::map<Label, cv::Scalar> colors{{kUnknownLabel, kUnknownColor}};
  result.label_counts[kUnknownLabel] = 0;
  for (const Label& label : palette.labels()) {
    colors.emplace(label, colorOf(static_cast<int>(colors.size()) - 1));
    result.label_counts[label] = 0;
  }
  for (const auto& segment : segments) {
    ++result.label_counts[segment.label];
    drawSegment(left, image, segment.px, colors[segment.label]);
    if (segment.label != kUnknownLabel) drawSegment(right, image, segment.px, colors[segment.label]);
  }
  std::vector<Entry> labels;
  for (const auto& [label, count] : result.label_counts)
    labels.push_back({label + ": " + std::to_string(count), colors[label]});
  std::vector<Entry> shares;
  for (std::size_t i = 0; i < classes.shares.size(); ++i) {
    shares.push_back(
        {palette.className(static_cast<ColorClass>(i)) + formatted(": %.1f %%", 100.0 * classes.shares[i]),
         classes.colors[i]});
  }
  result.figure = withLegend(left, labels, right, shares);
  return result;
}

}  // namespace vismem
