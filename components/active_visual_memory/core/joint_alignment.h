/// @file The drift of odometry, the lean of the camera and the remembered lines, estimated together. Pure.
/// SPEC M1, M6. After R. Smith, M. Self, P. Cheeseman, "Estimating uncertain spatial relationships in
/// robotics", 1990 (EKF-SLAM).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "active_visual_memory/core/drift_alignment.h"
#include "active_visual_memory/core/ground_projector.h"

namespace vismem {

/// What an observation of a known line tells across it, or one of its ends along it.
struct JointResidual {
  DriftResidual common;    ///< `d_lean` is that of the observed coordinate alone where a line is named
  std::uint64_t line = 0;  ///< whose place it was compared with; 0: none that is estimated here
};

struct LineDirection {
  std::uint64_t line = 0;
  double direction_rad = 0.0;  ///< in odom
};

/// One line after an image.
struct LineCorrection {
  std::uint64_t line = 0;
  Eigen::Vector2d reference = Eigen::Vector2d::Zero();  ///< in odom: where the offset is counted
  double offset_m = 0.0;                                ///< to its left, at the reference
  double turn_rad = 0.0;
  Eigen::Matrix2d P = Eigen::Matrix2d::Zero();  ///< of (offset, turn) for a known lean
  Eigen::Matrix<double, 2, 4> J = Eigen::Matrix<double, 2, 4>::Zero();  ///< how they follow the lean
};

/// As DriftAlignment, for a body that sways by more than its camera errs otherwise: lines that were seen in
/// one image share the error of its sway, and what is compared with them later does so, too. As independent
/// lines they would seem to tell the lean, and the heading, far better than they do. So their errors are kept
/// with those of drift and lean in one covariance. *Single-threaded value*, `look` too: it has its workspace
/// here. Nothing is allocated after construction.
class JointAlignment {
 public:
  static constexpr int kMostLines = 128;  ///< beyond it the one that was unseen for longest gives way
  static constexpr int kMostResiduals = 120;

  struct Params {
    DriftAlignment::Params drift;
    double turn_noise = 0.05;      ///< [rad/sqrt(m)] of the way of the feet: what errs at random ..
    double feet_per_rad_m = 0.06;  ///< .. which go so far for each radian that the robot turns
    double sway_shift_m = 0.01;    ///< a body that sways also moves its camera by so much, in each image anew
    double offset_noise_m = 0.0005;  ///< added to a line when it is observed: a line rests, but
    double turn_noise_rad = 0.0002;  ///< errors of images are alike
    double course_rad = 0.005;       ///< sigma of lines of one course against it, told once for each line
    double together_rad = 0.1;       ///< further off it is none of the course
  };

  explicit JointAlignment(const LeanParams& lean);

  SmallMotion travel(const Pose2& before, const Pose2& now, const Params& params);

  /// To be asked for each image, also for one that meets nothing.
  /// @param course_rad that the lines of `directions` have, modulo 90 degrees, if the place has one; they are
  /// told to the filter once for each line.
  /// @return how memory and lean have to change to agree with the image; empty when nothing tells. The lines'
  /// own corrections are in `lines()`, beside the motion of all.
  std::optional<Correction> solve(const Eigen::Vector2d& robot, std::span<const JointResidual> residuals,
                                  const std::optional<double>& course_rad,
                                  std::span<const LineDirection> directions, const Params& params);
  /// What `solve` would return; nothing is learnt.
  std::optional<Correction> look(const Eigen::Vector2d& robot, std::span<const JointResidual> residuals,
                                 const std::optional<double>& course_rad,
                                 std::span<const LineDirection> directions, const Params& params) const;
  const std::vector<LineCorrection>& lines() const { return corrections_; }
  /// Feet slipped: the heading of what is remembered is another one, by so much with this sigma.
  /// @return the motion of the memory.
  SmallMotion slip(const Eigen::Vector2d& robot, double turn_rad, double sigma_rad);

  bool knows(std::uint64_t line) const { return state_.slotOf(line) >= 0; }
  /// A line that is seen for the first time, after the image was solved for. @param noise factor of
  /// variances.
  void begin(std::uint64_t line, const FloorSegment& observed, const LeaningView& view, double noise,
             double slack_m);
  /// Another line that is known as this one is: it was parted.
  void beginAs(std::uint64_t line, std::uint64_t known);
  /// A line takes the place of another one.
  void rename(std::uint64_t known, std::uint64_t line);
  void forget(std::uint64_t line);
  template <typename Predicate>
  void keepIf(Predicate keep) {
    for (std::size_t i = state_.lines.size(); i-- > 0;) {
      if (!keep(state_.lines[i].id)) remove(static_cast<int>(i));
    }
  }

  const Lean& lean() const { return lean_; }
  LeanCovariance leanCovariance() const { return state_.P.block<4, 4>(kLean, kLean); }
  /// That the lines were told to have, in -45..45 degrees from the frame's axes [rad].
  const std::optional<double>& course() const { return state_.course_rad; }
  /// Of the place of a known line at p along n, against the robot: of drift and line together [m^2].
  double placeVariance(std::uint64_t line, const Eigen::Vector2d& n, const Eigen::Vector2d& p) const;
  void reset();

 private:
  static constexpr int kTurn = 2;
  static constexpr int kLean = 3;
  static constexpr int kRates = 7;
  static constexpr int kCourse = 9;
  static constexpr int kSway = 10;   ///< roll and pitch, then the shift that goes with them
  static constexpr int kLines = 14;  ///< offset and turn of each
  static constexpr int kMostUnknowns = kLines + 2 * kMostLines;
  using Matrix = Eigen::MatrixXd;

  struct Line {
    std::uint64_t id = 0;
    Eigen::Vector2d reference = Eigen::Vector2d::Zero();
    bool in_course = false;  ///< told to be
    int unseen = 0;          ///< images
  };

  /// What an image is compared with.
  struct State {
    State();
    int size() const { return kLines + 2 * static_cast<int>(lines.size()); }
    /// The covariance of what there is.
    Eigen::Block<Matrix> known() { return P.topLeftCorner(size(), size()); }
    int slotOf(std::uint64_t line) const;
    void copy(const State& other);

    std::vector<Line> lines;
    Matrix P;  ///< as large as it may become; undefined beyond `size()`
    std::optional<double> course_rad;
    Eigen::Vector2d pivot = Eigen::Vector2d::Zero();  ///< the robot in the last image
    Eigen::Matrix2d P_sway = Eigen::Matrix2d::Zero();
  };

  /// One coordinate that an image tells, and the few unknowns that it follows.
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

  /// What an image tells of n unknowns in m rows, H, and the change x of the unknowns. The matrices are as
  /// large as they may become; their first rows and columns count.
  struct Told {
    Told();

    std::vector<Row> rows;
    Matrix PHt;         ///< n x m
    Matrix spread;      ///< H P H^T, m x m, its lower triangle
    Matrix L;           ///< Cholesky's factor of H P H^T + R, m x m
    Matrix LiHP;        ///< L^-1 H P, m x n
    Eigen::VectorXd y;  ///< m
    Eigen::VectorXd x;  ///< n
  };

  void remove(int slot);
  void beginImage(State& state, const Eigen::Vector2d& robot, const std::optional<double>& course_rad,
                  const Params& params) const;
  /// Sets the rows of `told_`.
  void list(State& state, const Eigen::Vector2d& robot, std::span<const JointResidual> residuals,
            std::span<const LineDirection> directions, const Params& params) const;
  /// @return whether anything tells: then `told_` is filled, of LiHP only the columns of the body's sway.
  bool hear(State& state, const Eigen::Vector2d& robot, std::span<const JointResidual> residuals,
            std::span<const LineDirection> directions, const Params& params) const;
  /// The covariance after what was heard.
  void learn();

  LeanParams lean_params_;
  Lean lean_ = Lean::Zero();
  Eigen::Vector2d rates_ = Eigen::Vector2d::Zero();
  bool moved_ = false;
  State state_;
  std::vector<LineCorrection> corrections_;
  mutable State trial_;  ///< of `look`
  mutable Told told_;
};

}  // namespace vismem
