#include "calibration/app/lens_images.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "common/config/config_error.h"
#include "common/recording/bag_file.h"
#include "common/recording/picture_decoder.h"
#include "common/vision/app/image_file.h"
#include "drivers/camera_files/natural_order.h"

namespace vismem {
namespace {

class FolderImages : public ImageStream {
 public:
  explicit FolderImages(const std::filesystem::path& folder) {
    static const std::array<std::string, 9> kEndings{".png", ".jpg", ".jpeg", ".bmp", ".pgm",
                                                     ".ppm", ".tif", ".tiff", ".webp"};
    std::error_code failure;
    for (const auto& entry : std::filesystem::directory_iterator(folder, failure)) {
      std::string ending = entry.path().extension();
      std::transform(ending.begin(), ending.end(), ending.begin(),
                     [](unsigned char c) { return std::tolower(c); });
      if (std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end())
        files_.push_back(entry.path());
    }
    if (files_.empty()) {
      throw ConfigError({folder.string() + ": " + (failure ? failure.message() : "has no images") +
                         " (must be a folder with images: png, jpg, ...)"});
    }
    std::sort(files_.begin(), files_.end(), [](const auto& a, const auto& b) {
      return naturallyBefore(a.filename().string(), b.filename().string());
    });
  }

  std::optional<StampedImage> next() override {
    if (next_ == files_.size()) return std::nullopt;
    const auto& file = files_[next_++];
    StampedImage image{static_cast<std::int64_t>(next_), file.filename().string(), {}};
    try {
      image.image = readImageFile(file);
    } catch (const std::runtime_error&) {
      // The image stays empty: whoever reads the folder counts it and goes on.
    }
    return image;
  }
  bool isContinuous() const override { return false; }
  std::size_t count() const override { return files_.size(); }

 private:
  std::vector<std::filesystem::path> files_;
  std::size_t next_ = 0;
};

class BagImages : public ImageStream {
 public:
  BagImages(const std::string& path, const std::string& topic) : bag_(bagsOf(path)), topic_(topic) {
    std::vector<std::string> found;
    for (const BagTopic& one : bag_.topics()) {
      if (one.type == "sensor_msgs/Image" || one.type == "sensor_msgs/CompressedImage")
        found.push_back(one.name);
    }
    if (topic_.empty() && found.size() == 1) topic_ = found.front();
    if (std::find(found.begin(), found.end(), topic_) == found.end()) {
      std::string list;
      for (const std::string& name : found) list += " " + name;
      throw ConfigError({path + ": " +
                         (topic_.empty() ? "no topic is chosen" : "no images in topic " + topic_) +
                         " (--topic must be one of:" + (list.empty() ? " none" : list) + ")"});
    }
    headers_ = bag_.imageHeaders(topic_);
  }

  std::optional<StampedImage> next() override {
    if (next_ == headers_.size()) return std::nullopt;
    StampedImage image;
    image.stamp_us = headers_[next_].stamp_us;
    image.name = topic_ + " " + std::to_string(next_);
    try {
      image.image = decodePicture(bag_.readImage(topic_, next_));
    } catch (const RecordingError& error) {
      image.name += std::string(" ") + error.what();
    }
    ++next_;
    return image;
  }
  bool isContinuous() const override { return true; }
  std::size_t count() const override { return headers_.size(); }

 private:
  BagFile bag_;
  std::string topic_;
  std::vector<BagImageHeader> headers_;
  std::size_t next_ = 0;
};

}  // namespace

std::unique_ptr<ImageStream> imagesOfFolder(const std::filesystem::path& folder) {
  return std::make_unique<FolderImages>(folder);
}

std::unique_ptr<ImageStream> imagesOfBag(const std::string& path, const std::string& topic) {
  return std::make_unique<BagImages>(path, topic);
}

}  // namespace vismem
