/// @file Writes small bags for tests: of a camera on a pan-tilt unit, with any part invalid or missing.
/// C++17, no ROS types (see bag_file.h).
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace vismem {

class BagWriter {
 public:
  /// @param compression "none", "bz2" or "lz4", as rosbag itself writes them.
  explicit BagWriter(const std::string& file, const std::string& compression = "none");
  ~BagWriter();

  void image(const std::string& topic, std::int64_t stamp_us, const std::string& encoding, int width,
             int height, const std::vector<std::uint8_t>& data,
             const std::string& frame_id = "camera_optical_frame");
  void compressedImage(const std::string& topic, std::int64_t stamp_us, const std::vector<std::uint8_t>& data,
                       const std::string& frame_id = "camera_optical_frame");
  /// @param d distortion parameters of `model`.
  void cameraInfo(const std::string& topic, std::int64_t stamp_us, int width, int height, double f,
                  const std::string& model = "plumb_bob", const std::vector<double>& d = {});
  void odometry(const std::string& topic, std::int64_t stamp_us, double x, double y, double theta,
                const std::string& frame_id = "");
  /// geometry_msgs/PoseStamped
  void pose(const std::string& topic, std::int64_t stamp_us, double x, double y, double theta);
  void joints(const std::string& topic, std::int64_t stamp_us, const std::vector<std::string>& names,
              const std::vector<double>& positions);
  /// Rotation about z by `yaw`.
  void transform(const std::string& topic, std::int64_t stamp_us, const std::string& parent,
                 const std::string& child, double x, double y, double z, double yaw);
  void close();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vismem
