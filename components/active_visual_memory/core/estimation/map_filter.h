/// @file EKF-SLAM update of odometry drift, camera tilt and line landmarks. Pure. See M1, M6.
/// After R. Smith, M. Self, P. Cheeseman, "Estimating uncertain spatial relationships in robotics", 1990;
/// iterated with a robust weight (P. Huber 1964; B. Bell, F. Cathey, "The iterated Kalman filter update as a
/// Gauss-Newton method", 1993).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "active_visual_memory/core/estimation/covariance_kernels.h"
#include "active_visual_memory/core/ground/camera_tilt.h"
#include "active_visual_memory/core/ground/floor_segment.h"
#include "common/geometry/planar_increment.h"
#include "common/geometry/pose.h"

namespace vismem {

/// One coordinate in which an observation differs from a remembered line: across the line, or of one of its
/// ends along it.
struct LineResidual {
  Eigen::Vector2d p = Eigen::Vector2d::Zero();           ///< observed point in odom [m]
  Eigen::Vector2d direction = Eigen::Vector2d::UnitX();  ///< along which both are compared
  double residual_m = 0.0;                               ///< observed minus remembered
  double variance_m2 = 1.0;  ///< of the difference, without the unknowns of the filter
  /// Derivative of observed minus remembered by the camera tilt [m/rad].
  TiltJacobianRow d_tilt = TiltJacobianRow::Zero();
  /// Derivative of the observed coordinate by the tilt of this frame [m/rad].
  Eigen::RowVector2d d_frame_tilt = Eigen::RowVector2d::Zero();
  std::uint64_t line = 0;  ///< the line compared with; 0: none of the filter's
};

/// Result of one image.
struct Correction {
  PlanarIncrement motion;                                  ///< of the memory
  CameraTilt camera_tilt = CameraTilt::Zero();             ///< change of the tilt estimate [rad]
  Eigen::Vector2d frame_tilt = Eigen::Vector2d::Zero();    ///< of this image, about the robot's x and y [rad]
  Eigen::Matrix2d P_frame_tilt = Eigen::Matrix2d::Zero();  ///< posterior covariance [rad^2]
};

/// Prior sigmas of the errors of odometry. Wheels and legs err by a lasting share, which is estimated, and at
/// random.
struct OdometryErrors {
  double shift_per_m = 0.02;     ///< random shift per metre driven
  double shift_per_rad = 0.005;  ///< random shift per radian turned [m/rad]
  double turn_per_rad = 0.02;    ///< lasting heading error per radian turned
  double turn_per_m = 0.02;      ///< lasting heading error per metre driven [rad/m]
  double travel_scale = 0.1;  ///< lasting error of the travelled way per metre; real wheels err by 3 to 11 %
  double turn_noise = 0.005;  ///< random heading error over the way of the wheels or feet [rad/sqrt(m)]
  double feet_per_rad_m = 0.06;  ///< that way per radian turned [m/rad]
};

struct LineDirection {
  std::uint64_t line = 0;
  double direction_rad = 0.0;  ///< in odom
};

/// What one image measures.
struct ImageMeasurements {
  Eigen::Vector2d robot = Eigen::Vector2d::Zero();  ///< its place in odom [m]
  std::span<const LineResidual> residuals;
  std::optional<double> dominant_direction_rad;  ///< of the place, modulo 90 degrees; empty if there is none
  std::span<const LineDirection> directions;     ///< of the lines that have it; each is used once
};

/// Correction of one line after an image.
struct LineCorrection {
  std::uint64_t line = 0;
  Eigen::Vector2d reference = Eigen::Vector2d::Zero();  ///< point in odom that the offset is counted at [m]
  double offset_m = 0.0;                                ///< to its left, at the reference
  double turn_rad = 0.0;
  Eigen::Matrix2d P = Eigen::Matrix2d::Zero();  ///< covariance of (offset, turn) for a known camera tilt
  Eigen::Matrix<double, 2, 4> J =
      Eigen::Matrix<double, 2, 4>::Zero();  ///< their derivative by the camera tilt
};

/// State: drift of the odometry since the memory was made (a random motion about the robot that grows with
/// its way; a robot that stands does not drift), its lasting errors, the camera tilt, the dominant direction
/// of the place, the tilt of the frame at hand, and the lines. The tilt of a frame is a common error of all
/// lines in that image, and of all that is compared with them later: independent lines would make tilt and
/// heading seem better known than they are. *Single-threaded value*, `preview` included: its workspace is
/// here. Nothing is allocated after construction.
class MapFilter {
 public:
  static constexpr int kMaxLines = 128;  ///< a further line replaces the one that was unseen for longest
  static constexpr int kMaxResiduals = 120;

  struct Params {
    OdometryErrors odometry;
    double huber = 1.5;  ///< sigmas beyond which a residual has less weight
    double gate = 4.0;   ///< sigmas beyond which it has none
    int iterations = 3;
    double gait_height_m = 0.57;  ///< of the camera above what the body tilts about in each frame
    double offset_noise_m =
        0.0005;  ///< process noise of an observed line: errors of successive images correlate
    double turn_noise_rad = 0.0002;  ///< the same of its direction
    double direction_rad = 0.005;    ///< sigma of a line against the dominant direction, used once per line
    double together_rad = 0.1;       ///< lines further off do not belong to the dominant direction
  };

  explicit MapFilter(const TiltPrior& tilt_prior);

  /// Prediction by odometry. @param before previous T_odom_robot. @param now present T_odom_robot.
  /// @return the expected motion of the memory by the heading rates.
  PlanarIncrement predict(const Pose2& before, const Pose2& now, const Params& params);

  /// Update by one image; to be called for each image, also without residuals.
  /// @return motion of the memory and change of the tilt; empty without information. Corrections of the lines
  ///         are in lineCorrections(), relative to that motion.
  std::optional<Correction> update(const ImageMeasurements& image, const Params& params);
  /// The result that `update` would return; the state stays.
  std::optional<Correction> preview(const ImageMeasurements& image, const Params& params) const;
  const std::vector<LineCorrection>& lineCorrections() const { return corrections_; }

  bool contains(std::uint64_t line) const { return state_.slotOf(line) >= 0; }
  /// Adds a line at its first observation, after the update of that image.
  /// @param noise    factor of all variances.
  /// @param slack_m  sigma of errors that the covariances do not model [m].
  void addLine(std::uint64_t line, const FloorSegment& observed, const TiltView& view, double noise,
               double slack_m);
  /// Adds a copy of a known line, fully correlated with it: the line was split.
  void copyLine(std::uint64_t line, std::uint64_t known);
  /// Renames a known line, replacing another one.
  void replaceLine(std::uint64_t known, std::uint64_t line);
  void removeLine(std::uint64_t line);
  template <typename Predicate>
  void retainIf(Predicate keep) {
    for (std::size_t i = state_.lines.size(); i-- > 0;) {
      if (!keep(state_.lines[i].id)) remove(static_cast<int>(i));
    }
  }

  const CameraTilt& cameraTilt() const { return camera_tilt_; }
  CameraTiltCovariance cameraTiltCovariance() const { return state_.P.block<4, 4>(kTilt, kTilt); }
  /// Dominant direction in the filter, in -45..45 degrees from the axes of the frame [rad].
  const std::optional<double>& dominantDirection() const { return state_.dominant_direction_rad; }
  /// Variance of the place of a known line at p along n, relative to the robot: drift and line together
  /// [m^2].
  double placeVariance(std::uint64_t line, const Eigen::Vector2d& n, const Eigen::Vector2d& p) const;
  void reset();

 private:
  static constexpr int kTurn = 2;
  static constexpr int kTilt = 3;
  static constexpr int kRates = 7;  ///< of the heading per radian and per metre, of the way per metre
  static constexpr int kDirection = 10;
  static constexpr int kFrameTilt = 11;  ///< roll and pitch, then the shift of the camera
  static constexpr int kLines = 15;      ///< offset and turn of each
  static constexpr int kMaxUnknowns = kLines + 2 * kMaxLines;
  using Matrix = Eigen::MatrixXd;
  static constexpr int kStride = paddedRows(kMaxUnknowns) + kKernelRows;
  static constexpr int kCommon = paddedRows(kLines);  ///< rows of W with all unknowns but those of the lines

  struct Line {
    std::uint64_t id = 0;
    Eigen::Vector2d reference = Eigen::Vector2d::Zero();
    bool has_direction = false;  ///< its direction was used once
    int unseen = 0;              ///< images
  };

  /// Lines and covariance that an image is compared with.
  struct State {
    State();
    int size() const { return kLines + 2 * static_cast<int>(lines.size()); }
    /// The covariance of the present unknowns.
    Eigen::Block<Matrix> known() { return P.topLeftCorner(size(), size()); }
    int slotOf(std::uint64_t line) const;
    void copy(const State& other);

    std::vector<Line> lines;
    Matrix P;  ///< as large as it may become; undefined beyond `size()`
    std::optional<double> dominant_direction_rad;
    Eigen::Vector2d pivot = Eigen::Vector2d::Zero();  ///< the robot in the last image
    Eigen::Matrix2d P_frame_tilt = Eigen::Matrix2d::Zero();
  };

  /// One residual and its sparse row of the measurement matrix.
  struct Row {
    void add(int unknown, double factor);
    template <typename Vector>
    double dot(const Vector& v) const {
      double sum = 0.0;
      for (int k = 0; k < count; ++k) sum += factors[k] * v[unknowns[k]];
      return sum;
    }

    static constexpr int kMost = 13;
    std::array<int, kMost> unknowns{};
    std::array<double, kMost> factors{};
    int count = 0;
    double residual = 0.0;
    double variance = 0.0;
  };

  /// Measurements of one image: m rows of H over n unknowns, and the update x. The matrices are as
  /// large as they may become; their first rows and columns count.
  struct Innovation {
    Innovation();

    std::vector<Row> rows;
    Matrix W;           ///< P H^T, then P H^T L^-T, n x m
    Matrix panels;      ///< workspace of subtractSquare
    Matrix spread;      ///< H P H^T, m x m, its lower triangle
    Matrix L;           ///< Cholesky's factor of H P H^T + R, m x m, its lower triangle
    Eigen::VectorXd R;  ///< variances with the robust weight, m
    Eigen::VectorXd Hx;
    Eigen::VectorXd y;  ///< (H P H^T + R)^-1 residuals, m
    Eigen::VectorXd x;  ///< n
  };

  void remove(int slot);
  void beginImage(State& state, const ImageMeasurements& image, const Params& params) const;
  /// Linearizes the measurements: sets the rows of `innovation_`.
  void linearize(State& state, const ImageMeasurements& image, const Params& params) const;
  /// Sets W to P H^T, and spread.
  void projectCovariance(const State& state) const;
  /// Sets L. @return false where H P H^T + R is not positive definite.
  bool factorize() const;
  /// Multiplies the rows of W from `first` to before `end` by L^-T.
  void divideByFactor(int first, int end) const;
  /// Iterated update of the mean. @return empty without information; else `innovation_` is set, W to P H^T
  /// L^-T in its first kCommon rows and to P H^T in the others.
  std::optional<Correction> solve(State& state, const ImageMeasurements& image, const Params& params) const;
  /// Covariance update with `innovation_`: P - P H^T (H P H^T + R)^-1 H P = P - W W^T.
  void updateCovariance();

  TiltPrior tilt_prior_;
  CameraTilt camera_tilt_ = CameraTilt::Zero();
  Eigen::Vector3d rates_ = Eigen::Vector3d::Zero();
  bool moved_ = false;
  State state_;
  std::vector<LineCorrection> corrections_;
  mutable State preview_state_;  ///< of `preview`
  mutable Innovation innovation_;
};

}  // namespace vismem
