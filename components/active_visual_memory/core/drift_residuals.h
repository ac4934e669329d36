/// @file In what an observed segment differs from the remembered line it belongs to. Pure. SPEC M6.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "active_visual_memory/core/drift_alignment.h"
#include "active_visual_memory/core/floor_line.h"
#include "active_visual_memory/core/ground_projector.h"
#include "active_visual_memory/core/joint_alignment.h"

namespace vismem {

/// Adds what both ends tell across the line, and along it where a true end of the line was observed.
/// @param view that showed the piece. @param slack_m sigma for what the covariances do not model. @param
/// noise factor of all variances.
/// @param end_doubt factor of the sigmas of ends. @param max_end_shift_m ends further apart are not one end.
void addDriftResiduals(const FloorLine& line, const FloorSegment& piece, const LeaningView& view,
                       double slack_m, double noise, double end_doubt, double max_end_shift_m,
                       std::vector<DriftResidual>& residuals);

/// The same against a line whose own error the filter estimates with the rest (JointAlignment).
void addJointResiduals(std::uint64_t id, const FloorLine& line, const FloorSegment& piece,
                       const LeaningView& view, double slack_m, double noise, double end_doubt,
                       double max_end_shift_m, std::vector<JointResidual>& residuals);

/// Variance along a direction without the camera's pitch and roll: they are common to the whole image, and
/// what is solved for is no noise.
double ownVariance(const Eigen::Vector2d& direction, const Eigen::Matrix2d& P, const FloorLean& D,
                   double pitch_sigma_rad);

struct CourseParams {
  /// Sigma of the angles between long straight lines that seem parallel or at right angles [rad]; 0: nothing
  /// is taken to be.
  double sigma_rad = 0.02;
  double least_m = 0.5;       ///< shorter lines may be chords of a curve
  double not_radial = 0.12;   ///< sine of the angle to the viewing ray, along which standing edges lie
  double together_rad = 0.1;  ///< lines that vote for one course
  double slipped_rad = 0.2;   ///< how far those of an image may be off it when odometry slipped
  int least_lines = 4;        ///< so many remembered ones ..
  double least_share = 0.75;  ///< .. and of the length of all so much must have one course, for it to count
};

/// Do the long lines of a place have one course, modulo 90 degrees?
class Rectilinearity {
 public:
  explicit Rectilinearity(const CourseParams& params) : params_(params) {
    sums_.fill(Eigen::Vector2d::Zero());
  }
  void add(double direction_rad, double length_m);
  /// It, in -45..45 degrees from the frame's axes [rad]; empty when they have none.
  std::optional<double> course() const;

 private:
  static constexpr int kBins = 30;  ///< of 3 degrees
  CourseParams params_;
  std::array<double, kBins> length_m_{};
  std::array<Eigen::Vector2d, kBins> sums_;  ///< of the unit vectors of four times the direction, by length
  std::array<int, kBins> lines_{};
  double all_m_ = 0.0;
};

/// Angle between two directions, modulo 90 degrees, in -45..45 degrees.
double offCourse(double direction_rad, double course_rad);

/// Adds what the directions of an image's long lines tell of lean and sway. What people build and paint is
/// mostly parallel or at right angles (whether it is here is for the caller to know): lines that converge on
/// the floor tell that the camera leans, also while the robot stands. Their course, modulo 90 degrees, is
/// common to one image and solved for beside; where it is not held by two lines at least, nothing is added.
/// @param about the lean, beside the one believed, that the derivatives are taken at: a line that is seen too
/// far away turns too much with the lean, too, which would not average out.
/// @param known_rad the course of what is remembered, if that has one: then the lines tell of the turn of the
/// memory, too, and one of them is enough.
void addCourseResiduals(const std::vector<FloorSegment>& floor, const LeaningView& view, const Lean& about,
                        const CourseParams& params, const std::optional<double>& known_rad,
                        std::vector<DriftResidual>& residuals);

struct CourseDeviation {
  double turn_rad = 0.0;
  double variance = 0.0;  ///< [rad^2]
};

/// How far the long lines of an image, if it has any, are turned against a known course, with what the body's
/// sway may turn them: of this image alone, whatever else is remembered.
std::optional<CourseDeviation> courseDeviation(const std::vector<FloorSegment>& floor,
                                               const LeaningView& view, const CourseParams& params,
                                               double course_rad, double sway_rad);

}  // namespace vismem
