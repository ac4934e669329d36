
#include <cmath>
#include <iomanip>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <sstream>

#include "calibration/app/commands.h"
#include "calibration/app/lens_folder.h"
#include "calibration/app/lens_images.h"
#include "calibration/core/target/board_detector.h"
#include "calibration/core/target/board_file.h"
#include "common/config/config_error.h"
#include "common/config/text_file.h"
#include "common/tool/command_line_tool.h"
#include "common/tool/progress_line.h"

namespace vismem {
namespace {

struct LensOptions {
  std::filesystem::path board;
  std::vector<double> ruler_mm;
  std::string images;
  std::string bag;
  std::string topic;
  std::string camera;
  double seconds = 0.0;
  std::filesystem::path out;
  std::string name = "camera";
  bool is_for_programs = false;
  double camera_height_m = 0.45;
  LensSessionParams session;
};

std::string rounded(double value, int digits) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(digits) << value;
  return text.str();
}

BoardSpec readBoard(const LensOptions& options) {
  BoardFile board = parseBoardFile(readTextFile(options.board, "a board that calibrate target wrote"),
                                   options.board.string());
  if (!options.ruler_mm.empty()) {
    board.ruler_mm = Eigen::Vector2d(options.ruler_mm.front(), options.ruler_mm.back());
    if (const std::string problem = checkRuler(*board.ruler_mm); !problem.empty())
      throw ConfigError({"--ruler-mm " + problem});
  }
  if (!board.ruler_mm) {
    std::cerr
        << options.board.string()
        << ": nobody measured the printed rulers (calibrate target --ruler-mm): they are taken for 100 mm\n";
  }
  return board.measured();
}

std::unique_ptr<ImageStream> openImages(const LensOptions& options) {
  if (!options.images.empty()) return imagesOfFolder(options.images);
  if (!options.bag.empty()) return imagesOfBag(options.bag, options.topic);
  if (!options.camera.empty()) return imagesOfCamera(options.camera, options.seconds);
  return nullptr;  // only the views that were accepted before
}

/// Says what becomes of each image: each one of a folder, else each change.
class Announcer {
 public:
  Announcer(bool is_for_programs, bool is_every) : is_for_programs_(is_for_programs), is_every_(is_every) {}

  void say(const std::string& image, const std::string& verdict, std::size_t corners,
           const LensProgress* progress) {
    ++counts_[verdict];
    if (!progress && !is_every_ && verdict == last_) return;
    last_ = verdict;
    if (is_for_programs_) {
      nlohmann::json line{{"event", progress ? "view" : "image"},
                          {"image", image},
                          {"verdict", verdict},
                          {"corners", corners}};
      if (progress) addTo(line, *progress);
      print(line);
      return;
    }
    std::cout << image << ": " << verdict;
    if (corners > 0) std::cout << " (" << corners << " corners)";
    if (progress) std::cout << ", view " << progress->views << ". " << progress->advice;
    std::cout << std::endl;
  }
  /// Images by what became of them.
  const std::map<std::string, int>& counts() const { return counts_; }

  static void print(const nlohmann::json& line) {
    std::cout << line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) << std::endl;
  }

 private:
  static void addTo(nlohmann::json& line, const LensProgress& progress) {
    line["views"] = progress.views;
    line["enough"] = progress.is_enough;
    line["target_px"] = {progress.target_px.x(), progress.target_px.y()};
    line["advice"] = progress.advice;
    if (progress.uncertainty) line["worst_px"] = progress.uncertainty->sigma_px[progress.uncertainty->worst];
  }

  bool is_for_programs_;
  bool is_every_;
  std::string last_;
  std::map<std::string, int> counts_;
};

/// Offers images to the session until it has enough or there are no more.
class Collector {
 public:
  Collector(const LensOptions& options, const BoardSpec& board, LensFolder& folder, ImageStream& images)
      : options_(options),
        board_(board),
        folder_(folder),
        images_(images),
        detector_(board),
        announcer_(options.is_for_programs, !images.isContinuous()) {}

  void run() {
    ProgressLine line("images");
    std::size_t done = 0;
    while (const auto image = images_.next()) {
      if (images_.count() > 0) line.show(++done, images_.count());
      if (image->image.empty()) {
        announcer_.say(image->name, "cannot be read", 0, nullptr);
        continue;
      }
      if (!hasRightSize(*image)) continue;
      // Of a folder all images count: somebody chose them.
      if (offer(*image) && images_.isContinuous() && session_->progress().is_enough) break;
    }
  }
  const std::map<std::string, int>& counts() const { return announcer_.counts(); }

 private:
  bool hasRightSize(const StampedImage& image) {
    const int width = folder_.width() > 0 ? folder_.width() : image.image.cols;
    const int height = folder_.height() > 0 ? folder_.height() : image.image.rows;
    if (image.image.cols != width || image.image.rows != height) {
      throw ConfigError({image.name + ": has " + std::to_string(image.image.cols) + "x" +
                         std::to_string(image.image.rows) + " pixels (must be " + std::to_string(width) +
                         "x" + std::to_string(height) + ", as the views before)"});
    }
    if (!session_) {
      LensSessionParams params = options_.session;
      if (!images_.isContinuous()) params.max_motion_px = 0.0;
      session_.emplace(board_, width, height, params);
      for (const BoardView& view : folder_.views()) session_->restore(view);
    }
    return true;
  }

  /// @return whether it was accepted.
  bool offer(const StampedImage& image) {
    const BoardDetection found = detector_.detect(image.image, image.stamp_us);
    const ViewVerdict verdict = session_->offer(found.view, found.blur_px);
    if (verdict != ViewVerdict::kAccepted) {
      announcer_.say(image.name, describe(verdict), found.view.corners.size(), nullptr);
      return false;
    }
    folder_.add(found.view, image.image);
    const LensProgress& progress = session_->progress();
    folder_.writeProgress(progress, options_.session.goal_px);
    announcer_.say(image.name, describe(verdict), found.view.corners.size(), &progress);
    return true;
  }

  const LensOptions& options_;
  const BoardSpec& board_;
  LensFolder& folder_;
  ImageStream& images_;
  BoardDetector detector_;
  Announcer announcer_;
  std::optional<LensSession> session_;
};

nlohmann::json summaryOf(const LensCalibration& calibration, const LensOptions& options, std::size_t views) {
  const LensFit& fit = calibration.fit;
  const double worst_px = calibration.uncertainty.sigma_px[calibration.uncertainty.worst];
  nlohmann::json summary{{"views", views},
                         {"corners", fit.corners},
                         {"outliers", fit.outliers},
                         {"model", nameOf(fit.model)},
                         {"view_deg", horizontalView_rad(fit.lens) * 180.0 / std::numbers::pi},
                         {"training_rms_px", calibration.training_rms_px},
                         {"held_out_rms_px", calibration.held_out_rms_px},
                         {"held_out_ratio", calibration.heldOutRatio()},
                         {"worst_sigma_px", worst_px},
                         {"floor_error_m", floorError_m(fit.lens, worst_px, 3.0, options.camera_height_m)},
                         {"coverage", calibration.coverage},
                         {"complete", static_cast<int>(views) >= options.session.min_views &&
                                          worst_px <= options.session.goal_px},
                         {"warnings", calibration.warnings}};
  if (calibration.halves) {
    summary["halves_worst_px"] = calibration.halves->worst_px;
    summary["halves_p90_px"] = calibration.halves->p90_px;
  }
  return summary;
}

void describe(const LensCalibration& calibration, const nlohmann::json& summary, const LensOptions& options) {
  const double worst_px = summary["worst_sigma_px"].get<double>();
  std::cout << summary["views"] << " views, " << summary["corners"] << " corners in "
            << rounded(100.0 * calibration.coverage, 0) << " % of the image; model "
            << nameOf(calibration.fit.model) << "\n"
            << "Error of views that fitted it " << rounded(calibration.training_rms_px, 3)
            << " px, of held-out ones " << rounded(calibration.held_out_rms_px, 3) << " px ("
            << rounded(calibration.heldOutRatio(), 2) << " times)\n";
  if (calibration.halves) {
    std::cout << "Lenses of two halves of the views differ by " << rounded(calibration.halves->worst_px, 2)
              << " px at worst, by less than " << rounded(calibration.halves->p90_px, 2)
              << " px in 90 % of the image\n";
  }
  std::cout << "Standard deviation of the projection " << rounded(worst_px, 3)
            << " px in the worst place: " << rounded(100.0 * summary["floor_error_m"].get<double>(), 1)
            << " cm on the floor at 3 m (camera at " << rounded(options.camera_height_m, 2) << " m)\n";
  for (const std::string& warning : calibration.warnings) std::cout << "Warning: " << warning << "\n";
  if (!summary["complete"].get<bool>()) {
    const Eigen::Vector2d& px = calibration.uncertainty.grid.px[calibration.uncertainty.worst];
    std::cout << "Not complete: " << options.session.min_views << " views and " << options.session.goal_px
              << " px in the worst place are the goal. Show the board near and aslant at column "
              << std::lround(px.x()) << ", row " << std::lround(px.y())
              << " of the image, and run it again.\n";
  }
}

int finish(const LensOptions& options, const BoardSpec& board, const LensFolder& folder,
           const std::map<std::string, int>& counts) {
  ProgressLine line("solving");
  const auto result = calibrateLens(board, folder.views(), folder.width(), folder.height(),
                                    [&line](int done, int all) { line.show(done, all); });
  if (!result.calibration) {
    std::string rejected;
    for (const auto& [verdict, count] : counts)
      rejected += "\n  " + std::to_string(count) + " images: " + verdict;
    throw std::runtime_error("No lens: " + result.refusal + rejected);
  }
  nlohmann::json summary = summaryOf(*result.calibration, options, folder.views().size());
  const auto file = folder.writeResults(
      *result.calibration, {options.name, options.session.goal_px, options.camera_height_m, summary});
  if (!options.is_for_programs) {
    describe(*result.calibration, summary, options);
    std::cout << "Written: " << file.string() << " (key CameraServer.Camera.NAME.Calibration), report.json, "
              << "uncertainty.png, residuals.png\n";
  }
  summary["event"] = "result";
  summary["file"] = file.string();
  Announcer::print(summary);
  return 0;
}

int calibrateLensOf(const LensOptions& options) {
  const BoardSpec board = readBoard(options);
  LensFolder folder(options.out, board);
  std::map<std::string, int> counts;
  if (const auto images = openImages(options)) {
    Collector collector(options, board, folder, *images);
    collector.run();
    counts = collector.counts();
  } else if (folder.views().empty()) {
    throw ConfigError(
        {"one of --images, --bag and --camera is required (" + options.out.string() + " has no views)"});
  }
  return finish(options, board, folder, counts);
}

}  // namespace

CalibrateCommand addLensCommand(CLI::App& calibrate) {
  auto options = std::make_shared<LensOptions>();
  CLI::App* app = calibrate.add_subcommand("lens",
                                           "Finds focal length, middle and distortion of a camera from views "
                                           "of a board. It chooses still, sharp and new views, "
                                           "says where the board is wanted next, and keeps accepted views in "
                                           "--out, so that it can go on later. The last line "
                                           "is JSON.");
  app->add_option("--board", options->board, "board.json of calibrate target")->required();
  app->add_option("--ruler-mm", options->ruler_mm,
                  "ACROSS UP: what the two printed rulers measure, instead of that in --board [mm]")
      ->expected(2);
  auto* images = app->add_option("--images", options->images, "folder of images, each of a still board");
  auto* bag =
      app->add_option("--bag", options->bag, "ROS 1 bag, or folder of bags, of a moving board or camera");
  auto* camera =
      app->add_option("--camera", options->camera, "running camera: \"cameraA:tcp -h 127.0.0.1 -p 9999\"");
  images->excludes(bag)->excludes(camera);
  bag->excludes(camera);
  app->add_option("--topic", options->topic, "topic of the images in --bag; default: the only one")
      ->needs(bag);
  app->add_option("--seconds", options->seconds, "ends --camera after this time, as Ctrl-C does [s]")
      ->needs(camera);
  app->add_option("--out", options->out, "folder for views and results")->required();
  app->add_option("--name", options->name, "camera_name in camera.yaml")->capture_default_str();
  app->add_option("--goal-px", options->session.goal_px,
                  "standard deviation in the worst place that is enough [px]")
      ->check(CLI::Range(0.001, 10.0))
      ->capture_default_str();
  app->add_option("--min-views", options->session.min_views, "views that are needed at least")
      ->check(CLI::Range(5, 1000))
      ->capture_default_str();
  app->add_option("--camera-height-m", options->camera_height_m,
                  "over the floor, for what an error means there [m]")
      ->check(CLI::Range(0.01, 10.0))
      ->capture_default_str();
  app->add_flag("--json-lines", options->is_for_programs,
                "every line is JSON: for programs that guide a user");
  return {app, [options] { return calibrateLensOf(*options); }};
}

}  // namespace vismem
