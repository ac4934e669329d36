/// @file The text of an SDF file before it is parsed: repairs of what real files get wrong. Pure.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace vismem {

struct WorldText {
  std::string xml;                 ///< UTF-8
  std::vector<std::string> notes;  ///< what was repaired, one line each
};

/// Makes well-formed what Gazebo's old parser took: attributes without quotes (`<gui fullscreen=1>`), text in
/// Latin-1. @return without xml, and one note that says why, if it is no text at all.
WorldText repairWorldText(const std::string& bytes);

/// Puts our own ground plane and sun in place of the includes of Gazebo's: they ship with Gazebo, not with
/// the worlds. The include's name and pose stay.
std::string withBuiltInModels(const std::string& xml);

/// What the `<include>` elements of a text name, in their order.
std::vector<std::string> includedUris(const std::string& xml);

/// A text between tags with XML's five entities in place of their characters.
std::string escapeXml(std::string_view text);

}  // namespace vismem
