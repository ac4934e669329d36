/// @file Problems of a drawing, and warnings of unsupported elements. Private to the reader of SVG.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

namespace tinyxml2 {
class XMLElement;
}

namespace vismem {

/// Name without the prefix svg:.
std::string svgNameOf(const tinyxml2::XMLElement& element);
/// Text of an attribute; empty without one.
std::string svgText(const tinyxml2::XMLElement& element, const char* attribute);

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
  /// Adds a warning. Equal warnings of many elements become one, at the line of the first.
  void leftOut(const tinyxml2::XMLElement& e, const std::string& what);

  const std::string& file() const { return file_; }
  bool isFull() const { return problems_.size() >= kMaxProblems; }
  const std::vector<std::string>& problems() const { return problems_; }
  std::vector<std::string> warnings() const;

 private:
  std::string file_;
  std::vector<std::string> problems_;
  std::map<std::string, std::pair<int, int>> left_out_;  ///< first line, number
};

}  // namespace vismem
