#include "evaluation/core/trajectory_io.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <iomanip>
#include <ostream>

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

}  // namespace

void writeTumRow(const StampedPose& pose, std::ostream& out) {
  putSeconds(out, pose.stamp_us);
  out << std::fixed << std::setprecision(9) << ' ' << pose.pose.x << ' ' << pose.pose.y << " 0 0 0 "
      << std::sin(0.5 * pose.pose.theta) << ' ' << std::cos(0.5 * pose.pose.theta) << '\n';
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
