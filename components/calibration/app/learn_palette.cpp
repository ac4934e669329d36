// learn_palette: a palette from images of a place (V3, B5).
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <opencv2/core.hpp>
#include <optional>
#include <sstream>

#include "calibration/app/clicks_page.h"
#include "calibration/app/lens_images.h"
#include "calibration/app/output_files.h"
#include "calibration/core/colours/palette_learner.h"
#include "common/config/config_error.h"
#include "common/config/text_fields.h"
#include "common/config/text_file.h"
#include "common/config/text_format.h"
#include "common/tool/command_line_tool.h"
#include "common/tool/progress_line.h"
#include "common/vision/app/image_file.h"
#include "common/vision/app/palette_picture.h"
#include "common/vision/segment_extractor.h"
#include "evaluation/core/perturbation.h"

namespace {

using namespace vismem;

constexpr std::size_t kPictures = 3;
constexpr std::size_t kShown = 12;
constexpr const char* kPage = "clicks.html";
constexpr double kKeptNames = 0.9;  // share of the edges that keep their names in another light
constexpr int kLightSteps = 12;
/// Changes of light, from the present value as far as cameras and lamps go.
struct LightChange {
  const char* name;  ///< as Perturbation calls it
  double neutral;
  double least;
  double most;
  void (*set)(Perturbation&, double);
};
constexpr std::array<LightChange, 3> kLights{{
    {"brightness", 1.0, 0.25, 4.0, [](Perturbation& p, double value) { p.brightness = value; }},
    {"white", 6500.0, 2500.0, 16000.0, [](Perturbation& p, double value) { p.white_K = value; }},
    {"gamma", 1.0, 0.5, 2.0, [](Perturbation& p, double value) { p.gamma = value; }},
}};
constexpr double kSecondsStep_s = 0.005;  // of the names of shown images

/// The edges that the memory sees, those between colours of equal brightness among them.
SegmentExtractor makeExtractor(std::shared_ptr<const Palette> palette) {
  ExtractorParams params;
  params.colour_edges = true;
  return {params, std::move(palette)};
}

/// Of any view: nothing here asks for directions.
CameraIntrinsics anyIntrinsics(const cv::Mat& image) {
  return intrinsicsFromFieldOfView(image.cols, image.rows, 1.0);
}

struct Options {
  std::string bag;
  std::string images;
  std::string topic;
  std::string clicks;
  std::filesystem::path out;
  std::filesystem::path picture;
  std::filesystem::path show;
  std::size_t most_images = 80;
  Perturbation perturbation;  ///< of the camera
};

/// A line of the file of clicks.
struct Click {
  std::string where;  ///< file and line, for messages
  std::string name;
  std::string image;                                         ///< as it stands in the file
  double seconds = std::numeric_limits<double>::infinity();  ///< the same, if it is a number
  Eigen::Vector2i px;
  bool is_done = false;
};

std::vector<Click> readClicks(const std::string& file) {
  std::vector<Click> clicks;
  std::vector<std::string> problems;
  std::istringstream lines(readTextFile(file, "a file of clicks"));
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    const std::string content(contentOf(line));
    if (content.empty()) continue;
    std::istringstream words(content);
    Click click;
    click.where = file + ":" + std::to_string(number);
    std::string rest;
    if (!(words >> click.name >> click.image >> click.px.x() >> click.px.y()) || words >> rest) {
      problems.push_back(
          click.where + ": \"" + line +
          "\" (must be NAME IMAGE U V: a class, seconds after the first image or a file of the "
          "folder, and the pixel)");
      continue;
    }
    if (!isName(click.name)) {
      problems.push_back(click.where + ": \"" + click.name +
                         "\" (must be letters, digits and _, and begin with a letter)");
    }
    if (const auto seconds = finiteNumber(click.image)) click.seconds = *seconds;
    clicks.push_back(click);
  }
  if (!problems.empty()) throw ConfigError(problems);
  return clicks;
}

/// The images of a drive: every `step`-th is learnt from, those between them judge; clicks belong to the
/// nearest.
class Lesson {
 public:
  explicit Lesson(const Options& options)
      : options_(options),
        clicks_(options.clicks.empty() ? std::vector<Click>{} : readClicks(options.clicks)) {}

  void run() {
    const auto stream =
        options_.bag.empty() ? imagesOfFolder(options_.images) : imagesOfBag(options_.bag, options_.topic);
    const std::size_t step = std::max<std::size_t>(1, stream->count() / (2 * options_.most_images));
    const bool few = stream->count() < 2 * kPictures;  // the same ones teach and judge
    ProgressLine progress("images");
    std::optional<std::int64_t> first_us;
    for (std::size_t i = 0; auto image = stream->next(); ++i) {
      progress.show(i, stream->count());
      if (image->image.empty()) continue;
      if (image->image.type() != CV_8UC3)
        throw std::runtime_error(image->name + ": is grey (must be in colour)");
      image->image = perturbedImage(options_.perturbation, image->image, i);
      if (!first_us) first_us = image->stamp_us;
      const double age_s = 1e-6 * static_cast<double>(image->stamp_us - *first_us);
      if (!options_.show.empty() &&
          i % std::max<std::size_t>(1, (stream->count() + kShown - 1) / kShown) == 0)
        show(*image, stream->isContinuous() ? formatted("%.2f", age_s) : image->name);
      for (Click& click : clicks_) {
        const bool is_here =
            stream->isContinuous() ? age_s > click.seconds - kSecondsStep_s : image->name == click.image;
        if (is_here && !click.is_done) learnClick(click, image->image);
      }
      if (i % step != 0) continue;
      if (few || i / step % 2 == 0) learnImage(image->image);
      if (few || i / step % 2 == 1) judges_.push_back(image->image);
    }
    requireClicks();
    if (learnt_from_ == 0) throw std::runtime_error("no image could be read");
    writePage({});  // also when nothing can be learnt without clicks
  }

  nlohmann::json finish() {
    const LearntPalette learnt = learner_.learn();
    writeWholeFile(options_.out, learnt.text());
    const auto palette =
        std::make_shared<const Palette>(Palette::parse(learnt.text(), options_.out.string()));
    nlohmann::json summary{{"out", options_.out.string()},
                           {"images", learnt_from_},
                           {"conflict_share", learnt.conflict_share},
                           {"notes", learnt.notes},
                           {"classes", nlohmann::json::array()},
                           {"pairs", nlohmann::json::array()}};
    std::vector<std::string> names;
    for (const LearntClass& one : learnt.classes) {
      names.push_back(one.region.name);
      summary["classes"].push_back(
          {{"name", one.region.name}, {"beside_edges", one.side_share}, {"surface", one.surface_share}});
    }
    writePage(names);
    for (const LearntPair& one : learnt.pairs)
      summary["pairs"].push_back({{"label", one.label}, {"classes", {one.a, one.b}}, {"share", one.share}});
    summary["named_share"] = namedShare(palette);
    summary["holds"] = holds(*palette);
    summary["notes"].push_back(noteOn(summary["holds"]));
    if (!options_.show.empty()) summary["page"] = (options_.show / kPage).string();
    if (!options_.picture.empty()) summary["picture"] = options_.picture.string();
    return summary;
  }

 private:
  /// @param name by which clicks find it: seconds, or a file.
  void show(const StampedImage& image, const std::string& name) {
    writeImageFile(image.image, options_.show / (name == image.name ? name : name + ".png"));
    shown_.push_back({name, image.image});
  }

  void writePage(const std::vector<std::string>& classes) const {
    if (options_.show.empty()) return;
    std::vector<std::string> lines;
    for (const Click& click : clicks_)
      lines.push_back(
          formatted("%s %s %d %d", click.name.c_str(), click.image.c_str(), click.px.x(), click.px.y()));
    writeWholeFile(options_.show / kPage, clicksPage(shown_, classes, lines));
  }

  void learnImage(const cv::Mat& image) {
    extractor_.extract(image, anyIntrinsics(image));
    learner_.addImage(image, extractor_.detected());
    ++learnt_from_;
  }

  void learnClick(Click& click, const cv::Mat& image) {
    if (!cv::Rect({0, 0}, image.size()).contains({click.px.x(), click.px.y()})) {
      throw ConfigError({click.where + ": pixel " + std::to_string(click.px.x()) + " " +
                         std::to_string(click.px.y()) + " (must be within 0.." +
                         std::to_string(image.cols - 1) + " and 0.." + std::to_string(image.rows - 1) + ")"});
    }
    learner_.addClick(click.name, image, click.px);
    click.is_done = true;
  }

  void requireClicks() const {
    std::vector<std::string> missed;
    for (const Click& click : clicks_) {
      if (click.is_done) continue;
      missed.push_back(click.where + ": no image \"" + click.image +
                       "\" (must be seconds within the recording, or the name of a file of the folder)");
    }
    if (!missed.empty()) throw ConfigError(missed);
  }

  /// Of each change of light the two values between which most edges keep their names.
  nlohmann::json holds(const Palette& palette) const {
    const auto keeps = [&](void (*set)(Perturbation&, double), double value) {
      Perturbation light;
      set(light, value);
      return learner_.keptNames(palette, [&](const cv::Mat& image) {
        return perturbedImage(light, image, 0);
      }) >= kKeptNames;
    };
    nlohmann::json ranges;
    for (const auto& [name, neutral, least, most, set] : kLights) {
      std::array<double, 2> range{neutral, neutral};
      for (std::size_t end = 0; end < 2; ++end) {
        const double step = std::pow((end == 0 ? least : most) / neutral, 1.0 / kLightSteps);
        for (int i = 1; i <= kLightSteps && keeps(set, neutral * std::pow(step, i)); ++i)
          range[end] = neutral * std::pow(step, i);
      }
      ranges[name] = range;
    }
    return ranges;
  }

  static std::string noteOn(const nlohmann::json& holds) {
    const auto end = [&](const char* name, int i) {
      return holds[name][static_cast<std::size_t>(i)].get<double>();
    };
    return formatted(
        "nine of ten edges keep their names while images are %.2f to %.2f times as bright, "
        "the light has %.0f to %.0f K (6500: as now), and gamma is %.2f to %.2f: "
        "keep exposure and white balance locked within that",
        end("brightness", 0), end("brightness", 1), end("white", 0), end("white", 1), end("gamma", 0),
        end("gamma", 1));
  }

  /// Of the edges' length in images that were not learnt from. Writes the picture, if one is wanted.
  double namedShare(const std::shared_ptr<const Palette>& palette) {
    SegmentExtractor extractor = makeExtractor(palette);
    double all_px = 0.0;
    double named_px = 0.0;
    cv::Mat figure;
    for (std::size_t i = 0; i < judges_.size(); ++i) {
      const cv::Mat& image = judges_[i];
      const auto segments = extractor.extract(image, anyIntrinsics(image));
      for (const ImageSegment& segment : segments) {
        all_px += segment.px.length();
        if (segment.label != kUnknownLabel) named_px += segment.px.length();
      }
      const std::size_t every = std::max<std::size_t>(1, judges_.size() / kPictures);
      if (options_.picture.empty() || i % every != every / 2) continue;
      const cv::Mat view = picturePalette(image, *palette, segments).figure;
      if (figure.empty())
        figure = view;
      else
        cv::vconcat(figure, view, figure);
    }
    if (!figure.empty()) writeImageFile(figure, options_.picture);
    return all_px > 0.0 ? named_px / all_px : 0.0;
  }

  const Options& options_;
  std::vector<Click> clicks_;
  SegmentExtractor extractor_ = makeExtractor(nullptr);
  PaletteLearner learner_;
  std::vector<cv::Mat> judges_;
  std::vector<ClickableImage> shown_;
  std::size_t learnt_from_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app{
      "Learns a palette from images of a place: clusters of the colours beside edges and of surfaces. "
      "Without clicks the "
      "names are guesses: the floor is what fills the lower part of the images. A file of clicks has a line "
      "for each: "
      "NAME IMAGE U V, with the class, the seconds after the first image (or a file of the folder) and the "
      "pixel; the class ignored names no edge. Lock "
      "exposure and white balance of the camera. The last line is JSON (docs/colours.md)."};
  auto* bag = app.add_option("--bag", options.bag,
                             "a recording: ROS 1 bag, several with commas between, or a folder of them");
  auto* images = app.add_option("--images", options.images, "or a folder of images")->excludes(bag);
  app.add_option("--topic", options.topic, "of the images, when a recording has several")->needs(bag);
  app.add_option("--clicks", options.clicks, "what is what: a file of clicks");
  app.add_option("--out", options.out, "palette to write")->required();
  app.add_option(
      "--show", options.show,
      "folder to write twelve images into, and clicks.html: open it in a browser, click, and save the "
      "file of clicks");
  app.add_option("--picture", options.picture, "picture to write: what the palette makes of three images");
  app.add_option("--most-images", options.most_images, "to learn from, spread over all")
      ->check(CLI::Range(2, 10000))
      ->capture_default_str();
  std::string perturb;
  app.add_option("--perturb", perturb, "the camera: as of evaluate")->check([](const std::string& text) {
    return parsePerturbation(text).error;
  });
  if (const auto code = vismem::parseTool(app, argc, argv)) return *code;
  if (bag->count() + images->count() == 0) {
    std::cerr << "learn_palette: expected --bag FILE or --images FOLDER\n";
    return vismem::kExitUsage;
  }
  options.perturbation = parsePerturbation(perturb).perturbation;
  try {
    Lesson lesson(options);
    lesson.run();
    const nlohmann::json summary = lesson.finish();
    for (const auto& note : summary["notes"])
      std::cerr << "learn_palette: " << note.get<std::string>() << "\n";
    std::cout << summary.dump() << std::endl;
    return 0;
  } catch (const vismem::ConfigError& error) {
    std::cerr << error.what() << "\n";
    return vismem::kExitUsage;
  } catch (const std::exception& error) {
    std::cerr << "learn_palette: " << error.what() << "\n";
    return 1;
  }
}
