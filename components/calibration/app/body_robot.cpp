#include "calibration/app/body_robot.h"

#include <stdexcept>

#include "calibration/core/target/board_detector.h"
#include "common/config/config_error.h"
#include "common/process/ice_setup.h"
#include "common/process/setup.h"
#include "common/recording/robot_log.h"
#include "common/robot_ice/lease_ice.h"
#include "common/tool/progress_line.h"

namespace vismem {
namespace {

constexpr std::chrono::seconds kRenewal{1};
constexpr StampUs kViewInterval_us = 200'000;
constexpr std::size_t kLeastCorners = 8;

template <typename Prx>
std::shared_ptr<Prx> proxyOf(Ice::Communicator& communicator, const std::string& text, const char* what) {
  try {
    const auto proxy = communicator.stringToProxy(text);
    if (!proxy) throw ConfigError({std::string(what) + ": no proxy is configured"});
    return Ice::uncheckedCast<Prx>(proxy);
  } catch (const Ice::Exception& error) {
    throw ConfigError({std::string(what) + ": \"" + text + "\" is no proxy: " + error.what()});
  }
}

/// Takes the lease. @param proxy then sends it with each call.
template <typename Prx>
std::string lease(std::shared_ptr<Prx>& proxy, const char* what) {
  try {
    const avm::Lease taken = boundedProxy(proxy, kCommandTimeout_ms)
                                 ->acquire("calibrate body", LeasedRobot::kPriority, LeasedRobot::kLease_s);
    proxy = Ice::uncheckedCast<Prx>(proxy->ice_context(Ice::Context{{kLeaseContext, taken.id}}));
    return taken.id;
  } catch (const avm::LeaseRefused& refused) {
    throw std::runtime_error(std::string(what) + ": " + refused.reason);
  } catch (...) {
    throw std::runtime_error(std::string(what) + ": " + describeFailure(*proxy, std::current_exception()));
  }
}

template <typename Prx>
void renew(const std::shared_ptr<Prx>& proxy, const std::string& id) {
  try {
    boundedProxy(proxy, kCommandTimeout_ms)->renew(id);
  } catch (const Ice::Exception&) {
    // The next command says why.
  }
}

template <typename Prx>
void release(const std::shared_ptr<Prx>& proxy, const std::string& id) {
  if (id.empty()) return;
  try {
    boundedProxy(proxy, kCommandTimeout_ms)->release(id);
  } catch (const Ice::Exception&) {
    // Its server is gone, and the lease with it; or it ends by itself.
  }
}

}  // namespace

LeasedRobot::LeasedRobot(const ActiveVisualMemoryConfig& setup, const std::string& motors, int port_offset)
    : log_("calibrate", LogLevel::kError), ice_(makeCommunicator(Properties{}, log_)) {
  Ice::Communicator& c = *ice_.communicator();
  const auto shifted = [&](const std::string& text) { return shiftPorts(text, port_offset); };
  const auto camera = proxyOf<avm::CameraPrx>(c, shifted(setup.camera_proxy), "camera");
  const auto odometry = proxyOf<avm::OdometryPrx>(c, shifted(setup.odometry_proxy), "odometry");
  unit_ = proxyOf<avm::PanTiltPrx>(c, shifted(setup.pan_tilt_proxy), "pan-tilt unit");
  motors_ = proxyOf<avm::BasePrx>(c, shifted(motors), "base");
  base_lease_ = lease(motors_, "base");
  try {
    head_lease_ = lease(unit_, "pan-tilt unit");
  } catch (...) {
    release(motors_, base_lease_);
    throw;
  }
  camera_ = std::make_unique<RemoteFrameSource>(camera, FrameFormat::kGray8);
  head_ = std::make_unique<RemotePanTiltUnit>(unit_);
  base_ = std::make_unique<RemoteMobileBase>(motors_, odometry);
}

LeasedRobot::~LeasedRobot() {
  release(motors_, base_lease_);
  release(unit_, head_lease_);
}

void LeasedRobot::keepLeases() {
  const auto now = std::chrono::steady_clock::now();
  if (now - renewed_ < kRenewal) return;
  renewed_ = now;
  renew(motors_, base_lease_);
  renew(unit_, head_lease_);
}

BodyRecord recordOfBag(const std::string& path, const BoardSpec& board, BoardPlace place) {
  const RobotLog log = RobotLog::open(path);
  if (log.joints().empty()) {
    throw std::runtime_error(path + ": no joint readings of a pan-tilt unit, which the calibration needs");
  }
  BodyRecord record;
  record.board = board;
  record.place = place;
  record.joints = log.joints();
  record.odometry = log.odometry();
  BoardDetector detector(board);
  ProgressLine line("images");
  std::optional<StampUs> last;
  const std::vector<StampUs>& stamps = log.frameStamps();
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    line.show(i, stamps.size());
    if (last && stamps[i] - *last < kViewInterval_us) continue;
    last = stamps[i];
    const Frame frame = log.readFrame(i);
    record.intrinsics = frame.intrinsics;
    BoardView view = detector.detect(frame.image, frame.stamp_us).view;
    if (view.corners.size() >= kLeastCorners) record.views.push_back(std::move(view));
  }
  if (record.views.empty()) throw std::runtime_error(path + ": the board is in none of the images");
  return record;
}

}  // namespace vismem
