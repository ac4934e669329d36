/// @file The images of a folder in natural order, or one image.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "drivers/camera_files/picture_source.h"

namespace vismem {

/// Whether the name has the ending of an image: .jpg .jpeg .png .bmp .pgm .ppm .pnm .tif .tiff .webp, in any
/// case.
bool isImageName(const std::filesystem::path& file);

/// A folder's images, hidden files and subfolders left out. If it holds `stamps.txt`, that file lists the
/// images in their order with their stamps: lines "SECONDS FILE" (as TUM's rgb.txt), '#' begins a comment,
/// stamps increase. A file instead of a folder is one image.
class ImageFolder : public PictureSource {
 public:
  explicit ImageFolder(std::filesystem::path path) : path_(std::move(path)) {}

  std::string name() const override;
  /// Lists the folder again, because images may have been added or removed.
  std::string open() override;
  PictureResult read() override;
  void close() override { entries_.clear(); }
  double ownRate_hz() const override;

 private:
  struct Entry {
    std::filesystem::path file;
    std::optional<StampUs> stamp_us;
  };
  std::string readStamps(const std::filesystem::path& file);

  const std::filesystem::path path_;
  std::vector<Entry> entries_;
  std::size_t next_ = 0;
  std::size_t read_ = 0;  ///< readable images of this pass
};

}  // namespace vismem
