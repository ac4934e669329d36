/// @file Repair of frequent errors in the text of an SDF file before it is parsed. Pure.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace vismem {

struct WorldText {
  std::string xml;                 ///< UTF-8
  std::vector<std::string> notes;  ///< the repairs, one line each
};

/// Makes well-formed XML of texts that Gazebo's old parser accepted: attributes without quotes (`<gui
/// fullscreen=1>`), text in Latin-1.
/// @return no xml and one note with the reason for bytes that are no text.
WorldText repairWorldText(const std::string& bytes);

/// Replaces the includes of Gazebo's ground plane and sun by built-in ones, because they ship with Gazebo,
/// not with the worlds. The include's name and pose stay.
std::string withBuiltInModels(const std::string& xml);

/// Whether a uri means one of these two.
bool isBuiltInModel(const std::string& uri);

/// The uris of the `<include>` elements of a text, in their order.
std::vector<std::string> includedUris(const std::string& xml);

/// A text between tags with XML's five entities in place of their characters.
std::string escapeXml(std::string_view text);

}  // namespace vismem
