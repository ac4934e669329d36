/// @file Trajectories in TUM format, read back.
#pragma once

#include <Eigen/Geometry>
#include <sstream>
#include <stdexcept>
#include <string>

#include "common/geometry/pose.h"
#include "evaluation/core/trajectory.h"

namespace vismem {

/// @throws std::runtime_error naming a line that is no pose or is not later than the one before.
inline Trajectory readTum(const std::string& text) {
  Trajectory trajectory;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    if (line.empty() || line.front() == '#') continue;
    std::istringstream in(line);
    double t = 0.0;
    Eigen::Vector3d p;
    Eigen::Quaterniond q;
    in >> t >> p.x() >> p.y() >> p.z() >> q.x() >> q.y() >> q.z() >> q.w();
    Pose3 pose = Pose3::Identity();
    pose.linear() = q.toRotationMatrix();
    pose.translation() = p;
    if (!in || !append(trajectory, {toStampUs(t), toPose2(pose)}))
      throw std::runtime_error("not TUM: " + line);
  }
  return trajectory;
}

}  // namespace vismem
