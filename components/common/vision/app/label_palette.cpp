// label_palette: shows the colour classes of an image and its labelled segments (V3).
#include <cmath>
#include <exception>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/config/config_error.h"
#include "common/config/project_file.h"
#include "common/tool/command_line_tool.h"
#include "common/vision/app/image_file.h"
#include "common/vision/app/palette_picture.h"
#include "common/vision/palette.h"
#include "common/vision/segment_extractor.h"

namespace {

using namespace vismem;

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
      throw ConfigError({"--at " + std::to_string(u) + " " + std::to_string(v) + " (must be within 0.." +
                         std::to_string(image.cols - 1) + " and 0.." + std::to_string(image.rows - 1) + ")"});
    }
    result.push_back(placeJson(image, {u, v}, palette, file));
  }
  return result;
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
  for (const std::string& warning : palette->warnings()) std::cerr << "warning: " << warning << '\n';
  const nlohmann::json places = placesJson(image, options.places, *palette, options.palette);
  const auto intrinsics = intrinsicsFromFieldOfView(image.cols, image.rows, 1.0);  // no distortion: as seen
  ExtractorParams params;
  params.detector = options.detector;
  const auto segments = SegmentExtractor(params, palette).extract(image, intrinsics);
  const PalettePicture picture = picturePalette(image, *palette, segments);
  nlohmann::json class_json = nlohmann::json::object();
  nlohmann::json rules = nlohmann::json::object();
  for (std::size_t i = 0; i < picture.class_shares.size(); ++i) {
    const std::string& name = palette->className(static_cast<ColorClass>(i));
    class_json[name] = class_json.value(name, 0.0) + picture.class_shares[i];
    rules[ruleOf(*palette, options.palette, static_cast<ColorClass>(i))] = picture.class_shares[i];
  }

  std::filesystem::path out = options.out;
  const std::string name = std::filesystem::path(options.image).stem().string() + "_labels.png";
  if (out.empty()) out = std::filesystem::path("out/label_palette") / name;
  if (std::filesystem::is_directory(out)) out /= name;
  writeImageFile(picture.figure, out);
  nlohmann::json summary{{"image", options.image},
                         {"palette", options.palette},
                         {"out", out.string()},
                         {"segments", segments.size()},
                         {"labels", picture.label_counts},
                         {"class_shares", class_json},
                         {"rules", rules}};
  const auto off_floor = palette->labelsOffFloor();
  summary["labels_off_floor"] = off_floor ? nlohmann::json(*off_floor) : nlohmann::json();
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
  } catch (const vismem::ConfigError& error) {
    std::cerr << error.what() << '\n';
    return vismem::kExitUsage;
  } catch (const std::exception& error) {
    std::cerr << "label_palette: " << error.what() << '\n';
    return 1;
  }
}
