#include "common/recording/file_bytes.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

namespace vismem {
namespace {

/// Headers of a bag's records are some 100 bytes; a connection's definition stands in its data.
constexpr std::size_t kMaxHeader = 1u << 16;

}  // namespace

FileBytes::FileBytes(const std::string& name) : fd_(::open(name.c_str(), O_RDONLY | O_CLOEXEC)) {
  struct stat info {};
  if (fd_ < 0 || ::fstat(fd_, &info) != 0 || !S_ISREG(info.st_mode)) {
    const std::string why = fd_ < 0 ? std::string(" (") + std::strerror(errno) + ")" : " (no regular file)";
    if (fd_ >= 0) ::close(fd_);
    fd_ = -1;
    throw RecordingError(name + ": cannot be opened" + why + " (expected a ROS 1 bag, version 2.0)");
  }
  size_ = static_cast<std::uint64_t>(info.st_size);
}

FileBytes::~FileBytes() {
  if (fd_ >= 0) ::close(fd_);
}

Bytes FileBytes::read(std::uint64_t offset, std::size_t count) const {
  if (offset >= size_) return {};
  Bytes bytes(static_cast<std::size_t>(std::min<std::uint64_t>(count, size_ - offset)));
  std::size_t got = 0;
  while (got < bytes.size()) {
    const ::ssize_t n =
        ::pread(fd_, bytes.data() + got, bytes.size() - got, static_cast<::off_t>(offset + got));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) break;
    got += static_cast<std::size_t>(n);
  }
  bytes.resize(got);
  return bytes;
}

std::optional<FileRecord> headerAt(const FileBytes& file, std::uint64_t offset) {
  // Most headers fit into the first piece.
  Bytes begin = file.read(offset, 256);
  if (begin.size() < 8) return std::nullopt;
  const std::size_t header_size = readU32(begin.data());
  if (header_size == 0 || header_size > kMaxHeader) return std::nullopt;
  if (begin.size() < header_size + 8) begin = file.read(offset, header_size + 8);
  if (begin.size() < header_size + 8) return std::nullopt;
  FileRecord record;
  record.data_size = readU32(begin.data() + 4 + header_size);
  record.data_pos = offset + 8 + header_size;
  record.header.assign(begin.begin() + 4, begin.begin() + 4 + static_cast<std::ptrdiff_t>(header_size));
  auto fields = RecordFields::parse(record.header);
  if (!fields || !fields->op()) return std::nullopt;
  record.fields = std::move(*fields);
  return record;
}

}  // namespace vismem
