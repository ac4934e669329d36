#include "active_visual_memory/core/ground/floor_evidence.h"

#include <algorithm>
#include <cmath>

#include "common/geometry/plane.h"
#include "common/vision/edge_sampling.h"

namespace vismem {
namespace {

/// The largest difference of a channel.
double difference(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

}  // namespace

FloorEvidence::FloorEvidence(const cv::Mat& image, const CameraIntrinsics& intrinsics, const Params& params)
    : image_(image),
      channels_(image.type() == CV_8UC3   ? 3
                : image.type() == CV_8UC1 ? 1
                                          : 0),
      intrinsics_(intrinsics),
      distorts_(intrinsics.hasDistortion()),
      params_(params) {}

double FloorEvidence::fractionOf(int sample) const {
  return 0.1 + 0.8 * (sample + 0.5) / params_.samples;
}

bool FloorEvidence::addColour(const Eigen::Vector2d& px_ideal, Eigen::Vector3i& sum) const {
  const Eigen::Vector2d raw = distorts_ ? distortPixel(intrinsics_, px_ideal) : px_ideal;
  const int u = nearestPixel(raw.x(), image_.cols);
  const int v = nearestPixel(raw.y(), image_.rows);
  if (u < 0 || v < 0 || channels_ == 0) return false;
  const std::uint8_t* colour = image_.ptr<std::uint8_t>(v) + channels_ * u;
  if (channels_ == 3) {
    sum += Eigen::Vector3i(colour[0], colour[1], colour[2]);
  } else {
    sum.array() += *colour;
  }
  return true;
}

std::optional<Eigen::Vector3d> FloorEvidence::colourAt(const Eigen::Vector2d& px_ideal) const {
  Eigen::Vector3i colour = Eigen::Vector3i::Zero();
  return addColour(px_ideal, colour) ? std::optional<Eigen::Vector3d>(colour.cast<double>()) : std::nullopt;
}

std::optional<Eigen::Vector3d> FloorEvidence::patchAt(const Eigen::Vector2d& px, const Eigen::Vector2d& along,
                                                      double half_length) const {
  const Eigen::Vector2d normal = turned90(along);
  Eigen::Vector3i sum = Eigen::Vector3i::Zero();
  int count = 0;
  for (double forward = -half_length; forward <= half_length; forward += 2.0) {
    for (const double sideways : {-1.0, 0.0, 1.0}) {
      if (!addColour(px + forward * along + sideways * normal, sum)) return std::nullopt;
      ++count;
    }
  }
  return Eigen::Vector3d(sum.cast<double>() / count);
}

std::optional<SideColours> FloorEvidence::sides(const Segment2& px) const {
  if (image_.empty()) return std::nullopt;
  SideColours sides;
  const Eigen::Vector2d along = (px.b - px.a).normalized();
  const Eigen::Vector2d aside = params_.side_px * leftNormal(px);
  int count = 0;
  for (int i = 0; i < params_.samples; ++i) {
    const Eigen::Vector2d middle = px.a + fractionOf(i) * (px.b - px.a);
    const auto l = patchAt(middle + aside, along, 0.0);
    const auto r = l ? patchAt(middle - aside, along, 0.0) : std::nullopt;
    if (!r) continue;
    sides.left += *l;
    sides.right += *r;
    ++count;
  }
  if (2 * count < params_.samples) return std::nullopt;
  sides.left /= count;
  sides.right /= count;
  return sides;
}

bool FloorEvidence::isHiddenBeyond(const Segment2& px, bool at_b) const {
  if (image_.empty()) return false;
  const Eigen::Vector2d end = at_b ? px.b : px.a;
  const Eigen::Vector2d outward = (at_b ? px.b - px.a : px.a - px.b).normalized();
  const Eigen::Vector2d aside = params_.beside_px * turned90(outward);
  const double inward = std::min(params_.beyond_px, 0.5 * px.length());
  const auto here = [&](double side) { return patchAt(end - inward * outward + side * aside, outward, 2.0); };
  const auto there = [&](double side) {
    return patchAt(end + params_.beyond_px * outward + side * aside, outward, 2.0);
  };
  const auto differ = [&](const auto& one, const auto& other) {
    return one && other && difference(*one, *other) > params_.max_difference;
  };
  // The first pair of equal colours decides.
  const auto here_left = here(1.0);
  const auto there_left = there(1.0);
  if (!differ(there_left, here_left)) return false;
  const auto there_right = there(-1.0);
  if (!differ(there_right, here_left)) return false;
  const auto here_right = here(-1.0);
  return differ(there_left, here_right) && differ(there_right, here_right);
}

std::optional<double> FloorEvidence::contrastAt(const Segment2& px, double fraction, double aside_px) const {
  if (image_.empty()) return std::nullopt;
  const Eigen::Vector2d aside = aside_px * leftNormal(px);
  const Eigen::Vector2d at = px.a + fraction * (px.b - px.a);
  const auto left = colourAt(at + aside);
  const auto right = colourAt(at - aside);
  if (!left || !right) return std::nullopt;
  return difference(*left, *right);
}

bool FloorEvidence::isEdgeless(const Segment2& px, double most_contrast) const {
  constexpr double kAside_px = 2.0;
  // Its ends are uncertain by a pixel or two.
  for (const double fraction : {0.35, 0.5, 0.65}) {
    const auto contrast = contrastAt(px, fraction, kAside_px);
    if (!contrast || *contrast > most_contrast) return false;
  }
  return true;
}

GapShows FloorEvidence::gap(const Segment2& px, double from_px, double to_px) const {
  if (image_.empty()) return GapShows::kOccluded;
  constexpr double kBeyond_px = 3.0;  // behind a gap the edge is undisturbed
  constexpr double kAside_px = 3.0;
  constexpr double kBefore_px = 2.0;  // nearer to the camera the floor is visible before a foot
  constexpr double kSteep = 0.7;      // an edge along the viewing ray has no side before it
  const Eigen::Vector2d d = (px.b - px.a).normalized();
  const Eigen::Vector2d left = leftNormal(px);
  const Eigen::Vector2d before = px.a + (from_px - kBeyond_px) * d;
  const Eigen::Vector2d behind = px.a + (to_px + kBeyond_px) * d;
  const Eigen::Vector2d middle = px.a + 0.5 * (from_px + to_px) * d;
  const auto isLike = [&](double aside, double as) {
    const auto one = colourAt(middle + aside * left);
    const auto b = colourAt(before + as * left);
    const auto e = colourAt(behind + as * left);
    return one && b && e && std::min(difference(*one, *b), difference(*one, *e)) <= params_.max_difference;
  };
  const auto isFamiliar = [&](double aside) { return isLike(aside, kAside_px) || isLike(aside, -kAside_px); };
  if (isFamiliar(kAside_px) && isFamiliar(-kAside_px)) return GapShows::kFree;
  if (std::abs(d.y()) > kSteep) return GapShows::kOccluded;
  const double down = left.y() > 0.0 ? kBefore_px : -kBefore_px;
  return isLike(down, down) ? GapShows::kStandsThere : GapShows::kOccluded;
}

PlaceShows FloorEvidence::classify(const Segment2& px, const SideColours& remembered) const {
  if (image_.empty()) return PlaceShows::kUnknown;
  const double contrast_before = difference(remembered.left, remembered.right);
  const double most = std::min(params_.max_contrast, params_.max_contrast_share * contrast_before);
  const Eigen::Vector2d along = (px.b - px.a).normalized();
  const Eigen::Vector2d aside = params_.side_px * leftNormal(px);
  int count = 0;
  int free_samples = 0;
  for (int i = 0; i < params_.samples; ++i) {
    const Eigen::Vector2d middle = px.a + fractionOf(i) * (px.b - px.a);
    const auto l = patchAt(middle + aside, along, 0.0);
    const auto m = l ? patchAt(middle, along, 0.0) : std::nullopt;
    const auto r = m ? patchAt(middle - aside, along, 0.0) : std::nullopt;
    if (!r) continue;
    ++count;
    const bool flat = difference(*l, *r) <= most && difference(*m, 0.5 * (*l + *r)) <= most;
    const bool familiar = difference(*m, remembered.left) <= params_.max_difference ||
                          difference(*m, remembered.right) <= params_.max_difference;
    if (flat && familiar) ++free_samples;
  }
  if (2 * count < params_.samples) return PlaceShows::kUnknown;
  return free_samples >= params_.free_share * count ? PlaceShows::kFree : PlaceShows::kOccluded;
}

}  // namespace vismem
