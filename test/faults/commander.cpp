// A program that drives a base twenty times a second until it is killed, for the tests of the watchdog.
// usage: commander PROXY V_MPS W_RADPS
#include <Ice/Ice.h>
#include <avm/base.h>

#include <chrono>
#include <cstdlib>
#include <iostream>
#include <thread>

int main(int argc, char** argv) {
  if (argc != 4) return 2;
  try {
    const Ice::CommunicatorHolder ice(Ice::initialize());
    const auto base =
        Ice::uncheckedCast<avm::BasePrx>(ice->stringToProxy(argv[1])->ice_invocationTimeout(1000));
    for (bool reported = false;; std::this_thread::sleep_for(std::chrono::milliseconds(50))) {
      try {
        base->setVelocity(std::atof(argv[2]), std::atof(argv[3]));
      } catch (const avm::LeaseRefused&) {
        continue;  // the lease of the commander before lasts for up to a second
      }
      if (!reported) std::cout << "commander ready: drives" << std::endl;
      reported = true;
    }
  } catch (const std::exception& failure) {
    std::cerr << failure.what() << std::endl;
    return 1;
  }
}
