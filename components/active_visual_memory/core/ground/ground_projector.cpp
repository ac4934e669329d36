#include "active_visual_memory/core/ground/ground_projector.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/geometry/plane.h"
#include "common/geometry/projection.h"

namespace vismem {

bool GroundProjector::nearBorder(const CameraIntrinsics& k, const Eigen::Vector2d& px_ideal) const {
  // The sensor's border is a rectangle in raw pixels, not in ideal ones.
  const Eigen::Vector2d raw = distortPixel(k, px_ideal);
  const double margin = params_.border_margin_px;
  return raw.x() < margin || raw.y() < margin || raw.x() > k.width - 1 - margin ||
         raw.y() > k.height - 1 - margin;
}

std::optional<Eigen::Matrix2d> GroundProjector::floorCovariance(const CameraIntrinsics& k,
                                                                const Pose3& T_odom_camera,
                                                                const Eigen::Vector2d& px_ideal,
                                                                const Eigen::Vector2d& along,
                                                                double turn_rate_radps) const {
  const Eigen::Matrix3d R = T_odom_camera.linear();
  const Eigen::Vector3d d = R * idealPixelRay(k, px_ideal);
  const double height = T_odom_camera.translation().z();
  if (!(d.z() < 0.0) || height <= 0.0) return std::nullopt;
  // p = c + s d with s = -c_z / d_z, so dp/dd = s (I - d e_z^T / d_z) in its first two rows.
  const double s = -height / d.z();
  Eigen::Matrix<double, 2, 3> dp_dd;
  dp_dd << s, 0.0, -s * d.x() / d.z(), 0.0, s, -s * d.y() / d.z();
  Eigen::Matrix<double, 2, 2> J_pixel;
  J_pixel.col(0) = dp_dd * R.col(0) / k.fx;
  J_pixel.col(1) = dp_dd * R.col(1) / k.fy;
  const Eigen::Vector2d across = turned90(along);
  const Eigen::Vector2d j_along = J_pixel * along * params_.along_sigma_px;
  const Eigen::Vector2d j_across = J_pixel * across * params_.across_sigma_px;
  const Eigen::Vector2d j_height = -d.head<2>() / d.z() * params_.height_sigma_m;
  // Small rotations of the camera about its own axes: dd = w x d.
  const Eigen::Vector2d j_pitch = dp_dd * Eigen::Vector3d(R.col(0)).cross(d) * params_.pitch_sigma_rad;
  const Eigen::Vector2d j_roll = dp_dd * Eigen::Vector3d(R.col(2)).cross(d) * params_.pitch_sigma_rad;
  // A time offset of the joint angles turns the camera mostly about the vertical.
  const Eigen::Vector2d j_time =
      dp_dd * Eigen::Vector3d(Eigen::Vector3d::UnitZ()).cross(d) * (turn_rate_radps * params_.timing_sigma_s);
  Eigen::Matrix2d P = Eigen::Matrix2d::Zero();
  for (const Eigen::Vector2d& j : {j_along, j_across, j_height, j_pitch, j_roll, j_time}) {
    P += j * j.transpose();
  }
  return P;
}

std::optional<FloorSegment> GroundProjector::place(const CameraIntrinsics& k, const Pose3& T_odom_camera,
                                                   const ImageSegment& segment,
                                                   double turn_rate_radps) const {
  Segment2 px = segment.px;
  FloorSegment floor;
  floor.a.censored = nearBorder(k, px.a);
  floor.b.censored = nearBorder(k, px.b);
  const Eigen::Vector2d short_px = params_.end_short_px * (px.b - px.a).normalized();
  if (!floor.a.censored) px.a -= short_px;
  if (!floor.b.censored) px.b += short_px;

  // Keep the part that lies clearly below the horizon.
  const HorizonLine horizon = horizonLine(k, T_odom_camera);
  const double below_a = horizon.signedDistance(px.a) - params_.horizon_margin_px;
  const double below_b = horizon.signedDistance(px.b) - params_.horizon_margin_px;
  const bool looks_down = horizon.normal.isZero() && horizon.offset > 0.0;
  if (!looks_down) {
    if (below_a <= 0.0 && below_b <= 0.0) return std::nullopt;
    const Eigen::Vector2d cut = px.a + below_a / (below_a - below_b) * (px.b - px.a);
    if (below_a < 0.0) px.a = cut, floor.a.censored = true;
    if (below_b < 0.0) px.b = cut, floor.b.censored = true;
  }

  const double anywhere = std::numeric_limits<double>::max();
  const auto a = backProjectToGround(k, T_odom_camera, px.a, anywhere);
  const auto b = backProjectToGround(k, T_odom_camera, px.b, anywhere);
  if (!a || !b) return std::nullopt;
  floor.place({a->head<2>(), b->head<2>()});
  if (!cutToRange(floor, T_odom_camera.translation().head<2>(), params_.max_range_m)) return std::nullopt;
  if (floor.odom().length() < params_.min_length_m) return std::nullopt;

  // Covariances are taken at the floor ends, which a cut may have moved in the image.
  const Pose3 T_camera_odom = T_odom_camera.inverse(Eigen::Isometry);
  const Eigen::Vector2d direction_px = (px.b - px.a).normalized();
  for (FloorEnd* end : {&floor.a, &floor.b}) {
    const auto at = projectToIdeal(k, T_camera_odom * Eigen::Vector3d(end->p.x(), end->p.y(), 0.0));
    const auto P = at ? floorCovariance(k, T_odom_camera, *at, direction_px, turn_rate_radps) : std::nullopt;
    if (!P) return std::nullopt;
    end->P = *P;
  }
  floor.pitch_sigma_rad = params_.pitch_sigma_rad;
  floor.label = segment.label;
  floor.strength = segment.strength;
  return floor;
}

std::pmr::vector<FloorSegment> GroundProjector::project(const CameraIntrinsics& intrinsics,
                                                        const Pose3& T_odom_camera,
                                                        const std::vector<ImageSegment>& observed,
                                                        double turn_rate_radps, double robot_heading_rad,
                                                        std::pmr::memory_resource* scratch) const {
  std::pmr::vector<FloorSegment> floor(scratch);
  floor.reserve(observed.size());
  const auto& off_floor = params_.off_floor_labels;
  const TiltView view(T_odom_camera, robot_heading_rad);
  for (std::size_t i = 0; i < observed.size(); ++i) {
    if (std::find(off_floor.begin(), off_floor.end(), observed[i].label) != off_floor.end()) continue;
    if (auto placed = place(intrinsics, T_odom_camera, observed[i], turn_rate_radps)) {
      placed->observed = static_cast<int>(i);
      for (FloorEnd* end : {&placed->a, &placed->b}) end->D = view.derivativeAt(end->p);
      floor.push_back(std::move(*placed));
    }
  }
  return floor;
}

void GroundProjector::Params::visit(ParameterVisitor& v) {
  v.real(basic("MaximumRange_m", "M1: range on the floor up to which segments are placed"), max_range_m, 0.2,
         50.0);
  v.real(expert("MinimumLength_m", "shorter segments on the floor are dropped"), min_length_m, 0.001, 5.0);
  v.words(basic("OffFloorLabels", "labels of edges that do not lie on the floor, such as door jambs"),
          off_floor_labels);
  v.real(expert("Noise.Height_m", "change of the camera's height from image to image (sigma), as on legs"),
         height_sigma_m, 0.0, 1.0);
}

}  // namespace vismem
