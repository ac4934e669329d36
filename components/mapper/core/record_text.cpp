#include "mapper/core/record_text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "common/config/config_error.h"
#include "common/config/text_file.h"

namespace vismem {

LineWriter& LineWriter::word(std::string_view text) {
  if (!line_.empty()) line_ += ' ';
  line_ += text;
  return *this;
}

LineWriter& LineWriter::number(double value) {
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
  return word({buffer.data(), static_cast<std::size_t>(end.ptr - buffer.data())});
}

LineWriter& LineWriter::segment(const Segment2& s) {
  return number(s.a.x()).number(s.a.y()).number(s.b.x()).number(s.b.y());
}

LineWriter& LineWriter::pose(const Pose3& p) {
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) number(p.matrix()(row, column));
  }
  return *this;
}

LineWriter& LineWriter::camera(const CameraIntrinsics& k) {
  return integer(k.width).integer(k.height).number(k.fx).number(k.fy).number(k.cx).number(k.cy);
}

void LineWriter::end() {
  text_ += line_ + "\n";
  line_.clear();
}

void LineWriter::comment(std::string_view text) {
  text_ += "# " + std::string(text) + "\n";
}

std::string LineFields::word(const char* what) {
  std::string text;
  if (!(in_ >> text)) fail(std::string("the line ends before ") + what);
  return text;
}

double LineFields::number(const char* what) {
  const std::string text = word(what);
  double value = 0.0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end.ec != std::errc() || end.ptr != text.data() + text.size() || !std::isfinite(value))
    fail(std::string(what) + " = \"" + shown(text) + "\" (must be a finite number)");
  return value;
}

std::int64_t LineFields::integer(const char* what, std::int64_t low, std::int64_t high) {
  const std::string text = word(what);
  std::int64_t value = 0;
  const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end.ec != std::errc() || end.ptr != text.data() + text.size() || value < low || value > high) {
    fail(std::string(what) + " = " + shown(text) + " (must be a whole number " + std::to_string(low) + ".." +
         std::to_string(high) + ")");
  }
  return value;
}

Segment2 LineFields::segment() {
  Segment2 s;
  for (Eigen::Vector2d* end : {&s.a, &s.b}) {
    end->x() = number("x");
    end->y() = number("y");
  }
  return s;
}

Pose2 LineFields::pose() {
  Pose2 p;
  p.x = number("x");
  p.y = number("y");
  p.theta = number("theta");
  return p;
}

Pose3 LineFields::pose3(const char* what) {
  Pose3 p = Pose3::Identity();
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) p.matrix()(row, column) = number(what);
  }
  return p;
}

CameraIntrinsics LineFields::camera() {
  constexpr std::int64_t kMostPixels = 100'000;
  CameraIntrinsics k;
  k.width = static_cast<int>(integer("width", 1, kMostPixels));
  k.height = static_cast<int>(integer("height", 1, kMostPixels));
  for (double* value : {&k.fx, &k.fy, &k.cx, &k.cy}) *value = number("camera");
  return k;
}

bool LineFields::hasMore() {
  return !(in_ >> std::ws).eof();
}

void LineFields::finish() {
  std::string text;
  if (in_ >> text) fail("\"" + shown(text) + "\" is one word too many");
}

void LineFields::fail(const std::string& problem) const {
  throw ConfigError({where_ + ": " + problem});
}

void readRecord(std::string_view text, const std::string& file_name, const std::string& format,
                const std::function<void(const std::string& kind, LineFields&)>& read) {
  std::istringstream lines{std::string(text)};
  std::string line;
  bool has_begun = false;
  for (int number = 1; std::getline(lines, line); ++number) {
    line.erase(std::min(line.find('#'), line.size()));
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    LineFields in(line, file_name + ":" + std::to_string(number));
    const std::string kind = in.word("kind");
    if (has_begun) {
      read(kind, in);
      continue;
    }
    if (kind != format) in.fail("\"" + shown(kind) + "\" (must be \"" + format + " 1\")");
    in.integer("version", 1, 1);
    has_begun = true;
  }
  if (!has_begun) throw ConfigError({file_name + ": is empty (must begin with \"" + format + " 1\")"});
}

}  // namespace vismem
