/// @file fleet_agent: the robot's agent at its site.
#include "fleet/app/component.h"

int main(int argc, char** argv) {
  return vismem::runComponent(argc, argv, vismem::fleetAgentSpec());
}
