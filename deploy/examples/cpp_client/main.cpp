// robot_client [SECONDS [PORT_OFFSET]]: prints pose and size of the memory, and asks the gaze for the
// place 1.5 m ahead. The comments of the Slice files have units, frames and exceptions of every operation.
#include <Ice/Ice.h>
#include <avm/gaze.h>
#include <avm/localization.h>
#include <avm/visual_memory.h>

#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <limits>

namespace {

template <typename Prx>
std::shared_ptr<Prx> find(const Ice::CommunicatorPtr& communicator, const std::string& name, int port) {
  const std::string text = name + ":tcp -h 127.0.0.1 -p " + std::to_string(port);
  auto proxy = Ice::checkedCast<Prx>(communicator->stringToProxy(text));
  if (!proxy) throw std::runtime_error(text + " is no " + Prx::ice_staticId());
  return proxy;
}

/// Asks for the floor 1.5 m ahead of the robot, for 3 s of the images' clock.
void lookAhead(avm::GazePrx& gaze, const avm::MemorySnapshot& memory) {
  const avm::Pose2& robot = memory.robotInOdom;
  avm::GazeRequest request;
  request.client = "robot_client";
  request.key = "ahead";
  request.target.isPlace = true;
  request.target.place = {robot.x + 1.5 * std::cos(robot.theta), robot.y + 1.5 * std::sin(robot.theta), 0.0};
  request.priority = 10.0;
  request.deadlineUs = memory.stampUs + 3'000'000;
  gaze.request(request);
}

void watch(const Ice::CommunicatorPtr& communicator, double seconds, int offset) {
  const auto localization = find<avm::LocalizationPrx>(communicator, "Localization", 9971 + offset);
  const auto memory = find<avm::VisualMemoryPrx>(communicator, "VisualMemory", 9970 + offset);
  const auto gaze = find<avm::GazePrx>(communicator, "Gaze", 9970 + offset);
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  std::int64_t revision = 0;
  while (std::chrono::steady_clock::now() < end) {
    const avm::EstimateResult result = localization->next(revision);  // waits at most 1 s
    if (result.state != avm::SourceState::Running) {
      std::cerr << "no estimate: " << result.message << "\n";
      continue;
    }
    if (result.estimate.revision == revision) continue;
    revision = result.estimate.revision;
    const avm::MemorySnapshot snapshot = memory->latest().snapshot;
    const avm::Pose2& pose = result.estimate.robotInWorld;
    std::cout << "x " << pose.x << " m, y " << pose.y << " m, heading " << pose.theta << " rad, reliability "
              << result.estimate.reliability << ", " << snapshot.segments.size() << " segments" << std::endl;
    lookAhead(*gaze, snapshot);
  }
}

}  // namespace

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 10.0;
  const int offset = argc > 2 ? std::atoi(argv[2]) : 0;
  try {
    Ice::InitializationData settings;
    settings.properties = Ice::createProperties();
    settings.properties->setProperty("Ice.MessageSizeMax", "16384");  // large images, in KB
    settings.properties->setProperty("Ice.Default.InvocationTimeout", "3000");
    const Ice::CommunicatorHolder communicator(settings);
    watch(communicator.communicator(), seconds, offset);
    return 0;
  } catch (const avm::Failure& failure) {
    std::cerr << failure.reason << "\n";
  } catch (const std::exception& failure) {
    std::cerr << failure.what() << "\n";
  }
  return 1;
}
