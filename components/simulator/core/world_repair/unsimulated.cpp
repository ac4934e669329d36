#include "simulator/core/world_repair/unsimulated.h"

#include <tinyxml2.h>

#include <map>
#include <set>
#include <string_view>

namespace vismem {
namespace {

using tinyxml2::XMLElement;
using Names = std::set<std::string_view>;

/// What is removed, by the name of the element around it.
const std::map<std::string_view, Names>& unsimulated() {
  static const std::map<std::string_view, Names> kUnsimulated{
      {"world",
       {"physics", "gui", "plugin", "audio", "wind", "gravity", "magnetic_field", "atmosphere",
        "spherical_coordinates"}},
      {"scene", {"sky", "fog", "grid", "shadows", "origin_visual"}},
      {"model", {"plugin", "gripper", "self_collide", "allow_auto_disable", "enable_wind"}},
      {"link",
       {"inertial", "velocity_decay", "gravity", "enable_wind", "self_collide", "kinematic",
        "must_be_base_link", "battery", "audio_sink", "audio_source", "projector", "particle_emitter",
        "plugin"}},
      {"collision", {"surface", "max_contacts", "laser_retro"}},
      {"visual", {"plugin", "meta", "laser_retro", "cast_shadows"}},
      {"material", {"specular", "lighting", "shader", "render_order", "double_sided"}},
      {"light", {"specular", "visualize"}},
      {"joint", {"axis", "axis2", "physics", "sensor", "plugin", "gearbox_ratio", "thread_pitch"}},
      {"state", {"sim_time", "wall_time", "real_time", "iterations", "light", "insertions", "deletions"}},
  };
  return kUnsimulated;
}

bool hasCamera(const XMLElement& sensor) {
  const char* type = sensor.Attribute("type");
  return sensor.FirstChildElement("camera") != nullptr ||
         (type != nullptr && std::string_view(type).find("camera") != std::string_view::npos);
}

/// @param in_state below <state>, where models have poses and velocities only.
bool isUnsimulated(const XMLElement& parent, const XMLElement& child, bool in_state) {
  const std::string_view name = child.Name();
  if (name == "sensor" && !hasCamera(child)) return true;
  if (in_state && std::string_view(parent.Name()) == "model") return name != "pose" && name != "scale";
  const auto names = unsimulated().find(parent.Name());
  return names != unsimulated().end() && names->second.contains(name);
}

void removeBelow(XMLElement& element, bool in_state) {
  in_state = in_state || std::string_view(element.Name()) == "state";
  for (XMLElement* child = element.FirstChildElement(); child != nullptr;) {
    XMLElement* next = child->NextSiblingElement();
    if (isUnsimulated(element, *child, in_state)) {
      element.DeleteChild(child);
    } else {
      removeBelow(*child, in_state);
    }
    child = next;
  }
  // Without its axis a joint of any other type is an error.
  if (std::string_view(element.Name()) == "joint") element.SetAttribute("type", "fixed");
}

}  // namespace

void removeUnsimulated(XMLElement& element) {
  removeBelow(element, false);
}

}  // namespace vismem
