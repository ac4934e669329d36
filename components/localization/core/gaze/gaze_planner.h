/// @file The localization's gaze request: when it is made, for which direction, and when it ends. Pure.
/// See B4, A6.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "common/config/parameter_visitor.h"
#include "common/geometry/angles.h"
#include "common/visual_memory/gaze.h"
#include "localization/core/gaze/gaze_advisor.h"

namespace vismem {

struct GazePlannerParams {
  GazeAdvisorParams advisor;
  double uncertainty_above = 0.3;  ///< uncertainty (see GazePlanner) from which gaze is requested
  double confirm_s = 1.0;  ///< requests continue this long after: a plain wall agrees with many places
  /// Priority at uncertainty 0 and at 1 (see GazeRequest::priority; kUrgentPriority).
  double least_priority = 50.0;
  double most_priority = 100.0;
  double deadline_s = 2.0;  ///< of a request; a direction not reached within it is abandoned for a while
  double seen_rad = degToRad(20.0);  ///< largest angle to the camera's axis of a reached one
  double move_rad = degToRad(10.0);  ///< a request moves if the best direction is further off

  void visit(ParameterVisitor& v) {
    v.alias("DoubtAbove", "UncertaintyAbove");
    v.real(basic("UncertaintyAbove", "B4: uncertainty (0..1) from which gaze is requested"),
           uncertainty_above, 0.0, 1.0);
  }
};

/// Calls to a GazeClient; the withdrawal comes first.
struct GazePlan {
  std::optional<std::string> withdrawn;  ///< key
  std::optional<GazeRequest> request;

  bool isEmpty() const { return !withdrawn && !request; }
};

/// The client name of localization.
inline constexpr const char* kGazeClientName = "localization";

/// Makes all calls of a plan.
/// @return number of rejected calls.
int carryOut(const GazePlan& plan, GazeClient& client);

/// Keeps one gaze request while the pose is uncertain and moves it to the best direction of every update,
/// also while the head turns. With a certain pose there is none, so that salience and other clients have the
/// camera. Uncertainty is 1 minus the winner's share of belief times the smaller of its support and its
/// present health.
/// Invariant: at most one request stands, with a deadline.
/// *Single-threaded* (owner: the component's loop).
class GazePlanner {
 public:
  /// @param likelihood, @param map and @param map_edges of the Localizer whose estimates plan() takes.
  GazePlanner(const GazePlannerParams& params, const LikelihoodParams& likelihood, const MapParams& map,
              const SegmentMap& map_edges);

  /// To be called with every update.
  /// @param estimate of the update, as Localizer::update returns it.
  GazePlan plan(const PoseEstimate& estimate, const MemoryUpdate& update);

  /// Uncertainty above which it requests gaze from the next plan on, 0..1.
  void setUncertaintyAbove(double uncertainty) { params_.uncertainty_above = uncertainty; }
  /// Time for which it goes on requesting afterwards [s], >= 0.
  void setConfirmation(double duration_s) { params_.confirm_s = duration_s; }

  /// 0 (certain) .. 1 (unknown).
  static double uncertainty(const PoseEstimate& estimate);
  /// The direction of the standing request.
  std::optional<GazeAdvice> requested() const;

 private:
  struct Standing {
    std::string key;
    GazeAdvice advice;
    StampUs asked_us = 0;    ///< last
    StampUs reached_us = 0;  ///< last stamp at which the camera was there, or of the request's last move
  };
  void updateReached(const MemoryUpdate& update);

  GazePlannerParams params_;
  GazeAdvisor advisor_;
  std::optional<Standing> standing_;
  std::optional<StampUs> uncertain_us_;  ///< last; empty: the pose is certain
  std::uint32_t epoch_ = 0;
  StampUs last_stamp_us_ = 0;
  std::uint64_t asked_ = 0;
};

}  // namespace vismem
