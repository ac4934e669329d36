// label_palette: shows the colour classes of an image and its labelled segments (V3).
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "common/config/project_file.h"
#include "common/tool/command_line_tool.h"
#include "common/vision/app/drawing.h"
#include "common/vision/app/image_file.h"
#include "common/vision/palette.h"
#include "common/vision/segment_extractor.h"

namespace {

using namespace vismem;

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

/// "FILE:LINE: class.NAME", the rule that gives a colour its class; "none" without one.
std::string ruleOf(const Palette& palette, const std::string& file, ColorClass color_class) {
  if (color_class == kNoColorClass) return palette.className(color_class);
  return file + ":" + std::to_string(palette.definition(color_class).line) + ": class." +
         palette.className(color_class);
}

/// The colour of a pixel in the palette's terms, and the rules that contain it, the one that took it first.
nlohmann::json placeJson(const cv::Mat& image, const cv::Point& at, const Palette& palette,
                         const std::string& file) {
  const auto& c = image.at<cv::Vec3b>(at);
  const ColorValues values = colorValues(c[0], c[1], c[2]);
  const auto rounded = [](double value) { return std::round(10.0 * value) / 10.0; };
  nlohmann::json rules = nlohmann::json::array();
  for (const ColorClass found : palette.allClassesOf(c[0], c[1], c[2]))
    rules.push_back(ruleOf(palette, file, found));
  return {{"at", {at.x, at.y}},
          {"rgb", {c[0], c[1], c[2]}},
          {"hue", values.has_hue ? nlohmann::json(rounded(values.hue_deg)) : nlohmann::json()},
          {"saturation", rounded(values.saturation_percent)},
          {"value", rounded(values.value_percent)},
          {"class", palette.className(palette.classOf(c[0], c[1], c[2]))},
          {"rules", rules}};
}

/// @throws std::runtime_error for a place outside the image.
nlohmann::json placesJson(const cv::Mat& image, const std::vector<std::pair<int, int>>& places,
                          const Palette& palette, const std::string& file) {
  nlohmann::json result = nlohmann::json::array();
  for (const auto& [u, v] : places) {
    if (u < 0 || v < 0 || u >= image.cols || v >= image.rows) {
      throw std::runtime_error("--at " + std::to_string(u) + " " + std::to_string(v) +
                               " (must be within 0.." + std::to_string(image.cols - 1) + " and 0.." +
                               std::to_string(image.rows - 1) + ")");
    }
    result.push_back(placeJson(image, {u, v}, palette, file));
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

struct Options {
  std::string image;
  std::string palette = vismem::projectFile("cfg/maps/corridor.palette");
  std::string detector = "solis";
  std::filesystem::path out;
  std::vector<std::pair<int, int>> places;  ///< pixels
};

int run(const Options& options) {
  const auto palette = std::make_shared<const Palette>(loadPalette(options.palette));
  const cv::Mat image = readImageFile(options.image);
  if (image.empty()) {
    std::cerr << "label_palette: " << options.image << ": not an image that can be read\n";
    return 1;
  }
  for (const std::string& warning : palette->warnings()) std::cerr << "warning: " << warning << '\n';
  const nlohmann::json places = placesJson(image, options.places, *palette, options.palette);
  const auto intrinsics = intrinsicsFromFieldOfView(image.cols, image.rows, 1.0);  // no distortion: as seen
  ExtractorParams params;
  params.detector = options.detector;
  const auto segments = SegmentExtractor(params, palette).extract(image, intrinsics);
  const ClassPicture classes = classPicture(image, *palette);

  cv::Mat left = magnifiedForDrawing(image);
  cv::Mat right = magnifiedForDrawing(classes.picture);
  std::map<Label, cv::Scalar> colors{{kUnknownLabel, kUnknownColor}};
  std::map<Label, int> counts{{kUnknownLabel, 0}};
  for (const Label& label : palette->labels()) {
    colors.emplace(label, colorOf(static_cast<int>(counts.size()) - 1));
    counts.emplace(label, 0);
  }
  for (const auto& segment : segments) {
    ++counts[segment.label];
    drawSegment(left, image, segment.px, colors[segment.label]);
    if (segment.label != kUnknownLabel) drawSegment(right, image, segment.px, colors[segment.label]);
  }
  std::vector<Entry> labels;
  for (const auto& [label, count] : counts)
    labels.push_back({label + ": " + std::to_string(count), colors[label]});
  std::vector<Entry> shares;
  nlohmann::json class_json = nlohmann::json::object();
  nlohmann::json rules = nlohmann::json::object();
  for (std::size_t i = 0; i < classes.shares.size(); ++i) {
    const std::string& name = palette->className(static_cast<ColorClass>(i));
    char percent[32];
    std::snprintf(percent, sizeof percent, ": %.1f %%", 100.0 * classes.shares[i]);
    shares.push_back({name + percent, classes.colors[i]});
    class_json[name] = classes.shares[i];
    rules[ruleOf(*palette, options.palette, static_cast<ColorClass>(i))] = classes.shares[i];
  }

  std::filesystem::path out = options.out;
  const std::string name = std::filesystem::path(options.image).stem().string() + "_labels.png";
  if (out.empty()) out = std::filesystem::path("out/label_palette") / name;
  if (std::filesystem::is_directory(out)) out /= name;
  writeImageFile(withLegend(left, labels, right, shares), out);
  nlohmann::json summary{{"image", options.image}, {"palette", options.palette},
                         {"out", out.string()},    {"segments", segments.size()},
                         {"labels", counts},       {"class_shares", class_json},
                         {"rules", rules}};
  if (!places.empty()) summary["places"] = places;
  std::cout << summary.dump() << '\n';
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{
      "Shows what a palette makes of an image: left its segments in the colours of their labels (gray: "
      "unknown, not "
      "used for localization), right every colour class in its mean colour (dark: no class). Ticks point to "
      "the "
      "brighter side. A palette is a text file; see cfg/maps/*.palette."};
  app.add_option("IMAGE", options.image, "image to read")->required();
  app.add_option("--palette", options.palette, "palette file")->capture_default_str();
  app.add_option(
         "--at", options.places,
         "pixel U V, repeatable: its colour in the palette's terms, and the rules that contain it, the "
         "one that took it first")
      ->allow_extra_args(false);
  app.add_option("--detector", options.detector, "solis (ours), chapter (published Solis) or hough")
      ->check(CLI::IsMember(vismem::segmentDetectorNames()))
      ->capture_default_str();
  app.add_option("--out", options.out,
                 "picture to write, or a folder for it (default: out/label_palette/IMAGE_labels.png)");
  if (const auto code = vismem::parseTool(app, argc, argv)) return *code;
  try {
    return run(options);
  } catch (const std::exception& error) {
    std::cerr << "label_palette: " << error.what() << '\n';
    return 1;
  }
}
