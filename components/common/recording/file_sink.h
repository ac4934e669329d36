/// @file A recording's file.
#pragma once

#include <string>

#include "common/recording/bag_encoder.h"

namespace vismem {

/// *Single-threaded.*
class FileSink : public ByteSink {
 public:
  /// Makes the file. @param durable whether sync() waits for the disk. @throws RecordingError when it is
  /// there already or cannot be made.
  FileSink(std::string file, bool durable);
  ~FileSink() override;
  FileSink(const FileSink&) = delete;
  FileSink& operator=(const FileSink&) = delete;

  void write(ByteView bytes) override;
  void overwrite(std::uint64_t offset, ByteView bytes) override;
  void truncate(std::uint64_t size) override;
  void sync() override;

 private:
  [[noreturn]] void fail(const char* what) const;
  void writeAll(ByteView bytes, std::uint64_t offset);

  const std::string file_;
  const bool durable_;
  int fd_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace vismem
