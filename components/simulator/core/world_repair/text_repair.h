/// @file Repair of frequent errors in the text of an SDF file before it is parsed. Pure.
#pragma once

#include <string>
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

/// End of a comment, a CDATA section or a declaration in XML.
/// @return `at` if an element begins here.
std::size_t skipNonElement(const std::string& xml, std::size_t at);

}  // namespace vismem
