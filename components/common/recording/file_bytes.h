/// @file A bag's file by positions: bytes, and records whose data are not read yet.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "common/recording/bag_format.h"

namespace vismem {

/// *Thread-safe.*
class FileBytes {
 public:
  /// @throws RecordingError for a file that cannot be opened or is no regular one.
  explicit FileBytes(const std::string& name);
  ~FileBytes();
  FileBytes(const FileBytes&) = delete;
  FileBytes& operator=(const FileBytes&) = delete;

  std::uint64_t size() const { return size_; }
  /// As many as there are, at most `count`.
  Bytes read(std::uint64_t offset, std::size_t count) const;

 private:
  int fd_ = -1;
  std::uint64_t size_ = 0;
};

/// A record of the file whose data were not read yet.
struct FileRecord {
  Bytes header;  ///< what the fields view
  RecordFields fields;
  std::uint64_t data_pos = 0;
  std::uint32_t data_size = 0;

  std::uint64_t end() const { return data_pos + data_size; }
};

/// @return empty when no header is there; the data may reach past the end of the file.
std::optional<FileRecord> headerAt(const FileBytes& file, std::uint64_t offset);

}  // namespace vismem
