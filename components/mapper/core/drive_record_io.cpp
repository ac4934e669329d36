#include "mapper/core/drive_record_io.h"

#include <vector>

#include "common/config/config_error.h"
#include "mapper/core/record_text.h"

namespace vismem {
namespace {

constexpr std::int64_t kMostKeyframes = 10'000'000;
constexpr std::int64_t kMostId = std::int64_t{1} << 53;

}  // namespace

std::string writeDriveRecord(const SavedDrive& drive) {
  LineWriter out;
  out.word("drive").integer(1).end();
  if (!drive.record.keyframes.empty())
    out.word("camera").camera(drive.record.keyframes.front().intrinsics).end();
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
    out.word("keyframe").integer(k.stamp_us).pose(k.T_odom_robot);
    out.number(k.turn_rate_radps).number(k.way_m).number(k.turned_rad).pose(k.T_robot_camera).end();
    for (const LineSighting& s : k.sightings) {
      out.word("sighting").integer(static_cast<std::int64_t>(s.element)).segment(s.px);
      out.integer(s.censored_a).integer(s.censored_b).end();
    }
  }
  for (const Closing& c : drive.closings) {
    out.word("closing").integer(c.from).integer(c.to).pose(c.T_from_to);
    for (int row = 0; row < 3; ++row) {
      for (int column = row; column < 3; ++column) out.number(c.P(row, column));
    }
    out.end();
  }
  return out.take();
}

namespace {

void readElement(LineFields& in, DriveRecord& record) {
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

void readKeyframe(LineFields& in, const CameraIntrinsics& camera, DriveRecord& record) {
  Keyframe k;
  k.intrinsics = camera;
  k.stamp_us = in.integer("stamp", -kMostId, kMostId);
  k.T_odom_robot = in.pose();
  k.turn_rate_radps = in.number("turn rate");
  k.way_m = in.number("way");
  k.turned_rad = in.number("turned");
  k.T_robot_camera = in.pose3("camera pose");
  record.keyframes.push_back(std::move(k));
}

Closing readClosing(LineFields& in) {
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
  readRecord(text, file_name, "drive", [&](const std::string& kind, LineFields& in) {
    if (kind == "camera") {
      camera = in.camera();
    } else if (kind == "element") {
      readElement(in, drive.record);
    } else if (kind == "keyframe") {
      readKeyframe(in, camera, drive.record);
    } else if (kind == "sighting") {
      if (drive.record.keyframes.empty()) in.fail("a sighting before the first keyframe");
      LineSighting s;
      s.element = static_cast<std::uint64_t>(in.integer("element", 1, kMostId));
      s.px = in.segment();
      s.censored_a = in.flag("censored a");
      s.censored_b = in.flag("censored b");
      drive.record.keyframes.back().sightings.push_back(s);
    } else if (kind == "closing") {
      drive.closings.push_back(readClosing(in));
    } else {
      in.fail("\"" + kind + "\" (must be camera, element, keyframe, sighting or closing)");
    }
  });
  checkReferences(drive, file_name);
  return drive;
}

}  // namespace vismem
