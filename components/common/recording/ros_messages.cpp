#include "common/recording/ros_messages.h"

#include <algorithm>

#include "common/recording/ros_wire.h"

namespace vismem {
namespace {

void write(RosWriter& w, const RosHeader& header) {
  w.u32(0).stamp(header.stamp_us).text(header.frame_id);
}

void write(RosWriter& w, const RosPoint& p) {
  w.number(p.x).number(p.y).number(p.z);
}

void write(RosWriter& w, const RosPose& pose) {
  write(w, pose.position);
  const RosQuaternion& q = pose.orientation;
  w.number(q.x).number(q.y).number(q.z).number(q.w);
}

template <typename Array>
void writeNumbers(RosWriter& w, const Array& numbers) {
  for (const auto value : numbers) w.number(value);
}

RosHeader readHeader(RosReader& r) {
  r.number<std::uint32_t>();
  RosHeader header;
  header.stamp_us = toStampOfTime(r.timeNs());
  header.frame_id = r.text();
  return header;
}

RosPoint readPoint(RosReader& r) {
  RosPoint p;
  p.x = r.number<double>();
  p.y = r.number<double>();
  p.z = r.number<double>();
  return p;
}

RosPose readPose(RosReader& r) {
  RosPose pose;
  pose.position = readPoint(r);
  pose.orientation.x = r.number<double>();
  pose.orientation.y = r.number<double>();
  pose.orientation.z = r.number<double>();
  pose.orientation.w = r.number<double>();
  return pose;
}

template <typename Array>
void readNumbers(RosReader& r, Array& numbers) {
  for (auto& value : numbers) value = r.number<double>();
}

std::vector<double> readDoubles(RosReader& r) {
  std::vector<double> values(r.listLength(sizeof(double)));
  readNumbers(r, values);
  return values;
}

RosImage readImageHeader(RosReader& r) {
  RosImage image;
  image.header = readHeader(r);
  image.height = r.number<std::uint32_t>();
  image.width = r.number<std::uint32_t>();
  image.encoding = r.text();
  r.number<std::uint8_t>();  // big endian: of no meaning for bytes
  image.step = r.number<std::uint32_t>();
  return image;
}

RosCompressedImage readCompressedImageHeader(RosReader& r) {
  RosCompressedImage image;
  image.header = readHeader(r);
  image.format = r.text();
  return image;
}

void write(RosWriter& w, const RosMarker& m) {
  write(w, m.header);
  w.text(m.ns)
      .number(m.id)
      .number(static_cast<std::int32_t>(m.type))
      .number(static_cast<std::int32_t>(m.action));
  write(w, m.pose);
  write(w, m.scale);
  writeNumbers(w, m.rgba);
  w.number(std::int32_t{0}).number(std::int32_t{0});  // lifetime: until it is replaced
  w.number(std::uint8_t{0});                          // frame_locked
  w.u32(m.points.size());
  for (const RosPoint& p : m.points) write(w, p);
  w.u32(m.colors.size());
  for (const auto& color : m.colors) writeNumbers(w, color);
  w.text(m.text).text("").number(std::uint8_t{0});  // no mesh
}

}  // namespace

Bytes serialize(const RosImage& m) {
  RosWriter w;
  w.reserve(m.data.size() + 128);
  write(w, m.header);
  w.number(m.height).number(m.width).text(m.encoding).number(std::uint8_t{0}).number(m.step).byteList(m.data);
  return w.take();
}

Bytes serialize(const RosCompressedImage& m) {
  RosWriter w;
  w.reserve(m.data.size() + 128);
  write(w, m.header);
  w.text(m.format).byteList(m.data);
  return w.take();
}

Bytes serialize(const RosCameraInfo& m) {
  RosWriter w;
  write(w, m.header);
  w.number(m.height).number(m.width).text(m.distortion_model).u32(m.d.size());
  writeNumbers(w, m.d);
  writeNumbers(w, m.k);
  writeNumbers(w, m.r);
  writeNumbers(w, m.p);
  w.u32(0).u32(0);                                        // binning
  w.u32(0).u32(0).u32(0).u32(0).number(std::uint8_t{0});  // region of interest: all
  return w.take();
}

Bytes serialize(const RosJointState& m) {
  RosWriter w;
  write(w, m.header);
  w.u32(m.names.size());
  for (const std::string& name : m.names) w.text(name);
  w.u32(m.positions.size());
  writeNumbers(w, m.positions);
  w.u32(0).u32(0);  // velocities, efforts
  return w.take();
}

Bytes serialize(const RosOdometry& m) {
  RosWriter w;
  write(w, m.header);
  w.text(m.child_frame_id);
  write(w, m.pose);
  writeNumbers(w, m.pose_covariance);
  w.number(m.v_mps).number(0.0).number(0.0).number(0.0).number(0.0).number(m.w_radps);
  writeNumbers(w, RosCovariance{});
  return w.take();
}

Bytes serialize(const RosPoseWithCovariance& m) {
  RosWriter w;
  write(w, m.header);
  write(w, m.pose);
  writeNumbers(w, m.covariance);
  return w.take();
}

Bytes serialize(const std::vector<RosTransform>& message) {
  RosWriter w;
  w.u32(message.size());
  for (const RosTransform& item : message) {
    write(w, item.header);
    w.text(item.child_frame_id);
    write(w, item.pose);
  }
  return w.take();
}

Bytes serialize(const std::vector<RosMarker>& message) {
  RosWriter w;
  w.u32(message.size());
  for (const RosMarker& marker : message) write(w, marker);
  return w.take();
}

Bytes serialize(const std::string& message) {
  RosWriter w;
  w.text(message);
  return w.take();
}

RosImage parseImageHeader(ByteView begin) {
  RosReader r(begin);
  return readImageHeader(r);
}

RosImage parseImage(ByteView bytes) {
  RosReader r(bytes);
  RosImage image = readImageHeader(r);
  const ByteView data = r.byteList();
  image.data.assign(data.begin(), data.end());
  return image;
}

RosCompressedImage parseCompressedImageHeader(ByteView begin) {
  RosReader r(begin);
  return readCompressedImageHeader(r);
}

RosCompressedImage parseCompressedImage(ByteView bytes) {
  RosReader r(bytes);
  RosCompressedImage image = readCompressedImageHeader(r);
  const ByteView data = r.byteList();
  image.data.assign(data.begin(), data.end());
  return image;
}

RosCameraInfo parseCameraInfo(ByteView bytes) {
  RosReader r(bytes);
  RosCameraInfo info;
  info.header = readHeader(r);
  info.height = r.number<std::uint32_t>();
  info.width = r.number<std::uint32_t>();
  info.distortion_model = r.text();
  info.d = readDoubles(r);
  readNumbers(r, info.k);
  readNumbers(r, info.r);
  readNumbers(r, info.p);
  return info;
}

RosJointState parseJointState(ByteView bytes) {
  RosReader r(bytes);
  RosJointState joints;
  joints.header = readHeader(r);
  joints.names.resize(r.listLength(sizeof(std::uint32_t)));
  for (std::string& name : joints.names) name = r.text();
  joints.positions = readDoubles(r);
  return joints;
}

RosOdometry parseOdometry(ByteView bytes) {
  RosReader r(bytes);
  RosOdometry odometry;
  odometry.header = readHeader(r);
  odometry.child_frame_id = r.text();
  odometry.pose = readPose(r);
  readNumbers(r, odometry.pose_covariance);
  odometry.v_mps = readPoint(r).x;
  odometry.w_radps = readPoint(r).z;
  return odometry;
}

RosPoseWithCovariance parsePoseWithCovariance(ByteView bytes) {
  RosReader r(bytes);
  RosPoseWithCovariance pose;
  pose.header = readHeader(r);
  pose.pose = readPose(r);
  readNumbers(r, pose.covariance);
  return pose;
}

RosPoseWithCovariance parsePose(ByteView bytes) {
  RosReader r(bytes);
  RosPoseWithCovariance pose;
  pose.header = readHeader(r);
  pose.pose = readPose(r);
  return pose;
}

std::vector<RosTransform> parseTransforms(ByteView bytes) {
  RosReader r(bytes);
  // A header, an empty name and seven numbers.
  std::vector<RosTransform> transforms(r.listLength(16 + 4 + 56));
  for (RosTransform& item : transforms) {
    item.header = readHeader(r);
    item.child_frame_id = r.text();
    item.pose = readPose(r);
  }
  return transforms;
}

std::string parseString(ByteView bytes) {
  RosReader r(bytes);
  return r.text();
}

}  // namespace vismem
