#include "mapper/core/drive_record_io.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <sstream>
#include <vector>

#include "common/config/config_error.h"

namespace vismem {
namespace {

class Writer {
 public:
  Writer& word(std::string_view text) {
    if (!line_.empty()) line_ += ' ';
    line_ += text;
    return *this;
  }
  Writer& number(double value) {
    std::array<char, 32> buffer{};
    const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value);
    return word({buffer.data(), static_cast<std::size_t>(end.ptr - buffer.data())});
  }
  Writer& integer(std::int64_t value) { return word(std::to_string(value)); }
  Writer& segment(const Segment2& s) {
    return number(s.a.x()).number(s.a.y()).number(s.b.x()).number(s.b.y());
  }
  void end() {
    text_ += line_ + "\n";
    line_.clear();
  }
  std::string take() { return std::move(text_); }

 private:
  std::string line_;
  std::string text_;
};

/// The fields of one line.
class Fields {
 public:
  Fields(const std::string& line, std::string where) : in_(line), where_(std::move(where)) {}

  std::string word(const char* what) {
    std::string text;
    if (!(in_ >> text)) throw ConfigError({where_ + ": the line ends before " + what});
    return text;
  }
  double number(const char* what) {
    const std::string text = word(what);
    double value = 0.0;
    const auto end = std::from_chars(text.data(), text.data() + text.size(), value);
    if (end.ec != std::errc() || end.ptr != text.data() + text.size() || !std::isfinite(value)) {
      throw ConfigError({where_ + ": " + what + " = \"" + text + "\" (must be a finite number)"});
    }
    return value;
  }
  std::int64_t integer(const char* what, std::int64_t low, std::int64_t high) {
    const double value = number(what);
    if (value != std::floor(value) || value < static_cast<double>(low) || value > static_cast<double>(high)) {
      throw ConfigError({where_ + ": " + what + " (must be a whole number " + std::to_string(low) + ".." +
                         std::to_string(high) + ")"});
    }
    return static_cast<std::int64_t>(value);
  }
  bool flag(const char* what) { return integer(what, 0, 1) != 0; }
  Segment2 segment() {
    Segment2 s;
    for (Eigen::Vector2d* end : {&s.a, &s.b}) {
      end->x() = number("x");
      end->y() = number("y");
    }
    return s;
  }
  Pose2 pose() {
    Pose2 p;
    p.x = number("x");
    p.y = number("y");
    p.theta = number("theta");
    return p;
  }

 private:
  std::istringstream in_;
  std::string where_;
};

constexpr std::int64_t kMostKeyframes = 10'000'000;
constexpr std::int64_t kMostId = std::int64_t{1} << 53;

}  // namespace

std::string writeDriveRecord(const SavedDrive& drive) {
  Writer out;
  out.word("drive").integer(1).end();
  if (!drive.record.keyframes.empty()) {
    const CameraIntrinsics& k = drive.record.keyframes.front().intrinsics;
    out.word("camera")
        .integer(k.width)
        .integer(k.height)
        .number(k.fx)
        .number(k.fy)
        .number(k.cx)
        .number(k.cy)
        .end();
  }
  for (const auto& [id, e] : drive.record.elements) {
    out.word("element")
        .integer(static_cast<std::int64_t>(id))
        .word(e.label)
        .integer(e.confirmed)
        .integer(e.dropped);
    out.integer(e.first_keyframe).integer(e.last_keyframe).integer(e.sightings).segment(e.robot);
    out.integer(e.censored_a).integer(e.censored_b).end();
  }
  for (const Keyframe& k : drive.record.keyframes) {
    out.word("keyframe").integer(k.stamp_us).number(k.T_odom_robot.x).number(k.T_odom_robot.y);
    out.number(k.T_odom_robot.theta).number(k.turn_rate_radps).number(k.way_m).number(k.turned_rad);
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) out.number(k.T_robot_camera.matrix()(row, column));
    }
    out.end();
    for (const LineSighting& s : k.sightings) {
      out.word("sighting").integer(static_cast<std::int64_t>(s.element)).segment(s.px);
      out.integer(s.censored_a).integer(s.censored_b).end();
    }
  }
  for (const Closing& c : drive.closings) {
    out.word("closing").integer(c.from).integer(c.to).number(c.T_from_to.x).number(c.T_from_to.y);
    out.number(c.T_from_to.theta);
    for (int row = 0; row < 3; ++row) {
      for (int column = row; column < 3; ++column) out.number(c.P(row, column));
    }
    out.end();
  }
  return out.take();
}

namespace {

void readElement(Fields& in, DriveRecord& record) {
  const auto id = static_cast<std::uint64_t>(in.integer("id", 1, kMostId));
  ElementSummary& e = record.elements[id];
  e.label = in.word("label");
  e.confirmed = in.flag("confirmed");
  e.dropped = in.flag("dropped");
  e.first_keyframe = static_cast<int>(in.integer("first keyframe", 0, kMostKeyframes));
  e.last_keyframe = static_cast<int>(in.integer("last keyframe", 0, kMostKeyframes));
  e.sightings = static_cast<int>(in.integer("sightings", 0, kMostKeyframes));
  e.robot = in.segment();
  e.censored_a = in.flag("censored a");
  e.censored_b = in.flag("censored b");
}

void readKeyframe(Fields& in, const CameraIntrinsics& camera, DriveRecord& record) {
  Keyframe k;
  k.intrinsics = camera;
  k.stamp_us = in.integer("stamp", -kMostId, kMostId);
  k.T_odom_robot = in.pose();
  k.turn_rate_radps = in.number("turn rate");
  k.way_m = in.number("way");
  k.turned_rad = in.number("turned");
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column)
      k.T_robot_camera.matrix()(row, column) = in.number("camera pose");
  }
  record.keyframes.push_back(std::move(k));
}

Closing readClosing(Fields& in) {
  Closing c;
  c.from = static_cast<int>(in.integer("from", 0, kMostKeyframes));
  c.to = static_cast<int>(in.integer("to", 0, kMostKeyframes));
  c.T_from_to = in.pose();
  for (int row = 0; row < 3; ++row) {
    for (int column = row; column < 3; ++column)
      c.P(row, column) = c.P(column, row) = in.number("covariance");
  }
  return c;
}

/// @throws ConfigError for references to what is not there.
void checkReferences(const SavedDrive& drive, const std::string& file_name) {
  const auto keyframes = static_cast<int>(drive.record.keyframes.size());
  std::vector<std::string> problems;
  for (const auto& [id, e] : drive.record.elements) {
    if (e.first_keyframe >= keyframes || e.last_keyframe >= keyframes) {
      problems.push_back(file_name + ": element " + std::to_string(id) +
                         " names a keyframe beyond the last one");
    }
  }
  for (const Closing& c : drive.closings) {
    if (c.from >= keyframes || c.to >= keyframes || c.from == c.to) {
      problems.push_back(file_name + ": closing " + std::to_string(c.from) + " " + std::to_string(c.to) +
                         " (must be two keyframes of the drive)");
    }
  }
  if (!problems.empty()) throw ConfigError(problems);
}

}  // namespace

SavedDrive parseDriveRecord(std::string_view text, const std::string& file_name) {
  SavedDrive drive;
  CameraIntrinsics camera;
  std::istringstream lines{std::string(text)};
  std::string line;
  bool begun = false;
  for (int number = 1; std::getline(lines, line); ++number) {
    const std::string where = file_name + ":" + std::to_string(number);
    line.erase(std::min(line.find('#'), line.size()));
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    Fields in(line, where);
    const std::string kind = in.word("kind");
    if (!begun) {
      if (kind != "drive") throw ConfigError({where + ": \"" + kind + "\" (must be \"drive 1\")"});
      in.integer("version", 1, 1);
      begun = true;
    } else if (kind == "camera") {
      camera.width = static_cast<int>(in.integer("width", 1, 100'000));
      camera.height = static_cast<int>(in.integer("height", 1, 100'000));
      for (double* value : {&camera.fx, &camera.fy, &camera.cx, &camera.cy}) *value = in.number("camera");
    } else if (kind == "element") {
      readElement(in, drive.record);
    } else if (kind == "keyframe") {
      readKeyframe(in, camera, drive.record);
    } else if (kind == "sighting") {
      if (drive.record.keyframes.empty())
        throw ConfigError({where + ": a sighting before the first keyframe"});
      LineSighting s;
      s.element = static_cast<std::uint64_t>(in.integer("element", 1, kMostId));
      s.px = in.segment();
      s.censored_a = in.flag("censored a");
      s.censored_b = in.flag("censored b");
      drive.record.keyframes.back().sightings.push_back(s);
    } else if (kind == "closing") {
      drive.closings.push_back(readClosing(in));
    } else {
      throw ConfigError(
          {where + ": \"" + kind + "\" (must be camera, element, keyframe, sighting or closing)"});
    }
  }
  if (!begun) throw ConfigError({file_name + ": is empty (must begin with \"drive 1\")"});
  checkReferences(drive, file_name);
  return drive;
}

}  // namespace vismem
