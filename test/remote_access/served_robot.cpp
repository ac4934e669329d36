#include "remote_access/served_robot.h"

#include <unistd.h>

#include <stdexcept>

#include "common/process/robot_identity.h"
#include "recording/bag_writer.h"
#include "support/build_paths.h"

namespace vismem::test {
namespace {

Ice::InitializationData settings() {
  Ice::InitializationData data;
  data.properties = Ice::createProperties();
  data.properties->setProperty("Ice.MessageSizeMax", "16384");
  data.properties->setProperty("Ice.Default.InvocationTimeout", "10000");
  data.properties->setProperty("Ice.RetryIntervals", "-1");
  return data;
}

void writeBag(const std::string& file) {
  BagWriter bag(file);
  bag.cameraInfo("/camera/camera_info", 1'000'000, 32, 24, 20.0);
  for (int i = 0; i < 20; ++i) {
    const std::int64_t stamp_us = 1'000'000 + 50'000 * i;
    bag.image("/camera/image_raw", stamp_us, "mono8", 32, 24, std::vector<std::uint8_t>(32 * 24, 7));
    bag.odometry("/odom", stamp_us - 20'000, 0.1 * i, 0.0, 0.0);
    bag.joints("/joint_states", stamp_us - 30'000, {"head_yaw", "head_pitch"}, {0.01 * i, 0.2});
  }
  bag.close();
}

}  // namespace

ServedRobot::ServedRobot()
    : model_(readSlice(VISMEM_SOURCE_DIR "/interfaces")),
      communicator_(Ice::initialize(settings())),
      bag_(std::filesystem::temp_directory_path() / ("remote_access_" + std::to_string(getpid()) + ".bag")) {
  writeBag(bag_.string());
  auto& simulator = start("simulator", "Simulator", {"cfg/sim/simulator.cfg"});
  list(simulator, "simulator", {"cameraA", "PanTilt", "Motors", "Encoders", "Simulation"});
  auto& memory = start(
      "active_visual_memory", "ActiveVisualMemory",
      {"cfg/sim/active_visual_memory.cfg", "--ActiveVisualMemory.Camera.Proxy=" + simulator.proxy("cameraA"),
       "--ActiveVisualMemory.PanTilt.Proxy=" + simulator.proxy("PanTilt"),
       "--ActiveVisualMemory.Odometry.Proxy=" + simulator.proxy("Encoders")});
  list(memory, "active_visual_memory", {"VisualMemory", "Gaze", "memoryView"});
  auto& localization = start("localization", "Localization",
                             {"cfg/sim/localization.cfg", "--Localization.Gaze.Proxy=" + memory.proxy("Gaze"),
                              "--Localization.VisualMemory.Proxy=" + memory.proxy("VisualMemory")});
  list(localization, "localization", {"Localization"});
  auto& replay = start("replay_server", "ReplayServer",
                       {"--ReplayServer.File=" + bag_.string(), "--ReplayServer.Loop=yes"});
  list(replay, "replay_server", {"Replay"});
  auto& recorder = start("recorder", "Recorder",
                         {"--Recorder.Folder=" + recordings_.path().string(), "--Recorder.StartNow=no",
                          "--Recorder.Odometry.Proxy=" + simulator.proxy("Encoders")});
  list(recorder, "recorder", {"Recorder"});
  auto& mapper = start("mapper", "Mapper",
                       {"cfg/sim/mapper.cfg", "--Mapper.Folder=" + recordings_.path().string(),
                        "--Mapper.VisualMemory.Proxy=" + memory.proxy("VisualMemory"),
                        "--Mapper.Camera.Proxy=" + simulator.proxy("cameraA")});
  list(mapper, "mapper", {"Mapper"});
}

ServedRobot::~ServedRobot() {
  while (!processes_.empty()) processes_.pop_back();
  std::filesystem::remove(bag_);
}

ComponentProcess& ServedRobot::start(const std::string& name, const std::string& prefix,
                                     std::vector<std::string> arguments) {
  arguments.push_back("--" + prefix + ".Endpoints=tcp -h 127.0.0.1 -p 0");
  arguments.push_back("--" + prefix + ".WebEndpoints=ws -h 127.0.0.1 -p 0");
  arguments.push_back("--Robot.Token=" + std::string(kToken));
  arguments.push_back("--Robot.ViewToken=" + std::string(kViewToken));
  ChildProcess::Options options;
  options.working_directory = VISMEM_SOURCE_DIR;
  processes_.push_back(std::make_unique<ComponentProcess>(name, arguments, options));
  if (!processes_.back()->readyLine())
    throw std::runtime_error(name + " is not ready:\n" + processes_.back()->error());
  return *processes_.back();
}

void ServedRobot::list(const ComponentProcess& process, const std::string& component,
                       std::vector<std::string> identities) {
  identities.push_back(component + "/component");
  for (const std::string& identity : identities) {
    ServedObject object{&process, component, identity, faceName(identity), nullptr};
    for (const auto& id : proxy(object, Ice::stringToIdentity(identity), false)->ice_ids()) {
      const auto found = model_.interfaces.find(id);
      if (found == model_.interfaces.end()) continue;
      if (object.interface == nullptr ||
          found->second.operations.size() > object.interface->operations.size())
        object.interface = &found->second;
    }
    if (object.interface == nullptr) throw std::runtime_error(identity + " has no interface of ours");
    objects_.push_back(std::move(object));
  }
}

std::string ServedRobot::endpoints(const ComponentProcess& process, bool web) const {
  return std::string(web ? "ws" : "tcp") + " -h 127.0.0.1 -p " +
         std::to_string(process.port(web ? "ws" : "tcp"));
}

std::shared_ptr<Ice::ObjectPrx> ServedRobot::proxy(const ServedObject& object, const Ice::Identity& identity,
                                                   bool web) const {
  const auto any = communicator_->stringToProxy("any:" + endpoints(*object.process, web));
  return any->ice_identity(identity);
}

Answer ServedRobot::call(const ServedObject& object, const Ice::Identity& identity, bool web,
                         const SliceOperation& operation) const {
  const auto mode = operation.idempotent ? Ice::OperationMode::Idempotent : Ice::OperationMode::Normal;
  Ice::ByteSeq result;
  try {
    proxy(object, identity, web)->ice_invoke(operation.name, mode, Ice::ByteSeq{}, result);
  } catch (const Ice::ObjectNotExistException&) {
    return Answer::kNoObject;
  } catch (const Ice::OperationNotExistException&) {
    return Answer::kNoOperation;
  } catch (const Ice::UnknownException&) {
    // The operation was reached: parameters are missing, or it has nothing to say yet.
  }
  return Answer::kPassed;
}

}  // namespace vismem::test
