#include "fleet/app/config.h"

#include "common/process/robot_identity.h"

namespace vismem {

FleetAgentConfig readFleetAgentConfig(ConfigReader& root) {
  ConfigReader reader = root.group("FleetAgent");
  FleetAgentConfig config;
  reader.describe({basic("Localization.Proxy", "whose pose is reported; empty: none"),
                   basic("TopicManager.Proxy", "of IceStorm at the site; empty: no reports"),
                   basic("Topic", "of the reports, the same for all robots of the site"),
                   expert("Rate_hz", "reports a second")});
  config.robot = readRobotKeys(root).name;
  config.localization = reader.text("Localization.Proxy", "");
  for (const std::string& name : reader.children("Components")) {
    config.parts[name] =
        reader.group("Components." + name).requiredText("Proxy", "the proxy of an avm::Component");
  }
  config.topics = reader.text("TopicManager.Proxy", "");
  config.topic = reader.text("Topic", "robots");
  config.rate_hz = reader.real("Rate_hz", config.rate_hz, 0.1, 20.0);
  if (config.robot.empty()) root.problem("Robot.Name", "must be a name that no other robot of the site has");
  if (config.topic.empty()) reader.problem("Topic", "must be a name");
  return config;
}

}  // namespace vismem
