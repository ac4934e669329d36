#include "mapper/app/live_map.h"

#include <Ice/Ice.h>
#include <avm/mapper.h>

#include <chrono>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>

#include "common/process/ice_failure.h"
#include "common/robot_ice/remote.h"
#include "common/tool/progress_line.h"

namespace vismem {
namespace {

constexpr std::chrono::milliseconds kAskEvery{200};

avm::MapperStatus waitForMap(avm::MapperPrx& mapper, int built) {
  ProgressLine progress("% of the drive searched for places seen before");
  for (;;) {
    const avm::MapperStatus status = mapper.status();
    if (!status.building && status.built > built) return status;
    if (!status.building) throw std::runtime_error("the mapper has restarted: its drive is lost");
    progress.show(static_cast<std::size_t>(100.0 * status.progress), 100);
    std::this_thread::sleep_for(kAskEvery);
  }
}

}  // namespace

nlohmann::json makeLiveMap(const std::string& proxy, const std::string& name) {
  const Ice::CommunicatorHolder communicator(Ice::initialize());
  std::shared_ptr<Ice::ObjectPrx> object;
  try {
    object = communicator->stringToProxy(proxy);
  } catch (const Ice::ProxyParseException& error) {
    throw std::runtime_error("--live " + proxy + ": " + error.str);
  }
  if (!object) throw std::runtime_error("--live: expected a proxy, such as Mapper:tcp -h 127.0.0.1 -p 9974");
  const auto mapper =
      Ice::uncheckedCast<avm::MapperPrx>(object->ice_invocationTimeout(kInvocationTimeout_ms));
  avm::MapperStatus status;
  try {
    const int built = mapper->status().built;
    mapper->build(name);
    status = waitForMap(*mapper, built);
  } catch (const Ice::Exception&) {
    throw std::runtime_error(describeFailure(*mapper, std::current_exception()));
  }
  nlohmann::json summary{
      {"file", status.last.file},  {"segments", status.last.edges},  {"seen_again", status.last.seenAgain},
      {"way_m", status.last.wayM}, {"seconds", status.last.seconds}, {"notes", status.last.notes}};
  if (!status.last.problems.empty()) summary["problems"] = status.last.problems;
  return summary;
}

}  // namespace vismem
