#include "experiments/app/e9_detectors.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <random>
#include <stdexcept>

#include "common/config/project_file.h"
#include "common/config/text_format.h"
#include "common/recording/robot_log.h"
#include "common/segment_map/segment_map.h"
#include "common/vision/app/image_file.h"
#include "common/vision/segment_extractor.h"
#include "evaluation/app/annotated_images.h"
#include "evaluation/app/evaluation_setup.h"
#include "evaluation/core/map_projection.h"
#include "evaluation/core/segment_accuracy.h"
#include "evaluation/figures/board.h"
#include "experiments/app/experiment_files.h"
#include "simulator/app/render_view.h"
#include "simulator/core/renderer.h"
#include "simulator/core/simulation.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;

constexpr Rgb kSegmentColor{20, 50, 230};  // blue, as in the chapter
constexpr Rgb kUnknownColor{150, 155, 162};
constexpr double kCameraNoise = 2.0;  // [grey levels]
constexpr double kMapRange_m = 12.0;
constexpr int kPanel_px = 470;
constexpr int kSmallPanel_px = 400;
constexpr int kLargePanel_px = 640;

/// One image with its known lines.
struct Scene {
  std::string name;
  std::string kind;  ///< "simulated", "real"
  std::string title;
  cv::Mat rgb;
  CameraIntrinsics intrinsics;             ///< without distortion
  std::vector<Segment2> truth;             ///< true lines; empty: not known
  std::shared_ptr<const Palette> palette;  ///< null: no labels, not in figure 10
};

struct SimulatedScene {
  const char* name;
  const char* title;
  Pose2 T_world_robot;
  double tilt_deg;
};
const SimulatedScene kSimulated[] = {
    {"room", "simulated room: white markings on a dark floor", {-2.0, -1.2, 0.4}, -22.0},
    {"corridor", "simulated corridor with doors", {-4.25, -1.5, 1.57}, -12.0},
    {"texture", "simulated room with a textured floor", {-1.8, 0.8, -0.3}, -20.0},
};
/// A photograph of a corridor, and an image of the Nao with the field's lines and a goal.
constexpr const char* kPhotograph = "P1040811";
constexpr std::size_t kNaoFrame = 10;

void addNoise(cv::Mat& image, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, kCameraNoise);
  for (int y = 0; y < image.rows; ++y) {
    for (int x = 0; x < image.cols * image.channels(); ++x) {
      std::uint8_t& value = image.ptr<std::uint8_t>(y)[x];
      value = cv::saturate_cast<std::uint8_t>(value + noise(random));
    }
  }
}

fs::path worldFile(const SimulatedScene& scene) {
  return projectFile(std::string("cfg/worlds/") + scene.name + ".world");
}

Scene simulatedScene(const SimulatedScene& from, std::uint64_t seed) {
  const LoadedWorld loaded = loadWorld(worldFile(from), {});
  Renderer renderer(loaded.world);
  const SimulationConfig robot;
  Scene scene{from.name, "simulated", from.title, {}, robot.cameras.front().intrinsics, {}, nullptr};
  scene.rgb = renderRobotView(renderer, from.T_world_robot, 0.0, degToRad(from.tilt_deg));
  addNoise(scene.rgb, seed);
  const fs::path palette = projectFile(std::string("cfg/maps/") + from.name + ".palette");
  const fs::path map = projectFile(std::string("cfg/maps/") + from.name + ".csv");
  if (fs::exists(palette)) scene.palette = std::make_shared<const Palette>(loadPalette(palette));
  if (fs::exists(map)) {
    const auto stripes = scene.palette ? scene.palette->stripes() : std::map<Label, Label>();
    const Pose3 T_world_camera =
        toPose3(from.T_world_robot) * cameraPose(robot.mount(), 0.0, degToRad(from.tilt_deg));
    scene.truth = projectMap(expandStripes(loadSegmentMap(map), stripes).segments,
                             robot.cameras.front().intrinsics, T_world_camera, kMapRange_m);
  }
  return scene;
}

Scene photographScene(const fs::path& data) {
  const fs::path folder = data / "york_urban_half";
  const auto image = loadAnnotatedImage(folder / (std::string(kPhotograph) + ".jpg"), folder);
  const AnnotatedImage half = atWidth(image, 320);
  return {"photograph",
          "real",
          std::string("real: photograph ") + kPhotograph + " of York Urban",
          half.rgb,
          intrinsicsFromFieldOfView(half.rgb.cols, half.rgb.rows, 1.0),
          half.annotated,
          nullptr};
}

Scene naoScene(const fs::path& data) {
  const RobotLog log = RobotLog::open((data / "nao_field_2009" / "nao_field_2009.bag").string());
  const Frame frame = log.readFrame(std::min(kNaoFrame, log.frameStamps().size() - 1));
  return {"nao",
          "real",
          "real: a Nao's camera on a football field",
          frame.image,
          frame.intrinsics,
          {},
          std::make_shared<const Palette>(loadPalette(projectFile("cfg/maps/field.palette")))};
}

struct Counts {
  std::size_t segments = 0;
  double total_px = 0.0;
  double mean_px() const { return segments > 0 ? total_px / static_cast<double>(segments) : 0.0; }
};

Counts countOf(const std::vector<Segment2>& segments) {
  Counts counts;
  for (const Segment2& px : segments) counts.total_px += px.length();
  counts.segments = segments.size();
  return counts;
}

struct DetectorView {
  const char* name;
  const char* title;
};
constexpr DetectorView kViews[] = {{"hough", "Canny + Hough"},
                                   {"chapter", "Solis as published (chapter)"},
                                   {"solis", "Solis, ours (default)"}};

/// Figure 3: the segments of each detector.
std::vector<BoardPanel> detectedRow(const Scene& scene, nlohmann::json& json, CsvFile& counts, CsvFile& all) {
  std::vector<BoardPanel> row;
  for (const DetectorView& view : kViews) {
    std::vector<RawSegment> found;
    makeSegmentDetector(view.name)->detect(scene.rgb, found);
    std::vector<Segment2> px;
    BoardPanel panel{view.title, {}, scene.rgb, {}};
    for (const RawSegment& segment : found) {
      px.push_back(segment.px_raw);
      panel.segments.push_back({segment.px_raw, kSegmentColor});
      all.row(formatted("%s,%s,%.3f,%.3f,%.3f,%.3f,%.2f", scene.name.c_str(), view.name, segment.px_raw.a.x(),
                        segment.px_raw.a.y(), segment.px_raw.b.x(), segment.px_raw.b.y(), segment.strength));
    }
    const Counts sum = countOf(px);
    nlohmann::json& one = json["detectors"][view.name];
    one = {{"segments", sum.segments}, {"mean_length_px", sum.mean_px()}, {"total_length_px", sum.total_px}};
    panel.caption.push_back(formatted("%zu segments, mean %.0f px", sum.segments, sum.mean_px()));
    std::string known = ",,";
    if (!scene.truth.empty()) {
      const AccuracySummary accuracy = summarize({scoreImage(px, scene.truth)});
      const PrecisionRecall& at2 = accuracy.at[1];
      one["fragments_per_line"] = accuracy.fragments;
      one["recall_2px"] = at2.recall;
      one["precision_2px"] = at2.precision;
      panel.caption.push_back(formatted("found %.0f %% of the known lines, in %.1f pieces each",
                                        100.0 * at2.recall, accuracy.fragments));
      panel.caption.push_back(formatted("%.0f %% of its length is on known lines", 100.0 * at2.precision));
      known = formatted("%.3f,%.3f,%.3f", accuracy.fragments, at2.recall, at2.precision);
    }
    counts.row(formatted("%s,%s,%zu,%.2f,%.1f,", scene.name.c_str(), view.name, sum.segments, sum.mean_px(),
                         sum.total_px) +
               known);
    row.push_back(std::move(panel));
  }
  return row;
}

/// Colours of labels, in the order of their first use.
class LabelColors {
 public:
  Rgb of(const Label& label) {
    if (label == kUnknownLabel) return kUnknownColor;
    const auto known = std::find(labels_.begin(), labels_.end(), label);
    if (known != labels_.end()) return color(static_cast<std::size_t>(known - labels_.begin()));
    labels_.push_back(label);
    return color(labels_.size() - 1);
  }
  std::vector<LegendEntry> legend() const {
    std::vector<LegendEntry> entries;
    for (std::size_t i = 0; i < labels_.size(); ++i) entries.push_back({labels_[i], color(i)});
    entries.push_back({"unknown: not used for localization", kUnknownColor});
    return entries;
  }

 private:
  static Rgb color(std::size_t index) {
    constexpr Rgb kColors[] = {{20, 90, 220}, {210, 40, 40}, {20, 150, 70}, {190, 60, 190},
                               {220, 130, 0}, {0, 150, 170}, {120, 80, 30}, {90, 90, 200}};
    return kColors[index % std::size(kColors)];
  }
  std::vector<Label> labels_;
};

/// Figure 10: labelled segments before and after merging.
void addMerging(const Scene& scene, const std::string& detector, std::vector<BoardPanel>& row,
                nlohmann::json& json, CsvFile& csv, LabelColors& label_colors) {
  ExtractorParams params;
  params.detector = detector;
  SegmentExtractor extractor(params, scene.palette);
  const auto add = [&](const char* stage, const std::vector<ImageSegment>& segments) {
    BoardPanel panel{detector + ", " + stage + " merging", {}, scene.rgb, {}};
    std::vector<Segment2> labelled;
    for (const ImageSegment& segment : segments) {
      panel.segments.push_back({segment.px, label_colors.of(segment.label)});
      if (segment.label != kUnknownLabel) labelled.push_back(segment.px);
    }
    const Counts sum = countOf(labelled);
    const std::size_t unknown = segments.size() - sum.segments;
    json["merging"][detector][stage] = {
        {"labelled", sum.segments}, {"labelled_mean_length_px", sum.mean_px()}, {"unknown", unknown}};
    panel.caption.push_back(
        formatted("%zu with a label, mean %.0f px; %zu unknown", sum.segments, sum.mean_px(), unknown));
    csv.row(formatted("%s,%s,%s,%zu,%.2f,%zu", scene.name.c_str(), detector.c_str(), stage, sum.segments,
                      sum.mean_px(), unknown));
    row.push_back(std::move(panel));
  };
  add("before", extractor.extractPieces(scene.rgb, scene.intrinsics));
  add("after", extractor.extract(scene.rgb, scene.intrinsics));
}

}  // namespace

nlohmann::json compareDetectors(const ExperimentOptions& options) {
  std::vector<Scene> scenes;
  nlohmann::json absent = nlohmann::json::array();
  for (const SimulatedScene& simulated : kSimulated) {
    if (fs::exists(worldFile(simulated))) {
      scenes.push_back(simulatedScene(simulated, options.seed));
    } else {
      absent.push_back(worldFile(simulated).string() + ": not there");
    }
  }
  if (fs::is_directory(options.data / "york_urban_half")) {
    scenes.push_back(photographScene(options.data));
  } else {
    absent.push_back((options.data / "york_urban_half").string() + ": not there");
  }
  if (fs::exists(options.data / "nao_field_2009" / "nao_field_2009.bag")) {
    scenes.push_back(naoScene(options.data));
  } else {
    absent.push_back((options.data / "nao_field_2009").string() + ": not there");
  }

  CsvFile counts(
      options.out / "counts.csv",
      "image,detector,segments,mean_length_px,total_length_px,fragments_per_line,recall_2px,precision_2px");
  CsvFile all(options.out / "segments.csv", "image,detector,x1_px,y1_px,x2_px,y2_px,strength");
  CsvFile merging(options.out / "merging.csv",
                  "image,detector,stage,labelled,labelled_mean_length_px,unknown");
  const std::string noise = formatted("camera noise of %.0f grey levels in simulated images, seed %llu",
                                      kCameraNoise, static_cast<unsigned long long>(options.seed));
  Board figure3{"Canny + Hough beside Solis on the same images (figure 3)",
                "320x240; every line is one segment, dots are its ends; " + noise,
                {},
                {}};
  Board figure10{"Labelled segments before and after merging (figure 10)",
                 "merged: one label, ends close, one line; " + noise,
                 {},
                 {}};
  LabelColors label_colors;
  nlohmann::json images = nlohmann::json::array();
  for (const Scene& scene : scenes) {
    nlohmann::json json{{"image", scene.name}, {"kind", scene.kind}, {"lines_known", !scene.truth.empty()}};
    figure3.rows.push_back(detectedRow(scene, json, counts, all));
    figure3.row_titles.push_back(scene.title);
    writeImageFile(drawBoard({figure3.title, figure3.subtitle, {figure3.rows.back()}, {}, {scene.title}},
                             kLargePanel_px),
                   options.out / ("figure3_" + scene.name + ".png"));
    if (scene.palette) {
      // The published flow leaves more to merge; the default joins collinear runs while it detects.
      std::vector<BoardPanel> row;
      addMerging(scene, "chapter", row, json, merging, label_colors);
      if (options.mode != "chapter") addMerging(scene, "solis", row, json, merging, label_colors);
      figure10.rows.push_back(std::move(row));
      figure10.row_titles.push_back(scene.title);
    }
    images.push_back(std::move(json));
  }
  figure10.legend = label_colors.legend();
  for (CsvFile* file : {&counts, &all, &merging}) file->close();
  writeImageFile(drawBoard(figure3, kPanel_px), options.out / "figure3.png");
  writeImageFile(drawBoard(figure10, kSmallPanel_px), options.out / "figure10.png");
  return {{"images", images}, {"absent", absent}};
}

}  // namespace vismem
