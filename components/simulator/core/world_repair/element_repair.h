/// @file Repair of single elements of a world file: values and names for which libsdformat rejects whole
/// worlds. Private to WorldDocument.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace tinyxml2 {
class XMLElement;
}

namespace vismem {

/// Equal repairs become one note, at their first line.
class RepairNotes {
 public:
  void add(const tinyxml2::XMLElement& e, const std::string& what);
  std::vector<std::string> take() const;

 private:
  std::map<std::string, std::pair<int, int>> seen_;
};

/// Repairs an element and all below it: colours outside 0..1 become the nearest colour, `nan` and `inf`
/// numbers out of any range; every element among its siblings of one kind gets a name of its own.
void repairElements(tinyxml2::XMLElement& e, RepairNotes& notes);

/// Makes elements of the values that SDF 1.0 has as attributes; libsdformat begins with 1.2.
void modernizeElements(tinyxml2::XMLElement& e);

/// The text of a pose that cannot be read; empty if the element has none or a readable one.
std::string unreadablePose(const tinyxml2::XMLElement& e);

std::vector<tinyxml2::XMLElement*> childrenOf(tinyxml2::XMLElement& e);

}  // namespace vismem
