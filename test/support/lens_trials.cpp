#include "support/lens_trials.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <numbers>
#include <regex>
#include <sstream>

#include "calibration/core/target/board_detector.h"
#include "common/process/child_process.h"

namespace vismem {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr int kWidth = 640;
constexpr int kHeight = 480;
/// Windows of the saddle fit need so much of the image.
constexpr double kMargin_px = 8.0;

double uniform(std::mt19937& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// Whether the radius in the image grows with the angle, to some way beyond the image's corners.
bool keepsOrder(double k1, double k2, double most_radius) {
  for (double r = 0.0; r <= 1.2 * most_radius; r += 0.01 * most_radius) {
    if (1.0 + r * r * (3.0 * k1 + r * r * 5.0 * k2) < 0.1) return false;
  }
  return true;
}

bool isInside(const CameraIntrinsics& lens, const Eigen::Vector2d& px) {
  return px.x() >= kMargin_px && px.y() >= kMargin_px && px.x() <= lens.width - 1 - kMargin_px &&
         px.y() <= lens.height - 1 - kMargin_px;
}

/// In front of the camera and not beyond the fold of the distortion.
std::optional<Eigen::Vector2d> visibleCorner(const CameraIntrinsics& lens, const BoardScene& scene, int id) {
  const Eigen::Vector3d p = scene.T_camera_board * cornerPosition(scene.board, id);
  if (p.z() <= 0.0) return std::nullopt;
  const Eigen::Vector2d ideal = *projectToIdeal(lens, p);
  const auto px = trueCorner(lens, scene, id);
  // The raw pixel must lead back to the same ray.
  if (!px || !isInside(lens, *px) || (undistortPixel(lens, distortPixel(lens, ideal)) - ideal).norm() > 0.01)
    return std::nullopt;
  return px;
}

}  // namespace

CameraIntrinsics drawLens(std::mt19937& random) {
  while (true) {
    const double half_view = 0.5 * uniform(random, 40.0, 100.0) * kDegree;
    CameraIntrinsics lens;
    lens.width = kWidth;
    lens.height = kHeight;
    lens.k1 = uniform(random, -0.4, 0.1);
    lens.k2 = uniform(random, 0.3, 0.7) * lens.k1 * lens.k1;
    lens.p1 = uniform(random, -0.001, 0.001);
    lens.p2 = uniform(random, -0.001, 0.001);
    const double r = std::tan(half_view);
    const double radius = r * (1.0 + r * r * (lens.k1 + r * r * lens.k2));
    lens.fx = 0.5 * (kWidth - 1) / radius;
    lens.fy = lens.fx * uniform(random, 0.995, 1.005);
    lens.cx = 0.5 * (kWidth - 1) + uniform(random, -12.0, 12.0);
    lens.cy = 0.5 * (kHeight - 1) + uniform(random, -12.0, 12.0);
    // The ideal radius of the image's corner.
    if (radius <= 0.0 || !keepsOrder(lens.k1, lens.k2, 1.25 * r)) continue;
    double most = 0.0;
    for (const double u : {0.0, kWidth - 1.0}) {
      for (const double v : {0.0, kHeight - 1.0})
        most = std::max(most, idealPixelRay(lens, undistortPixel(lens, {u, v})).head<2>().norm());
    }
    if (most < 4.0 && keepsOrder(lens.k1, lens.k2, most) &&
        horizontalView_rad(lens) < kWidestView_deg * kDegree)
      return lens;
  }
}

BoardScene drawScene(const CameraIntrinsics& lens, const BoardSpec& board, const Eigen::Vector2d& near_px,
                     std::mt19937& random) {
  const Eigen::Vector2d middle(0.5 * (lens.width - 1), 0.5 * (lens.height - 1));
  const Eigen::Vector3d centre(0.5 * board.columns * board.square_m.x(),
                               0.5 * board.rows * board.square_m.y(), 0.0);
  BoardScene scene;
  scene.board = board;
  while (true) {
    const Eigen::Vector2d px = middle + uniform(random, 0.3, 0.9) * (near_px - middle);
    const double span = uniform(random, 0.35, 1.0);
    const double distance_m = board.columns * board.square_m.x() * lens.fx / (span * lens.width);
    scene.T_camera_board =
        boardPose(lens, centre, px, distance_m, uniform(random, 0.0, 50.0) * kDegree,
                  uniform(random, 0.0, 360.0) * kDegree, uniform(random, -40.0, 40.0) * kDegree);
    int seen = 0;
    bool is_before = true;
    for (int id = 0; id < board.corners(); ++id) {
      is_before &= (scene.T_camera_board * cornerPosition(board, id)).z() > 0.02;
      seen += visibleCorner(lens, scene, id).has_value();
    }
    if (is_before && seen >= 14) return scene;
  }
}

BoardView projectedView(const CameraIntrinsics& lens, const BoardScene& scene, double sigma_px,
                        std::mt19937& random) {
  std::normal_distribution<double> noise(0.0, sigma_px);
  BoardView view;
  for (int id = 0; id < scene.board.corners(); ++id) {
    const auto px = visibleCorner(lens, scene, id);
    if (!px) continue;
    const double du = noise(random);
    const double dv = noise(random);
    view.corners.push_back({id, *px + Eigen::Vector2d(du, dv), sigma_px});
  }
  return view;
}

BoardHolder::BoardHolder(const CameraIntrinsics& lens, const BoardSpec& board, bool images, unsigned seed)
    : lens_(lens), board_(board), random_(seed) {
  if (images) renderer_.emplace(lens);
}

int BoardHolder::hold(LensSession& session, int most_images) {
  constexpr double kNoise_px = 0.02;  // as of the detector on sharp images
  BoardDetector detector(board_);
  int shown = 0;
  while (shown < most_images && !session.progress().is_enough) {
    // Mostly where the tool wants the board, sometimes anywhere.
    const Eigen::Vector2d anywhere(uniform(random_, 0.0, lens_.width), uniform(random_, 0.0, lens_.height));
    const Eigen::Vector2d target = uniform(random_, 0.0, 1.0) < 0.6 ? session.progress().target_px : anywhere;
    BoardScene scene = drawScene(lens_, board_, target, random_);
    ++shown;
    if (!renderer_) {
      session.offer(projectedView(lens_, scene, kNoise_px, random_), 0.8);
      continue;
    }
    scene.blur_px = uniform(random_, 0.5, 0.9);
    const BoardDetection found = detector.detect(renderer_->render(scene, random_), shown);
    session.offer(found.view, found.blur_px);
  }
  return shown;
}

LensTrial tryLens(unsigned seed) {
  constexpr int kMostImages = 120;
  LensTrial trial;
  trial.seed = seed;
  std::mt19937 random(seed);
  trial.truth = drawLens(random);
  trial.view_deg = horizontalView_rad(trial.truth) / kDegree;
  BoardSpec board;
  board.square_m.setConstant(0.029);
  LensSessionParams params;
  params.max_motion_px = 0.0;
  LensSession session(board, trial.truth.width, trial.truth.height, params);
  BoardHolder holder(trial.truth, board, true, seed + 1000);
  trial.images = holder.hold(session, kMostImages);
  trial.is_enough = session.progress().is_enough;
  trial.views = session.views();
  auto result = calibrateLens(board, trial.views, trial.truth.width, trial.truth.height);
  if (!result.calibration) {
    trial.problem = result.refusal;
    return trial;
  }
  trial.calibration = std::move(*result.calibration);
  const PixelGrid grid = pixelGrid(trial.truth.width, trial.truth.height, 17, 13);
  const LensFit& fit = trial.calibration.fit;
  const auto difference = projectionDifference(trial.truth, fit.lens, grid);
  trial.worst_px = difference.worst_px;
  trial.worst_fixed_px = projectionDifference(trial.truth, fit.lens, grid, false).worst_px;
  const auto uncertainty = projectionUncertainty(fit.lens, fit.P_lens, grid);
  for (std::size_t i = 0; i < grid.px.size(); ++i) {
    trial.squares += difference.difference_px[i].squaredNorm() / static_cast<double>(grid.px.size());
    trial.variance += uncertainty.P_px[i].trace() / static_cast<double>(grid.px.size());
  }
  return trial;
}

std::optional<CameraIntrinsics> lensOfMrcal(const LensTrial& trial, const BoardSpec& board,
                                            const std::string& folder, const std::string& model) {
  // Corners that an image lacks are lines of "-". Weights as ours, at most 1.
  std::ofstream corners(folder + "/corners.vnl");
  corners.precision(9);
  corners << "# filename x y weight\n";
  for (std::size_t i = 0; i < trial.views.size(); ++i) {
    auto corner = trial.views[i].corners.begin();
    for (int id = 0; id < board.corners(); ++id) {
      corners << "v" << 1000 + i << ".png ";
      if (corner == trial.views[i].corners.end() || corner->id != id) {
        corners << "- - -\n";
        continue;
      }
      const double weight = std::min(1.0, 0.02 / std::hypot(0.02, corner->sigma_px));
      corners << corner->pixel.x() << " " << corner->pixel.y() << " " << weight << "\n";
      ++corner;
    }
  }
  corners.close();
  std::ostringstream square;
  square << board.square_m.x();
  try {
    ChildProcess mrcal({"mrcal-calibrate-cameras",
                        "--corners-cache",
                        folder + "/corners.vnl",
                        "--corners-cache-has-weights",
                        "--lensmodel",
                        model,
                        "--focal",
                        "400",
                        "--object-spacing",
                        square.str(),
                        "--object-width-n",
                        std::to_string(board.cornerColumns()),
                        "--object-height-n",
                        std::to_string(board.cornerRows()),
                        "--imagersize",
                        std::to_string(trial.truth.width),
                        std::to_string(trial.truth.height),
                        "--outdir",
                        folder,
                        "v*.png"});
    if (mrcal.waitForExit(std::chrono::minutes(3)) != 0) return std::nullopt;
  } catch (const std::exception&) {
    return std::nullopt;
  }
  std::ifstream stream(folder + "/camera-0.cameramodel");
  const std::string text{std::istreambuf_iterator<char>(stream), {}};
  std::smatch found;
  if (!std::regex_search(text, found, std::regex("'intrinsics': \\[([^\\]]*)\\]"))) return std::nullopt;
  std::string list = found[1];
  std::replace(list.begin(), list.end(), ',', ' ');
  std::istringstream numbers(list);
  LensVector lens = LensVector::Zero();
  for (int i = 0; i < kLensParameters && numbers >> lens[i]; ++i) {
  }
  return lensFrom(lens, trial.truth.width, trial.truth.height);
}

}  // namespace vismem
