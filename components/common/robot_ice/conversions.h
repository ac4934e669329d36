/// @file Conversions between Slice and values for all interfaces. Pure. Conversions from the wire check
/// values only where stated. Implements C4.
#pragma once

#include <avm/common.h>

#include <Eigen/Core>
#include <initializer_list>
#include <memory>
#include <optional>
#include <string>

#include "common/geometry/camera.h"
#include "common/geometry/pose.h"
#include "common/robot/ports.h"

namespace vismem {

avm::Vector2 toIce(const Eigen::Vector2d& v);
avm::Vector3 toIce(const Eigen::Vector3d& v);
avm::Pose2 toIce(const Pose2& pose);
avm::Pose3 toIce(const Pose3& pose);
avm::Intrinsics toIce(const CameraIntrinsics& intrinsics);
avm::PanTiltAngles toIce(const PanTilt& angles);
avm::SourceState toIce(SourceState state);
/// The upper triangle of a symmetric matrix.
avm::Symmetric3 toIce(const Eigen::Matrix3d& m);

Eigen::Vector2d fromIce(const avm::Vector2& v);
Eigen::Vector3d fromIce(const avm::Vector3& v);
Pose2 fromIce(const avm::Pose2& pose);
/// @return empty unless all is finite and the quaternion's length is within 1 % of 1 (it is then normalised).
std::optional<Pose3> fromIce(const avm::Pose3& pose);
CameraIntrinsics fromIce(const avm::Intrinsics& intrinsics);
PanTilt fromIce(const avm::PanTiltAngles& angles);
SourceState fromIce(avm::SourceState state);
Eigen::Matrix3d fromIce(const avm::Symmetric3& m);

bool allFinite(std::initializer_list<double> values);
/// Throws avm::InvalidArgument "NAME = VALUE (must be finite)".
void requireFinite(const char* name, double value);
/// Throws avm::InvalidArgument "NAME = VALUE (must be LOW..HIGH)", for NaN too.
void requireInRange(const char* name, double value, double low, double high);
/// The answer to a command; throws avm::Refused for a rejection.
avm::CommandReply toIce(const PortReply& reply);

}  // namespace vismem
