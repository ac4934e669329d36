#include "support/board_renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "calibration/core/target/tag_pattern.h"

namespace vismem {
namespace {

constexpr double kBlack = 30.0;
constexpr double kWhite = 200.0;
constexpr int kFew = 8;
constexpr int kMany = 64;

/// Places in a pixel with all x different and all y different (Hammersley), so that no direction of an edge
/// is favoured.
template <int count>
std::array<Eigen::Vector2d, count> placesInPixel() {
  std::array<Eigen::Vector2d, count> places;
  for (int i = 0; i < count; ++i) {
    double inverse = 0.0;
    double digit = 0.5;
    for (int bits = i; bits > 0; bits /= 2, digit /= 2) inverse += digit * (bits % 2);
    places[i] = {(i + 0.5) / count - 0.5, inverse + 0.5 / count - 0.5};
  }
  return places;
}

double bowAt(const BoardScene& scene, double x) {
  const double half = 0.5 * scene.board.columns * scene.board.square_m.x();
  const double across = (x - half) / half;
  return scene.bow_m * (1.0 - across * across);
}

/// The paper's brightness at places of the board.
class Paper {
 public:
  explicit Paper(const BoardSpec& board) : board_(board) {
    for (int i = 0; i < board.tags(); ++i) tags_.push_back(tagPattern(board.family, board.first_tag + i));
  }

  /// @param x,y in squares from the lower left corner. @return negative beside the paper.
  double brightness(double x, double y) const {
    constexpr double kBorder = 1.0;
    if (x < -kBorder || y < -kBorder || x > board_.columns + kBorder || y > board_.rows + kBorder)
      return -1.0;
    const int column = static_cast<int>(std::floor(x));
    const int row = static_cast<int>(std::floor(y));
    if (column < 0 || row < 0 || column >= board_.columns || row >= board_.rows) return kWhite;
    if (!board_.isWhite(column, row)) return kBlack;
    const double low = 0.5 * (1.0 - BoardSpec::kTagSide);
    const double scale = TagPattern::kModules / BoardSpec::kTagSide;
    const double u = (x - column - low) * scale;
    const double v = TagPattern::kModules - (y - row - low) * scale;
    if (u < 0 || v < 0 || u >= TagPattern::kModules || v >= TagPattern::kModules) return kWhite;
    const auto& tag = tags_[board_.tagOn(column, row) - board_.first_tag];
    return tag.black[static_cast<int>(v)][static_cast<int>(u)] ? kBlack : kWhite;
  }

 private:
  const BoardSpec& board_;
  std::vector<TagPattern> tags_;
};

/// Brightness along viewing rays.
class Scene {
 public:
  explicit Scene(const BoardScene& scene)
      : scene_(scene), paper_(scene.board), T_board_camera_(scene.T_camera_board.inverse(Eigen::Isometry)) {}

  double operator()(const Eigen::Vector2d& ray) const {
    const Eigen::Vector3d d = T_board_camera_.linear() * ray.homogeneous();
    const Eigen::Vector3d& centre = T_board_camera_.translation();
    double t = -centre.z() / d.z();
    for (int i = 0; i < (scene_.bow_m != 0.0 ? 4 : 0); ++i)
      t = (bowAt(scene_, centre.x() + t * d.x()) - centre.z()) / d.z();
    if (t > 0.0 && std::isfinite(t)) {
      const double paper = paper_.brightness((centre.x() + t * d.x()) / scene_.board.square_m.x(),
                                             (centre.y() + t * d.y()) / scene_.board.square_m.y());
      if (paper >= 0.0) return paper;
    }
    // A room behind the board.
    return 110.0 + 25.0 * std::sin(9.0 * ray.x()) * std::cos(7.0 * ray.y() + 2.0 * ray.x());
  }

 private:
  const BoardScene& scene_;
  Paper paper_;
  Pose3 T_board_camera_;
};

}  // namespace

std::optional<Eigen::Vector2d> trueCorner(const CameraIntrinsics& lens, const BoardScene& scene, int id) {
  Eigen::Vector3d p = cornerPosition(scene.board, id);
  p.z() = bowAt(scene, p.x());
  const auto ideal = projectToIdeal(lens, scene.T_camera_board * p);
  if (!ideal) return std::nullopt;
  return distortPixel(lens, *ideal);
}

BoardRenderer::BoardRenderer(const CameraIntrinsics& lens)
    : lens_(lens), rays_(lens.height + 2, lens.width + 2, CV_64FC2) {
  for (int v = 0; v < rays_.rows; ++v) {
    for (int u = 0; u < rays_.cols; ++u) {
      const Eigen::Vector3d r = idealPixelRay(lens, undistortPixel(lens, {u - 1.0, v - 1.0}));
      rays_.at<cv::Vec2d>(v, u) = {r.x(), r.y()};
    }
  }
}

Eigen::Vector2d BoardRenderer::ray(double u, double v) const {
  const int column = static_cast<int>(std::floor(u + 1.0));
  const int row = static_cast<int>(std::floor(v + 1.0));
  const double a = u + 1.0 - column;
  const double b = v + 1.0 - row;
  const auto* upper = rays_.ptr<cv::Vec2d>(row) + column;
  const auto* lower = rays_.ptr<cv::Vec2d>(row + 1) + column;
  const cv::Vec2d r = (1 - b) * ((1 - a) * upper[0] + a * upper[1]) + b * ((1 - a) * lower[0] + a * lower[1]);
  return {r[0], r[1]};
}

cv::Mat BoardRenderer::render(const BoardScene& scene, std::mt19937& random) const {
  static const auto few = placesInPixel<kFew>();
  static const auto many = placesInPixel<kMany>();
  const Scene brightness(scene);
  cv::Mat exact(lens_.height, lens_.width, CV_32FC1);
  for (int v = 0; v < exact.rows; ++v) {
    for (int u = 0; u < exact.cols; ++u) {
      double sum = 0.0;
      double least = 255.0;
      double most = 0.0;
      for (const auto& place : few) {
        const double value = brightness(ray(u + place.x(), v + place.y()));
        sum += value / kFew;
        least = std::min(least, value);
        most = std::max(most, value);
      }
      if (most - least > 20.0) {
        sum = 0.0;
        for (const auto& place : many) sum += brightness(ray(u + place.x(), v + place.y())) / kMany;
      }
      exact.at<float>(v, u) = static_cast<float>(sum);
    }
  }
  if (scene.blur_px > 0.0) cv::GaussianBlur(exact, exact, {}, scene.blur_px);
  std::normal_distribution<double> noise(0.0, 1.0);
  cv::Mat image(exact.size(), CV_8UC1);
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) {
      const double light = 1.0 + scene.shade * (static_cast<double>(u) / image.cols - 0.5);
      const double value = light * exact.at<float>(v, u) + scene.noise * noise(random);
      image.at<unsigned char>(v, u) = static_cast<unsigned char>(std::clamp(std::lround(value), 0L, 255L));
    }
  }
  return image;
}

Pose3 boardPose(const CameraIntrinsics& lens, const Eigen::Vector3d& p_board, const Eigen::Vector2d& pixel,
                double distance_m, double slant_rad, double turn_rad, double roll_rad) {
  using Eigen::AngleAxisd;
  using Eigen::Vector3d;
  const Vector3d d = idealPixelRay(lens, undistortPixel(lens, pixel)).normalized();
  // Facing the camera: the board's z comes against the ray; x right, y up.
  Eigen::Matrix3d R_facing;
  R_facing.col(2) = -d;
  R_facing.col(0) = Vector3d::UnitY().cross(d).normalized();
  R_facing.col(1) = R_facing.col(2).cross(R_facing.col(0));
  const Vector3d axis(-std::sin(turn_rad), std::cos(turn_rad), 0.0);
  Pose3 T_camera_board = Pose3::Identity();
  T_camera_board.linear() =
      AngleAxisd(roll_rad, d) * R_facing * AngleAxisd(slant_rad, axis).toRotationMatrix();
  T_camera_board.translation() = distance_m * d - T_camera_board.linear() * p_board;
  return T_camera_board;
}

}  // namespace vismem
