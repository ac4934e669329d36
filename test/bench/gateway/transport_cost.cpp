#include "bench/gateway/transport_cost.h"

#include <unistd.h>

#include <chrono>
#include <memory>
#include <stdexcept>

#include "bench/gateway/processor_time.h"
#include "bench/percentile.h"

namespace vismem {
namespace {

constexpr int kCalls = 20;

double call_us(avm::CameraPrx& camera) {
  const auto begin = std::chrono::steady_clock::now();
  const auto image = camera.getImageData("RGB8");
  const std::chrono::duration<double, std::micro> taken = std::chrono::steady_clock::now() - begin;
  if (image->pixelData.empty()) throw std::runtime_error("the camera gave an empty image");
  return taken.count();
}

}  // namespace

std::vector<TransportCost> measureTransports(const Site& site, int rounds) {
  const auto session = site.gateway().operatorSession();
  const std::vector<std::shared_ptr<avm::CameraPrx>> cameras{
      site.camera("tcp"), site.camera("ssl"),
      session->find<avm::CameraPrx>("cameraA:" + site.plainEndpoint())};
  std::vector<TransportCost> costs{{"tcp"}, {"ssl"}, {"gateway"}};
  const auto processor_s = [&] {
    return processorTime_s(getpid()) + processorTime_s(site.robot()) +
           processorTime_s(site.gateway().router(false));
  };
  std::vector<std::vector<double>> times_us(costs.size());
  // The first round connects.
  for (int round = -1; round < rounds; ++round) {
    for (std::size_t way = 0; way < costs.size(); ++way) {
      const double before_s = processor_s();
      for (int i = 0; i < kCalls; ++i) {
        const double us = call_us(*cameras[way]);
        if (round >= 0) times_us[way].push_back(us);
      }
      if (round >= 0) costs[way].processor_us += 1e6 * (processor_s() - before_s) / kCalls / rounds;
    }
  }
  for (std::size_t way = 0; way < costs.size(); ++way) {
    costs[way].median_us = percentile(times_us[way], 0.5);
    costs[way].median_ratio = costs[way].median_us / costs[0].median_us;
    costs[way].processor_ratio = costs[way].processor_us / costs[0].processor_us;
  }
  return costs;
}

}  // namespace vismem
