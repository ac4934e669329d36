#include "bench/gateway/site.h"

#include <stdexcept>
#include <vector>

namespace vismem {

Site::Site(int width, double rate_hz) {
  const std::string folder = certificates_.path().string();
  for (const char* role : {"robot", "station"}) test::makeCertificate(folder, role, role);
  ChildProcess::Options options;
  options.working_directory = VISMEM_SOURCE_DIR;
  robot_ = std::make_unique<ComponentProcess>(
      "simulator",
      std::vector<std::string>{
          "cfg/sim/simulator.cfg", "--Simulator.Endpoints=tcp -h 127.0.0.1 -p 0:ssl -h 127.0.0.1 -p 0",
          "--Simulator.Camera.Width_px=" + std::to_string(width),
          "--Simulator.Camera.Height_px=" + std::to_string(width * 3 / 4),
          "--Simulator.Camera.Rate_hz=" + std::to_string(rate_hz), "--Ice.Plugin.IceSSL=IceSSL:createIceSSL",
          "--IceSSL.DefaultDir=" + folder, "--IceSSL.CAs=ca.pem", "--IceSSL.CertFile=robot.pem",
          "--IceSSL.VerifyPeer=2", "--IceSSL.TrustOnly.Server=OU=\"station\""},
      options);
  if (!robot_->readyLine()) throw std::runtime_error("the simulator is not ready:\n" + robot_->error());
  gateway_ = std::make_unique<test::Gateway>(std::vector<std::string>{plainEndpoint()},
                                             std::map<std::string, std::string>{});
  communicator_ = test::tlsClient(folder, "station.pem");
}

std::string Site::endpoint(const std::string& transport) const {
  return transport + " -h 127.0.0.1 -p " + std::to_string(robot_->port(transport));
}

std::shared_ptr<avm::CameraPrx> Site::camera(const std::string& transport) const {
  return Ice::uncheckedCast<avm::CameraPrx>(communicator_->stringToProxy("cameraA:" + endpoint(transport)));
}

void Site::pause(bool paused) const {
  Ice::uncheckedCast<avm::SimulationPrx>(communicator_->stringToProxy("Simulation:" + plainEndpoint()))
      ->setPaused(paused);
}

}  // namespace vismem
