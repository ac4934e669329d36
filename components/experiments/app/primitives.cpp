#include "experiments/app/primitives.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <nlohmann/json.hpp>

#include "common/config/project_file.h"
#include "common/config/text_file.h"
#include "common/config/text_format.h"
#include "common/vision/app/image_file.h"
#include "common/visual_memory/overlay.h"
#include "evaluation/core/shape_score.h"
#include "experiments/app/look_around_run.h"
#include "simulator/core/props.h"

namespace vismem {
namespace {

constexpr int kPanel_px = 460;
/// A shape counts when the images together showed this share of its outline.
constexpr double kShown_share = 0.98;
constexpr const char* kOccluder = "occluder";
constexpr double kOccluder_m = 0.2;
constexpr double kOccluderHeight_m = 0.15;
constexpr std::array kKinds{PrimitiveKind::kParallelogram, PrimitiveKind::kTriangle, PrimitiveKind::kArrow,
                            PrimitiveKind::kCircle};

std::vector<TrueShape> loadShapes() {
  const auto file = projectFile("cfg/maps/room.primitives.csv");
  return parseTrueShapes(readTextFile(file, "the shapes of the room"), file.string());
}

/// A box on a corner.
struct Occluder {
  std::size_t shape = 0;
  std::size_t corner = 0;
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
};

/// One of the corners of the painted parallelograms, each as often as any other.
Occluder occluderOf(const std::vector<TrueShape>& shapes, std::uint64_t seed) {
  std::vector<Occluder> corners;
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    if (shapes[i].kind != PrimitiveKind::kParallelogram || !shapes[i].painted) continue;
    for (std::size_t k = 0; k < shapes[i].vertices.size(); ++k)
      corners.push_back({i, k, shapes[i].vertices[k]});
  }
  return corners.at(seed % corners.size());
}

/// The box's foot is a parallelogram on the floor, too.
TrueShape footOf(const Occluder& occluder) {
  TrueShape foot;
  foot.name = kOccluder;
  foot.painted = false;
  foot.centre = occluder.at;
  const double h = 0.5 * kOccluder_m;
  for (const auto& [x, y] : {std::pair{-h, -h}, {h, -h}, {h, h}, {-h, h}}) {
    foot.vertices.push_back(occluder.at + Eigen::Vector2d(x, y));
  }
  return foot;
}

void addOutline(Plan& plan, const std::vector<Segment2>& outline, Rgb color, double width_px, bool dashed) {
  for (const Segment2& side : outline) plan.lines.push_back({side, color, width_px, dashed});
}

/// A remembered shape as a true one, to draw its outline.
TrueShape asTrue(const Primitive& p) {
  TrueShape shape;
  shape.kind = p.kind;
  shape.vertices.assign(p.vertices.begin(), p.vertices.end());
  shape.centre = p.centre;
  shape.outer_radius_m = p.radius_m;
  return shape;
}

BoardPanel planOf(const ExperimentRun& run, const ShapeTruth& truth, const std::vector<JudgedShape>& judged) {
  BoardPanel panel;
  panel.title = "the shapes in memory over the true ones";
  Plan plan;
  plan.low = {-3.1, -2.1};
  plan.high = {3.1, 2.1};
  for (const TrueShape& shape : truth.shapes()) addOutline(plan, outlineOf(shape), colors::kGrid, 5.0, false);
  for (const RememberedEdge& e : rememberedIn(run.snapshot(), run.trueRobot())) {
    plan.lines.push_back({e.world, e.confirmed ? colors::kFaintInk : colors::kGrid, 1.0, !e.confirmed});
  }
  for (const JudgedShape& shape : judged) {
    const Rgb color = shape.world.kind == PrimitiveKind::kStripe ? colors::kOdometry
                      : shape.true_shape >= 0                    ? colors::kTruth
                                                                 : colors::kLost;
    const auto outline = outlineOf(asTrue(shape.world));
    const int hidden = shape.world.hidden_vertex;
    for (std::size_t i = 0; i < outline.size(); ++i) {
      const bool inferred = hidden >= 0 && (static_cast<int>(i) == hidden ||
                                            (i + 1) % outline.size() == static_cast<std::size_t>(hidden));
      plan.lines.push_back({outline[i], color, 2.4, inferred});
    }
  }
  plan.robot = run.trueRobot();
  panel.plan = std::move(plan);
  return panel;
}

std::vector<LegendEntry> legend() {
  return {{"right shape (dashed: towards an unseen corner)", colors::kTruth},
          {"false shape", colors::kLost},
          {"painted line", colors::kOdometry},
          {"confirmed edge", colors::kFaintInk}};
}

/// Counts of shown, found, remembered and false shapes, by kind and in all.
nlohmann::json count(const ShapeTruth& truth, const std::vector<JudgedShape>& judged) {
  nlohmann::json json;
  int all_shown = 0;
  int all_found = 0;
  int all_remembered = 0;
  int all_false = 0;
  double error_m = 0.0;
  int with_error = 0;
  const auto found = [&](std::size_t i) {
    return std::any_of(judged.begin(), judged.end(),
                       [&](const JudgedShape& j) { return j.true_shape == static_cast<int>(i); });
  };
  const auto countKind = [&](PrimitiveKind kind) {
    int shown = 0;
    int right = 0;
    int remembered = 0;
    int wrong = 0;
    for (std::size_t i = 0; i < truth.shapes().size(); ++i) {
      if (truth.shapes()[i].kind != kind || truth.seenShare(i) < kShown_share) continue;
      ++shown;
      right += found(i);
    }
    for (const JudgedShape& j : judged) {
      if (j.world.kind != kind) continue;
      ++remembered;
      wrong += j.true_shape < 0;
      if (j.true_shape < 0 || kind == PrimitiveKind::kStripe) continue;
      error_m += j.error_m;
      ++with_error;
    }
    json[nameOf(kind)] = {{"shown", shown}, {"found", right}, {"remembered", remembered}, {"false", wrong}};
    if (kind == PrimitiveKind::kStripe) return;
    all_shown += shown;
    all_found += right;
    all_remembered += remembered;
    all_false += wrong;
  };
  for (const PrimitiveKind kind : kKinds) countKind(kind);
  countKind(PrimitiveKind::kStripe);
  json["all"] = {
      {"shown", all_shown}, {"found", all_found}, {"remembered", all_remembered}, {"false", all_false}};
  if (with_error > 0) json["corner_error_m"] = error_m / with_error;
  return json;
}

/// Two images of the occluded shape, from different places.
class ImagesOfOcclusion {
 public:
  void addView(const ExperimentRun& run, const std::vector<Segment2>& sides) {
    if (!run.lastImage()) return;
    const ImageAnalysis& analysis = run.analysis();
    const Pose3 T_camera_world =
        (toPose3(run.trueRobot()) * analysis.T_robot_camera).inverse(Eigen::Isometry);
    for (const Segment2& side : sides) {
      for (const Eigen::Vector2d& p : {side.a, side.b}) {
        const auto px =
            projectToIdeal(analysis.intrinsics, T_camera_world * Eigen::Vector3d(p.x(), p.y(), 0.0));
        if (!px || px->x() < 5.0 || px->y() < 5.0 || px->x() > analysis.intrinsics.width - 5.0 ||
            px->y() > analysis.intrinsics.height - 5.0) {
          return;
        }
      }
    }
    if (pictures_.size() == 2) pictures_.pop_back();
    pictures_.push_back(drawAnalysis(run.lastImage()->image, analysis, 3));
  }
  const std::vector<cv::Mat>& pictures() const { return pictures_; }

 private:
  std::vector<cv::Mat> pictures_;
};

class ShapeFile {
 public:
  explicit ShapeFile(const std::filesystem::path& file)
      : csv_(file, "variant,kind,name,verdict,x_m,y_m,length_m,width_m,radius_m,hidden_corner,error_m") {}
  void add(const std::string& variant, const ShapeTruth& truth, const std::vector<JudgedShape>& judged) {
    std::vector<bool> found(truth.shapes().size(), false);
    for (const JudgedShape& j : judged) {
      if (j.true_shape >= 0) found[static_cast<std::size_t>(j.true_shape)] = true;
      row(variant, nameOf(j.world.kind),
          j.true_shape >= 0 ? truth.shapes()[static_cast<std::size_t>(j.true_shape)].name : "",
          j.true_shape >= 0 ? "right" : "false", j.world, j.error_m);
    }
    for (std::size_t i = 0; i < truth.shapes().size(); ++i) {
      const TrueShape& shape = truth.shapes()[i];
      Primitive as;
      as.centre = shape.centre;
      as.radius_m = shape.outer_radius_m;
      if (!found[i]) {
        row(variant, nameOf(shape.kind), shape.name,
            truth.seenShare(i) < kShown_share ? "not shown in full" : "missed", as, 0.0);
      }
    }
  }
  void close() { csv_.close(); }

 private:
  void row(const std::string& variant, const char* kind, const std::string& name, const char* verdict,
           const Primitive& p, double error_m) {
    csv_.row(formatted("%s,%s,%s,%s,%.3f,%.3f,%.3f,%.3f,%.3f,%d,%.3f", variant.c_str(), kind, name.c_str(),
                       verdict, p.centre.x(), p.centre.y(), p.length_m, p.width_m, p.radius_m,
                       p.hidden_vertex, error_m));
  }
  CsvFile csv_;
};

nlohmann::json runVariant(bool corner_hidden, const ExperimentOptions& options, JudgementFiles& files,
                          ShapeFile& shape_file) {
  const std::string variant = corner_hidden ? "corner" : "open";
  std::vector<TrueShape> shapes = loadShapes();
  std::optional<Occluder> occluder;
  if (corner_hidden) {
    occluder = occluderOf(shapes, options.seed);
    shapes.push_back(footOf(*occluder));
  }
  ShapeTruth truth(shapes);
  ExperimentRunOptions run_options;
  run_options.mode = options.mode;
  run_options.seed = options.seed;
  run_options.change_robot = [&](SimulationConfig& robot) {
    if (occluder) {
      const PropShape box{
          PropShape::Kind::kBox, {kOccluder_m, kOccluder_m, kOccluderHeight_m}, {0.2, 0.3, 0.75}};
      robot.world.models.push_back(
          makeProp(kOccluder, box, toPose3(Pose2{occluder->at.x(), occluder->at.y(), 0.0})));
    }
    robot.start = startNearMiddle(robot.world, options.seed);
  };
  ExperimentRun run(run_options);
  ImagesOfOcclusion images;
  run.onFrame([&](const LockstepFrame& frame) {
    truth.addView(frame.observation.frame.intrinsics, run.truePoseOfImage(), run.seesFloor());
    if (occluder) images.addView(run, outlineOf(truth.shapes()[occluder->shape]));
  });
  nlohmann::json look;
  lookAroundTwice(run, variant, LookAroundWay{}, files, look);
  ShapeScoreParams params;
  params.focal_px = run.lastImage()->intrinsics.fx;
  const auto judged = judgeShapes(shapesIn(run.snapshot(), run.trueRobot()), truth, params);
  shape_file.add(variant, truth, judged);
  nlohmann::json json = count(truth, judged);
  BoardPanel plan = planOf(run, truth, judged);
  plan.caption = {formatted("%d of %d shown shapes found, %d false", json["all"]["found"].get<int>(),
                            json["all"]["shown"].get<int>(), json["all"]["false"].get<int>())};
  if (occluder) {
    const auto completed = std::find_if(judged.begin(), judged.end(), [&](const JudgedShape& j) {
      return j.true_shape == static_cast<int>(occluder->shape);
    });
    int other_corners_seen = 0;
    for (std::size_t k = 0; k < shapes[occluder->shape].vertices.size(); ++k) {
      other_corners_seen += k != occluder->corner && truth.seenCorner(occluder->shape, k);
    }
    json["occluded"] = {{"shape", shapes[occluder->shape].name},
                        {"corner", occluder->corner},
                        {"corner_seen", truth.seenCorner(occluder->shape, occluder->corner)},
                        {"three_corners_seen", other_corners_seen == 3},
                        {"outline_seen", truth.seenShare(occluder->shape)},
                        {"completed", completed != judged.end()}};
    Board board{"Shapes completed behind an object (figure 7)", options.modeAndSeed(), {}, legend()};
    board.rows.emplace_back();
    for (const cv::Mat& picture : images.pictures()) {
      board.rows.back().push_back({"an image of the occluded shape", {}, picture, {}});
    }
    if (board.rows.back().empty()) board.rows.clear();
    plan.columns = board.rows.empty() ? 1 : static_cast<int>(board.rows.back().size());
    board.rows.push_back({std::move(plan)});
    writeImageFile(drawBoard(board, kPanel_px), options.out / "figure7.png");
  } else {
    const Board board{"The shapes of the room", options.modeAndSeed(), {{std::move(plan)}}, legend()};
    writeImageFile(drawBoard(board, 2 * kPanel_px), options.out / "shapes_open.png");
  }
  return json;
}

}  // namespace

nlohmann::json primitives(const ExperimentOptions& options) {
  JudgementFiles files(options.out);
  ShapeFile shape_file(options.out / "shapes.csv");
  nlohmann::json json;
  if (options.wants("open")) json["open"] = runVariant(false, options, files, shape_file);
  if (options.wants("corner")) json["corner"] = runVariant(true, options, files, shape_file);
  files.close();
  shape_file.close();
  return json;
}

}  // namespace vismem
