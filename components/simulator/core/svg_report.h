/// @file What is wrong with a drawing, and what of it is left out. Private to the reader of SVG.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace tinyxml2 {
class XMLElement;
}

namespace vismem {

/// Without the prefix svg:.
std::string svgNameOf(const tinyxml2::XMLElement& element);
/// Of an attribute; empty where there is none.
std::string svgText(const tinyxml2::XMLElement& element, const char* attribute);
/// What `href` or `xlink:href` names in the same file; empty for anything else.
std::string svgLinkOf(const tinyxml2::XMLElement& element);

/// *Single-threaded.*
class SvgReport {
 public:
  static constexpr std::size_t kMaxProblems = 100;

  explicit SvgReport(std::string file) : file_(std::move(file)) {}

  /// FILE:LINE: <element id="x">
  std::string where(const tinyxml2::XMLElement& e) const;
  void problem(const tinyxml2::XMLElement& e, const std::string& what);
  void wrong(const tinyxml2::XMLElement& e, const std::string& name, const std::string& value,
             const std::string& rule);
  /// The same of many elements is one warning, at the first one's line.
  void leftOut(const tinyxml2::XMLElement& e, const std::string& what);

  const std::string& file() const { return file_; }
  bool isFull() const { return problems_.size() >= kMaxProblems; }
  const std::vector<std::string>& problems() const { return problems_; }
  std::vector<std::string> warnings() const;

 private:
  std::string file_;
  std::vector<std::string> problems_;
  std::map<std::string, std::pair<int, int>> left_out_;  ///< first line, how often
};

}  // namespace vismem
