#include "localization/ice/localization_ice.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "common/robot_ice/conversions.h"

namespace vismem {
namespace {

bool usable(const avm::PoseEstimate& e) {
  const auto finite = [](const avm::Pose2& p) { return allFinite({p.x, p.y, p.theta}); };
  const avm::Symmetric3& m = e.covariance;
  return finite(e.robotInWorld) && finite(e.robotInOdom) &&
         allFinite({m.m00, m.m01, m.m02, m.m11, m.m12, m.m22, e.reliability}) &&
         std::all_of(e.races.begin(), e.races.end(), [&](const avm::Race& race) {
           return finite(race.robotInWorld) && allFinite({race.health, race.weight});
         });
}

/// A health map of the largest size after a full queue.
constexpr int kDrawingTimeout_ms = 120'000;

std::optional<std::int64_t> known(std::int64_t after_revision) {
  if (after_revision <= 0) return std::nullopt;
  return after_revision;
}

}  // namespace

avm::PoseEstimate toIce(const PoseEstimate& e) {
  avm::PoseEstimate result;
  result.stampUs = e.stamp_us;
  result.revision = static_cast<Ice::Long>(e.revision);
  result.hasPose = e.T_world_robot.has_value();
  result.robotInWorld = toIce(e.T_world_robot.value_or(Pose2{}));
  result.robotInOdom = toIce(e.T_odom_robot);
  result.covariance = toIce(e.P);
  result.reliability = e.reliability;
  result.races.reserve(e.races.size());
  for (const RaceReport& race : e.races) {
    result.races.push_back({static_cast<Ice::Long>(race.id), toIce(race.T_world_robot), race.health,
                            race.weight, race.victories, race.age, race.winner});
  }
  return result;
}

PoseEstimate fromIce(const avm::PoseEstimate& e) {
  PoseEstimate result;
  result.stamp_us = e.stampUs;
  result.revision = static_cast<std::uint64_t>(e.revision);
  if (e.hasPose) result.T_world_robot = fromIce(e.robotInWorld);
  result.T_odom_robot = fromIce(e.robotInOdom);
  result.P = fromIce(e.covariance);
  result.reliability = e.reliability;
  result.races.reserve(e.races.size());
  for (const avm::Race& race : e.races) {
    result.races.push_back({static_cast<std::uint64_t>(race.id), fromIce(race.robotInWorld), race.health,
                            race.weight, race.victories, race.age, race.winner});
  }
  return result;
}

static_assert(static_cast<int>(PlaceRating::kImage) == static_cast<int>(avm::PlaceRating::ImageHealth));
static_assert(static_cast<int>(PlaceRating::kMemory) == static_cast<int>(avm::PlaceRating::MemoryHealth));
static_assert(static_cast<int>(PlaceRating::kExplained) == static_cast<int>(avm::PlaceRating::Explained));
static_assert(static_cast<int>(PlaceRating::kLikelihood) == static_cast<int>(avm::PlaceRating::Likelihood));

avm::HealthMapRequest toIce(const HealthMapRequest& request) {
  avm::HealthMapRequest result;
  result.rating = static_cast<avm::PlaceRating>(request.rating);
  result.hasHeading = request.theta_rad.has_value();
  result.thetaRad = request.theta_rad.value_or(0.0);
  result.headings = request.headings;
  result.cellM = request.cell_m;
  result.hasArea = request.low && request.high;
  result.low = toIce(request.low.value_or(Eigen::Vector2d::Zero()));
  result.high = toIce(request.high.value_or(Eigen::Vector2d::Zero()));
  return result;
}

HealthMapRequest fromIce(const avm::HealthMapRequest& request) {
  HealthMapRequest result;
  result.rating = static_cast<PlaceRating>(request.rating);
  if (request.hasHeading) result.theta_rad = request.thetaRad;
  result.headings = request.headings;
  result.cell_m = request.cellM;
  if (request.hasArea) {
    result.low = fromIce(request.low);
    result.high = fromIce(request.high);
  }
  return result;
}

avm::HealthGrid toIce(const HealthMap& map) {
  return {map.stamp_us, toIce(map.low), map.cell_m, map.columns, map.rows, map.health, map.theta_rad};
}

std::optional<HealthMap> fromIce(const avm::HealthGrid& map) {
  const auto finite = [](const std::vector<float>& values) {
    return std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); });
  };
  const double places = static_cast<double>(map.columns) * map.rows;
  if (map.columns < 1 || map.rows < 1 || places != static_cast<double>(map.health.size()) ||
      places != static_cast<double>(map.thetaRad.size()) || !(map.cellM > 0.0) ||
      !allFinite({map.low.x, map.low.y, map.cellM}) || !finite(map.health) || !finite(map.thetaRad)) {
    return std::nullopt;
  }
  HealthMap result;
  result.stamp_us = map.stampUs;
  result.low = fromIce(map.low);
  result.cell_m = map.cellM;
  result.columns = map.columns;
  result.rows = map.rows;
  result.health = map.health;
  result.theta_rad = map.thetaRad;
  return result;
}

avm::PoseEstimate LocalizationServant::latest(const Ice::Current&) {
  const auto newest = estimates_.latest();
  if (!newest) throw avm::NotAvailable(estimates_.message());
  return toIce(*newest);
}

void LocalizationServant::nextAsync(Ice::Long after_revision,
                                    std::function<void(const avm::EstimateResult&)> response,
                                    std::function<void(std::exception_ptr)> exception, const Ice::Current&) {
  estimates_.whenOther(
      known(after_revision), kLongPollWait,
      [response = std::move(response), exception = std::move(exception)](const auto& reading) {
        try {
          response({toIce(reading.state), reading.message,
                    reading.value ? toIce(*reading.value) : avm::PoseEstimate{}});
        } catch (...) {
          exception(std::current_exception());
        }
      });
}

avm::CommandReply LocalizationServant::setPose(avm::Pose2 T_world_robot, const Ice::Current&) {
  requireFinite("robotInWorld.x", T_world_robot.x);
  requireFinite("robotInWorld.y", T_world_robot.y);
  requireFinite("robotInWorld.theta", T_world_robot.theta);
  return toIce(commands_.setPose(fromIce(T_world_robot)));
}

avm::CommandReply LocalizationServant::relocalize(const Ice::Current&) {
  return toIce(commands_.relocalize());
}

void LocalizationServant::healthMapAsync(avm::HealthMapRequest request,
                                         std::function<void(const avm::HealthGrid&)> response,
                                         std::function<void(std::exception_ptr)> exception,
                                         const Ice::Current&) {
  const HealthMapRequest wanted = fromIce(request);
  const std::string wrong = health_maps_.check(wanted);
  if (!wrong.empty()) throw avm::InvalidArgument(wrong);
  const PortReply reply =
      health_maps_.draw(wanted, [response = std::move(response), exception = std::move(exception)](
                                    const std::optional<HealthMap>& map, const std::string& why) {
        try {
          if (!map) throw avm::NotAvailable(why);
          response(toIce(*map));
        } catch (...) {
          exception(std::current_exception());
        }
      });
  if (!reply.ok()) throw avm::Refused(reply.message);
}

std::shared_ptr<jderobot::Pose3DData> LocalizationServant::getPose3DData(const Ice::Current&) {
  const auto newest = estimates_.latest();
  if (!newest || !newest->T_world_robot) {
    throw Ice::UnknownException(__FILE__, __LINE__, "localization has no pose yet");
  }
  return std::make_shared<jderobot::Pose3DData>(toPose3D(*newest->T_world_robot, pose3d_scale_));
}

int LocalizationServant::setPose3DData(std::shared_ptr<jderobot::Pose3DData> data, const Ice::Current&) {
  if (!data) return -1;
  const auto pose = fromPose3D(*data, pose3d_scale_);
  return pose && commands_.setPose(*pose).ok() ? 0 : -1;
}

RemoteLocalization::RemoteLocalization(const std::shared_ptr<avm::LocalizationPrx>& proxy, LinkReport report)
    : proxy_(boundedProxy(proxy, kInvocationTimeout_ms)),
      commands_(boundedProxy(proxy, kCommandTimeout_ms)),
      drawings_(proxy ? proxy->ice_invocationTimeout(kDrawingTimeout_ms) : nullptr),
      estimates_(proxy_, std::move(report)) {}

std::optional<PoseEstimate> RemoteLocalization::latest() const {
  if (!commands_) return std::nullopt;
  try {
    const avm::PoseEstimate estimate = commands_->latest();
    if (!usable(estimate)) return std::nullopt;
    return fromIce(estimate);
  } catch (const Ice::Exception&) {
    // Away or none yet: the header promises an empty answer for both.
    return std::nullopt;
  }
}

std::optional<PoseEstimate> RemoteLocalization::next(std::uint64_t after_revision,
                                                     std::chrono::milliseconds timeout) {
  const auto outcome = estimates_.wait(
      [this, after_revision](auto done, auto failed) {
        proxy_->nextAsync(static_cast<Ice::Long>(after_revision), std::move(done), std::move(failed));
      },
      timeout);
  if (!outcome.result || outcome.result->state != avm::SourceState::Running) return std::nullopt;
  if (!usable(outcome.result->estimate)) return std::nullopt;
  return fromIce(outcome.result->estimate);
}

PortReply RemoteLocalization::setPose(const Pose2& T_world_robot) {
  return runRemote(commands_, "localization",
                   [&T_world_robot](avm::LocalizationPrx& l) { return l.setPose(toIce(T_world_robot)); });
}

PortReply RemoteLocalization::relocalize() {
  return runRemote(commands_, "localization", [](avm::LocalizationPrx& l) { return l.relocalize(); });
}

RemoteLocalization::HealthMapResult RemoteLocalization::healthMap(const HealthMapRequest& request) {
  if (!drawings_) return {std::nullopt, "no localization is configured"};
  try {
    auto map = fromIce(drawings_->healthMap(toIce(request)));
    if (!map) return {std::nullopt, "localization sent an invalid health map"};
    return {std::move(map), {}};
  } catch (...) {
    return {std::nullopt, describeFailure(*drawings_, std::current_exception())};
  }
}

}  // namespace vismem
