#include "fleet/app/robot_reports.h"

#include <utility>

#include "common/process/component_servant.h"

namespace vismem {

avm::RobotReport RobotReports::next(const std::optional<avm::PoseEstimate>& estimate,
                                    const std::map<std::string, StatusAnswer>& parts, std::int64_t host_us,
                                    std::chrono::steady_clock::time_point now) {
  avm::RobotReport report;
  report.robot = robot_;
  report.number = ++number_;
  report.stampUs = host_us;
  if (estimate && std::exchange(revision_, estimate->revision) != estimate->revision) changed_ = now;
  report.hasPose = estimate && estimate->hasPose && now - changed_ <= kFresh;
  if (report.hasPose) {
    report.poseStampUs = estimate->stampUs;
    report.robotInWorld = estimate->robotInWorld;
    report.covariance = estimate->covariance;
    report.reliability = estimate->reliability;
  }
  for (const auto& [name, answer] : parts) {
    if (answer.report) {
      report.parts.push_back({name, toSlice(answer.report->state), answer.report->reason});
    } else {
      report.parts.push_back({name, avm::ComponentState::Stopping, answer.failure});
    }
  }
  return report;
}

}  // namespace vismem
