// base_commander PROXY V_MPS W_RADPS: drives a base with these speeds, 20 commands per second, until it is
// killed.
#include <Ice/Ice.h>

#include <chrono>
#include <cstdlib>
#include <iostream>
#include <thread>

#include "common/robot_ice/base_ice.h"

int main(int argc, char** argv) {
  if (argc != 4) {
    std::cerr << "usage: base_commander PROXY V_MPS W_RADPS" << std::endl;
    return 2;
  }
  const Ice::CommunicatorHolder ice(Ice::InitializationData{});
  vismem::RemoteMobileBase base(Ice::uncheckedCast<avm::BasePrx>(ice->stringToProxy(argv[1])), nullptr);
  const double v_mps = std::atof(argv[2]);
  const double w_radps = std::atof(argv[3]);
  while (true) {
    const vismem::PortReply reply = base.setVelocity(v_mps, w_radps);
    if (!reply.ok()) {
      std::cerr << reply.message << std::endl;
      return 1;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
}
