#include "bench/gateway/crowd_cost.h"

#include <avm/base.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <functional>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include "bench/gateway/crowd.h"
#include "bench/gateway/processor_time.h"
#include "bench/percentile.h"

namespace vismem {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;
using namespace std::chrono_literals;

/// Calls once each period. A call that takes longer delays the next ones, and their wait counts, as a person
/// at the stick has it.
CallTimes callFor(double seconds, const std::function<void()>& call) {
  std::vector<double> ms;
  const auto end = Clock::now() + std::chrono::duration_cast<Clock::duration>(Seconds(seconds));
  for (auto due = Clock::now(); due < end; due += 20ms) {
    std::this_thread::sleep_until(due);
    call();
    ms.push_back(1e3 * Seconds(Clock::now() - due).count());
  }
  return {percentile(ms, 0.5), percentile(ms, 0.99), percentile(ms, 1.0)};
}

}  // namespace

CrowdCost measureCrowd(const Site& site, int viewers, double seconds) {
  CrowdCost cost;
  const auto operators = site.gateway().operatorSession();
  const auto base = operators->find<avm::BasePrx>("Motors:" + site.plainEndpoint());
  const std::function<void()> drive = [&] { base->setVelocity(0.0, 0.0); };
  drive();
  cost.operator_alone = callFor(0.3 * seconds, drive);

  const auto begin = Clock::now();
  Crowd crowd(site.gateway(), site.plainEndpoint(), viewers);
  cost.login_ms = 1e3 * Seconds(Clock::now() - begin).count() / viewers;
  const auto viewer = site.gateway().viewerSession();
  const auto camera = viewer->find<avm::CameraPrx>("robot.view/cameraA:" + site.plainEndpoint());
  const std::function<void()> look = [&] { camera->getInfo(); };
  look();
  std::this_thread::sleep_for(1s);  // all of them stream

  const std::array processes{site.gateway().router(true), site.gateway().router(false), site.robot(),
                             getpid()};
  const std::array shares{&cost.router, &cost.other_router, &cost.robot, &cost.viewers};
  for (std::size_t i = 0; i < processes.size(); ++i) *shares[i] = -processorTime_s(processes[i]);
  crowd.take();
  const auto from = Clock::now();
  // Each call has its thread: one that is slow delays no other.
  std::jthread other([&] { cost.viewer_beside = callFor(seconds, look); });
  cost.operator_beside = callFor(seconds, drive);
  other.join();
  const double passed_s = Seconds(Clock::now() - from).count();
  const CrowdCount count = crowd.take();
  for (std::size_t i = 0; i < processes.size(); ++i)
    *shares[i] = (*shares[i] + processorTime_s(processes[i])) / passed_s;
  if (const auto failure = crowd.failure(); !failure.empty())
    throw std::runtime_error("a viewer lost its session: " + failure);
  cost.rate_hz = static_cast<double>(count.images) / viewers / passed_s;
  cost.least_rate_hz = static_cast<double>(count.least_images) / passed_s;
  if (count.images > 0)
    cost.image_bytes = static_cast<double>(count.bytes) / static_cast<double>(count.images);
  return cost;
}

}  // namespace vismem
