/// @file The elements of an SDF file that no simulation of looks and outlines needs. Private to
/// WorldDocument.
#pragma once

namespace tinyxml2 {
class XMLElement;
}

namespace vismem {

/// Removes what is not simulated from an element of SDF and all below it: physics, friction, inertia,
/// plugins, sensors other than cameras, the motion of joints (all become fixed), velocities in a saved state.
/// libsdformat rejects whole worlds for a wrong value in any of them.
void removeUnsimulated(tinyxml2::XMLElement& element);

}  // namespace vismem
