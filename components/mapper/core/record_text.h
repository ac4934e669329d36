/// @file Words of the mapper's text files: one value a line, fields between blanks, `#` begins a comment,
/// the first line names the format and its version. Pure.
#pragma once

#include <cstdint>
#include <functional>
#include <sstream>
#include <string>
#include <string_view>

#include "common/geometry/camera.h"
#include "common/geometry/pose.h"
#include "common/geometry/segment.h"

namespace vismem {

/// Writes lines. Numbers are read back exactly.
class LineWriter {
 public:
  LineWriter& word(std::string_view text);
  LineWriter& number(double value);
  LineWriter& integer(std::int64_t value) { return word(std::to_string(value)); }
  LineWriter& segment(const Segment2& s);
  LineWriter& pose(const Pose2& p) { return number(p.x).number(p.y).number(p.theta); }
  LineWriter& pose(const Pose3& p);               ///< 3 x 4 by rows
  LineWriter& camera(const CameraIntrinsics& k);  ///< without distortion: ideal pixels
  void end();
  void comment(std::string_view text);
  std::string take() { return std::move(text_); }

 private:
  std::string line_;
  std::string text_;
};

/// Reads the fields of one line. Each read throws a ConfigError with FILE:LINE, field, what was found and
/// what was expected.
class LineFields {
 public:
  LineFields(const std::string& line, std::string where) : in_(line), where_(std::move(where)) {}

  std::string word(const char* what);
  double number(const char* what);
  std::int64_t integer(const char* what, std::int64_t low, std::int64_t high);
  bool flag(const char* what) { return integer(what, 0, 1) != 0; }
  Segment2 segment();
  Pose2 pose();
  Pose3 pose3(const char* what);
  CameraIntrinsics camera();
  /// Whether another field follows.
  bool hasMore();
  /// The fields that are left must be none.
  void finish();
  [[noreturn]] void fail(const std::string& problem) const;

 private:
  std::istringstream in_;
  std::string where_;
};

/// Calls for each line but comments and the first, which must be "FORMAT 1".
/// @throws ConfigError of the first wrong line.
void readRecord(std::string_view text, const std::string& file_name, const std::string& format,
                const std::function<void(const std::string& kind, LineFields&)>& read);

}  // namespace vismem
