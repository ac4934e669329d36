#include "evaluation/core/trajectory_io.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iomanip>
#include <ostream>

#include "common/config/config_error.h"
#include "evaluation/core/shape_score.h"

namespace vismem {
namespace {

/// Exact seconds of a stamp: a double of seconds since 1970 would lose the last microseconds in text.
void putSeconds(std::ostream& out, StampUs stamp_us) {
  const StampUs whole = stamp_us / kSecondUs;
  const StampUs rest = std::abs(stamp_us % kSecondUs);
  if (stamp_us < 0 && whole == 0) out << '-';
  out << whole << '.' << std::setw(6) << std::setfill('0') << rest << std::setfill(' ');
}

std::vector<std::string_view> wordsOf(std::string_view line) {
  std::vector<std::string_view> found;
  while (true) {
    const std::size_t begin = line.find_first_not_of(" \t\r");
    if (begin == std::string_view::npos) return found;
    const std::size_t end = std::min(line.find_first_of(" \t\r", begin), line.size());
    found.push_back(line.substr(begin, end - begin));
    line.remove_prefix(end);
  }
}

std::optional<double> number(std::string_view word) {
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc{} || end != word.data() + word.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace

void writeTumRow(const StampedPose& pose, std::ostream& out) {
  putSeconds(out, pose.stamp_us);
  out << std::fixed << std::setprecision(9) << ' ' << pose.pose.x << ' ' << pose.pose.y << " 0 0 0 "
      << std::sin(0.5 * pose.pose.theta) << ' ' << std::cos(0.5 * pose.pose.theta) << '\n';
}

Trajectory parseTum(std::string_view text, const std::string& file_name) {
  Trajectory trajectory;
  std::vector<std::string> problems;
  int line_number = 0;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    ++line_number;
    const std::string where = file_name + ":" + std::to_string(line_number) + ": ";
    const auto parts = wordsOf(line);
    if (parts.empty() || parts[0].front() == '#') continue;
    if (parts.size() != 8) {
      problems.push_back(where + std::to_string(parts.size()) + " values (must be 8: t x y z qx qy qz qw)");
      continue;
    }
    double v[8] = {};
    bool good = true;
    for (int i = 0; i < 8; ++i) {
      if (const auto value = number(parts[i])) {
        v[i] = *value;
      } else {
        problems.push_back(where + "\"" + std::string(parts[i]) + "\" (must be a finite number)");
        good = false;
      }
    }
    if (!good) continue;
    const Eigen::Quaterniond q(v[7], v[4], v[5], v[6]);
    if (std::abs(q.norm() - 1.0) > 0.01) {
      problems.push_back(where + "quaternion of length " + std::to_string(q.norm()) + " (must be 1)");
      continue;
    }
    Pose3 pose = Pose3::Identity();
    pose.linear() = q.normalized().toRotationMatrix();
    pose.translation() << v[1], v[2], v[3];
    const StampedPose stamped{toStampUs(v[0]), toPose2(pose)};
    if (!append(trajectory, stamped)) {
      problems.push_back(where + "time " + std::string(parts[0]) +
                         " (must be later than on the line before)");
    }
  }
  if (!problems.empty()) throw ConfigError(std::move(problems));
  return trajectory;
}

void writeMemoryRows(const MemorySnapshot& memory, std::ostream& out) {
  for (const MemorySegment& s : memory.segments) {
    const double variance =
        0.5 * std::max(s.P_a.topLeftCorner<2, 2>().trace(), s.P_b.topLeftCorner<2, 2>().trace());
    putSeconds(out, memory.stamp_us);
    out << std::fixed << std::setprecision(4);
    out << ',' << s.id;
    for (const Eigen::Vector3d& end : {s.odom.a, s.odom.b}) {
      out << ',' << end.x() << ',' << end.y() << ',' << end.z();
    }
    out << ',' << s.label << ',' << s.life << ',' << std::sqrt(variance) << ',';
    putSeconds(out, s.last_seen_us);
    out << ',' << (s.confirmed ? 1 : 0) << std::setprecision(8);
    for (const Eigen::Matrix3d* P : {&s.P_a, &s.P_b}) {
      out << ',' << (*P)(0, 0) << ',' << (*P)(0, 1) << ',' << (*P)(1, 1);
    }
    out << '\n';
  }
}

void writePrimitivesRows(const MemorySnapshot& memory, std::ostream& out) {
  for (const Primitive& p : memory.primitives) {
    putSeconds(out, memory.stamp_us);
    out << std::fixed << std::setprecision(4) << ',' << p.id << ',' << nameOf(p.kind) << ',' << p.centre.x()
        << ',' << p.centre.y() << ',' << p.heading_rad << ',' << p.length_m << ',' << p.width_m << ','
        << p.radius_m << ',' << p.hidden_vertex << ',' << p.quality << ',' << p.life << ',';
    const char* separator = "";
    for (const Eigen::Vector2d& v : p.vertices) {
      out << separator << v.x() << ' ' << v.y();
      separator = "; ";
    }
    out << '\n';
  }
}

void writeRacesRows(const PoseEstimate& estimate, std::ostream& out) {
  for (const RaceReport& race : estimate.races) {
    putSeconds(out, estimate.stamp_us);
    out << std::fixed << std::setprecision(6) << ',' << race.id << ',' << race.T_world_robot.x << ','
        << race.T_world_robot.y << ',' << race.T_world_robot.theta << ',' << race.health << ',' << race.weight
        << ',' << race.victories << ',' << race.age << ',';
    if (race.winner) {
      const Eigen::Matrix3d& P = estimate.P;
      out << estimate.reliability << std::scientific;
      for (const double term : {P(0, 0), P(0, 1), P(1, 1), P(0, 2), P(1, 2), P(2, 2)}) out << ',' << term;
    } else {
      out << ",,,,,,";
    }
    out << '\n';
  }
}

void writeTextFile(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.flush();
  if (!out) throw std::runtime_error("cannot write " + file.string() + ": " + std::strerror(errno));
}

}  // namespace vismem
