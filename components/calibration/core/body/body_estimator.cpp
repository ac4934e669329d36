#include "calibration/core/body/body_estimator.h"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "calibration/core/body/body_start.h"
#include "common/geometry/angles.h"

namespace vismem {
namespace {

/// Corners beyond this many standard deviations of all residuals lose weight, and are outliers.
constexpr double kHuber = 3.0;
constexpr double kOutlier = 5.0;
/// Repetitions of the last stage, in which outliers and the noise of the wheels settle.
constexpr int kRefinements = 4;
/// Backlash that is worth a warning [rad].
constexpr double kNotedBacklash = degToRad(0.1);
/// Noise of the corners that the residuals may show [standard deviations of their finder].
constexpr double kLeastCornerNoise = 0.3;
constexpr double kMostCornerNoise = 10.0;
/// Noise of the wheels that the residuals may show [m per sqrt(m)].
constexpr double kLeastWheelNoise = 1e-4;
constexpr double kMostWheelNoise = 0.05;
/// Repeatability of joints that the residuals may show [rad].
constexpr double kLeastRepeatability = degToRad(0.005);
constexpr double kMostRepeatability = degToRad(1.0);

constexpr LensIndex kDistortion[] = {kK1, kK2, kP1, kP2, kK3};

/// By how much the image's corner shifts with a coefficient of the distortion [px].
double cornerShift(const CameraIntrinsics& lens, LensIndex index) {
  constexpr double kStep = 1e-6;
  const Eigen::Vector2d ideal = undistortPixel(lens, Eigen::Vector2d::Zero());
  CameraIntrinsics moved = lens;
  double* const coefficients[] = {&moved.k1, &moved.k2, &moved.p1, &moved.p2, &moved.k3};
  *coefficients[index - kK1] += kStep;
  return (distortPixel(moved, ideal) - distortPixel(lens, ideal)).norm() / kStep;
}

/// The estimate's working state: record, paths and what is used of them.
class Estimation {
 public:
  Estimation(const BodyRecord& record, const BodyEstimatorParams& params)
      : record_(record),
        params_(params),
        joints_(record.joints),
        wheels_(record.odometry, params.wheel_base_m),
        still_(stillViews(record, joints_, wheels_)),
        noise_(params.noise) {
    dropViewsBeforeRest();
    start_ = nominalBody(params.mount, record.intrinsics, params.wheel_base_m);
    estimate_.parameters = start_;
    for (const BoardView& view : record_.views) weights_.emplace_back(view.corners.size(), 1.0);
    poses_ = startPoses(record_, wheels_, still_, start_);
  }

  BodyEstimate run(const std::function<void(const std::string&)>& progress) {
    const auto report = [&](const char* what) {
      if (progress) progress(what);
    };
    report("views at rest");
    solve({false, false});
    // Views in motion start from the poses of those at rest, by the wheels as they are known now.
    poses_ = startPoses(record_, wheels_, still_, estimate_.parameters);
    report("views in motion");
    solve({true, true});
    for (int i = 0; i < kRefinements; ++i) {
      report("refinement");
      reweigh();
      solve({true, true});
    }
    conclude();
    return estimate_;
  }

 private:
  std::vector<std::size_t> fixedParameters() const {
    std::vector<std::size_t> fixed;
    if (params_.distortion_sigma_px <= 0.0) {
      for (const LensIndex i : kDistortion) fixed.push_back(lensParameter(i));
    }
    if (params_.focal_sigma_px <= 0.0) fixed.insert(fixed.end(), {lensParameter(kFx), lensParameter(kFy)});
    if (params_.centre_sigma_px <= 0.0) fixed.insert(fixed.end(), {lensParameter(kCx), lensParameter(kCy)});
    if (record_.place == BoardPlace::kFloor) fixed.push_back(kBoardHeight);
    return fixed;
  }

  std::vector<BodyKnowledge> knowledge() const {
    std::vector<BodyKnowledge> known = params_.knowledge;
    const auto lens = [&](LensIndex i, double sigma) {
      if (sigma > 0.0) known.push_back({lensParameter(i), start_.lens[i], sigma});
    };
    lens(kFx, params_.focal_sigma_px);
    lens(kFy, params_.focal_sigma_px);
    lens(kCx, params_.centre_sigma_px);
    lens(kCy, params_.centre_sigma_px);
    for (const LensIndex i : kDistortion)
      lens(i, params_.distortion_sigma_px / cornerShift(record_.intrinsics, i));
    known.push_back({kPanBacklash, 0.0, params_.backlash_sigma_rad});
    known.push_back({kTiltBacklash, 0.0, params_.backlash_sigma_rad});
    if (record_.place == BoardPlace::kFloor) {
      known.push_back({kBoardRoll, 0.0, params_.flatness_sigma_rad});
      known.push_back({kBoardPitch, 0.0, params_.flatness_sigma_rad});
    }
    return known;
  }

  std::unique_ptr<BodyProblem> problem(const BodyStage& stage) {
    BodyProblem::Inputs inputs;
    inputs.record = &record_;
    inputs.joints = &joints_;
    inputs.wheels = &wheels_;
    inputs.still = &still_;
    inputs.weights = &weights_;
    inputs.knowledge = knowledge();
    if (params_.focal_sigma_px > 0.0) inputs.aspect_sigma = params_.aspect_sigma;
    inputs.fixed = fixedParameters();
    inputs.noise = noise_;
    inputs.start = start_;
    return std::make_unique<BodyProblem>(std::move(inputs), stage, estimate_.parameters, poses_);
  }

  void solve(const BodyStage& stage) {
    problem_ = problem(stage);
    estimate_.fit = problem_->solve();
    if (!estimate_.fit.converged) {
      throw std::runtime_error("the least squares did not converge: " + estimate_.fit.message);
    }
    if (!stage.moving_views) return;
    const NoiseRatio ratio = problem_->noiseRatio();
    const auto refine = [](double& sigma, const std::optional<double>& by, double least, double most) {
      if (by) sigma = std::clamp(sigma * std::clamp(*by, 0.1, 10.0), least, most);
    };
    refine(noise_.corners, ratio.corners, kLeastCornerNoise, kMostCornerNoise);
    refine(noise_.wheel_sqrtm, ratio.wheels, kLeastWheelNoise, kMostWheelNoise);
    refine(noise_.repeatability_rad, ratio.joints, kLeastRepeatability, kMostRepeatability);
  }

  /// Huber's weights; outliers get none for good.
  void reweigh() {
    const auto errors = problem_->cornerErrors();
    const double unit = std::max(1.0, estimate_.fit.normalised_rms);
    estimate_.outliers = 0;
    for (std::size_t v = 0; v < errors.size(); ++v) {
      for (std::size_t c = 0; c < errors[v].size(); ++c) {
        double& weight = weights_[v][c];
        if (errors[v][c] > kOutlier * unit) weight = 0.0;
        if (weight > 0.0) weight = std::min(1.0, kHuber * unit / std::max(errors[v][c], 1e-9));
        if (weight == 0.0) ++estimate_.outliers;
      }
    }
  }

  void conclude() {
    estimate_.noise = noise_;
    estimate_.views = record_.views.size();
    problem_ = problem({true, true});
    const ParameterInformation information = problem_->information();
    std::vector<std::string_view> names;
    std::vector<double> useful;
    for (const std::size_t index : information.parameters) {
      names.push_back(parameterInfos()[index].name);
      useful.push_back(parameterInfos()[index].useful_sigma);
    }
    const Observability known = analyse(information, names, useful);
    estimate_.unknown = known.unknown;
    for (std::size_t i = 0; i < names.size(); ++i) {
      const std::size_t index = information.parameters[i];
      estimate_.rows.push_back({index, parameterOf(estimate_.parameters, index), known.sigma[i]});
    }
    addWhatIsNotInTheProblem(information.parameters);
    placeCamera(information.parameters, known.covariance);
    warn();
  }

  /// A robot that never drove has no residual of its wheels.
  void addWhatIsNotInTheProblem(const std::vector<std::size_t>& parameters) {
    for (std::size_t i = 0; i < kWheelsSize; ++i) {
      const std::size_t index = wheelParameter(static_cast<WheelIndex>(i));
      if (std::find(parameters.begin(), parameters.end(), index) != parameters.end()) continue;
      estimate_.rows.push_back({index, parameterOf(estimate_.parameters, index), std::nullopt});
      estimate_.unknown.push_back({{index}, std::string(parameterInfos()[index].name)});
    }
  }

  void placeCamera(const std::vector<std::size_t>& parameters, const Eigen::MatrixXd& covariance) {
    constexpr double kStep = 1e-6;
    Eigen::MatrixXd J(6, covariance.cols());
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      BodyParameters moved = estimate_.parameters;
      parameterOf(moved, parameters[i]) += kStep;
      const CameraPlace up = placeOf(cameraPose(moved, {}));
      parameterOf(moved, parameters[i]) -= 2.0 * kStep;
      J.col(static_cast<Eigen::Index>(i)) = (up - placeOf(cameraPose(moved, {}))) / (2.0 * kStep);
    }
    const CameraPlace place = placeOf(cameraPose(estimate_.parameters, {}));
    const Eigen::MatrixXd P = J * covariance * J.transpose();
    for (std::size_t i = 0; i < 6; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      const double sigma = std::sqrt(P(row, row));
      const bool known = sigma <= cameraPlaceInfos()[i].useful_sigma;
      estimate_.place[i] = {i, place[row], known ? std::optional(sigma) : std::nullopt};
    }
  }

  void warn() {
    for (const WheelIndex i : {kLeftScale, kRightScale}) {
      if (estimate_.parameters.wheels[i] < 0.5 && estimate_.isObservable(wheelParameter(i))) {
        estimate_.warnings.push_back(std::string(parameterInfos()[wheelParameter(i)].name) +
                                     " is less than half of what was described, or negative: are the wheels "
                                     "swapped or is their sign wrong?");
      }
    }
    warnOfBacklash();
    if (record_.place == BoardPlace::kFloor) warnOfBoard();
    if (estimate_.fit.normalised_rms > 1.5) {
      std::ostringstream text;
      text << "corners scatter " << estimate_.fit.normalised_rms
           << " times as much as their finder states: is the board bent, or the lens out of date?";
      estimate_.warnings.push_back(text.str());
    }
  }

  void warnOfBacklash() {
    for (const BodyIndex i : {kPanBacklash, kTiltBacklash}) {
      const double backlash = estimate_.parameters.body[i];
      if (backlash <= kNotedBacklash || !estimate_.isObservable(i)) continue;
      std::ostringstream text;
      text << "a " << parameterInfos()[i].name << " of " << std::round(radToDeg(backlash) * 100) / 100
           << " degrees: the camera aims up to half of it beside its joint reading, which no key corrects";
      estimate_.warnings.push_back(text.str());
    }
  }

  void warnOfBoard() {
    const double roll = estimate_.parameters.body[kBoardRoll];
    const double pitch = estimate_.parameters.body[kBoardPitch];
    const double tilt = std::hypot(roll, pitch);
    if (tilt <= params_.flatness_sigma_rad) return;
    if (!estimate_.isObservable(kBoardRoll) || !estimate_.isObservable(kBoardPitch)) return;
    std::ostringstream text;
    text << "the board is not flat on the floor: it is tilted by " << std::round(radToDeg(tilt) * 100) / 100
         << " degrees";
    estimate_.warnings.push_back(text.str());
  }

  /// Until the first view at rest nobody knows where the robot stands.
  void dropViewsBeforeRest() {
    const auto first = std::find(still_.begin(), still_.end(), true) - still_.begin();
    record_.views.erase(record_.views.begin(), record_.views.begin() + first);
    still_.erase(still_.begin(), still_.begin() + first);
    if (record_.views.empty()) throw std::runtime_error("no view of the board was taken at rest");
  }

  BodyRecord record_;
  const BodyEstimatorParams& params_;
  JointPath joints_;
  WheelPath wheels_;
  std::vector<bool> still_;
  BodyNoise noise_;
  BodyParameters start_;
  BodyEstimate estimate_;
  std::vector<std::vector<double>> weights_;  ///< by view and corner
  BodyPoses poses_;
  std::unique_ptr<BodyProblem> problem_;
};

}  // namespace

std::string checkRecord(const BodyRecord& record) {
  if (auto problem = checkBoard(record.board); !problem.empty()) return problem;
  if (auto problem = checkIntrinsics(record.intrinsics); !problem.empty()) return problem;
  std::ostringstream problem;
  if (record.views.empty()) {
    problem << "no view of the board";
  } else if (record.joints.size() < 2) {
    problem << "no joint readings";
  } else if (record.odometry.size() < 2) {
    problem << "no odometry";
  }
  for (const BoardView& view : record.views) {
    for (const BoardCorner& corner : view.corners) {
      if (corner.id < 0 || corner.id >= record.board.corners()) {
        problem << "corner " << corner.id << " is not on the board (0.." << record.board.corners() - 1 << ")";
        return problem.str();
      }
      if (!(corner.sigma_px > 0.0)) {
        problem << "a corner with a standard deviation of " << corner.sigma_px << " px (must be positive)";
        return problem.str();
      }
    }
  }
  return problem.str();
}

bool BodyEstimate::isObservable(std::size_t index) const {
  return std::any_of(rows.begin(), rows.end(), [&](const EstimatedParameter& row) {
    return row.index == index && row.sigma.has_value();
  });
}

BodyEstimate estimateBody(const BodyRecord& record, const BodyEstimatorParams& params,
                          const std::function<void(const std::string&)>& progress) {
  if (const std::string problem = checkRecord(record); !problem.empty()) throw std::runtime_error(problem);
  return Estimation(record, params).run(progress);
}

}  // namespace vismem
