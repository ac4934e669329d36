/// @file Images to calibrate with and to learn colours from: from a folder, a recording, or a running camera.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

namespace vismem {

struct StampedImage {
  std::int64_t stamp_us = 0;
  std::string name;  ///< for messages: a file, or a time
  cv::Mat image;     ///< R, G, B or grey; empty: it cannot be read
};

/// *Single-threaded.*
class ImageStream {
 public:
  virtual ~ImageStream() = default;
  /// The next image; waits for it. @return empty at the end, and after Ctrl-C at a running camera.
  virtual std::optional<StampedImage> next() = 0;
  /// Whether neighbouring images show motion: true for cameras and recordings.
  virtual bool isContinuous() const = 0;
  /// Number of images; 0: nobody knows.
  virtual std::size_t count() const = 0;
};

/// Images of a folder in natural order. @throw ConfigError for a folder without images.
std::unique_ptr<ImageStream> imagesOfFolder(const std::filesystem::path& folder);

/// Images of a ROS 1 bag, or of a folder of bags. @param topic empty: the only one with images.
/// @throw std::runtime_error naming file, topic and what was found.
std::unique_ptr<ImageStream> imagesOfBag(const std::string& path, const std::string& topic);

/// Images of an avm::Camera, such as "cameraA:tcp -h 127.0.0.1 -p 9999", the newest each time.
/// @param seconds after which it ends; 0: at Ctrl-C only.
/// @throw ConfigError for a text that is no proxy.
std::unique_ptr<ImageStream> imagesOfCamera(const std::string& proxy, double seconds);

}  // namespace vismem
