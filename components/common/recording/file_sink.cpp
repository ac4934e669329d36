#include "common/recording/file_sink.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

namespace vismem {

FileSink::FileSink(std::string file, bool durable)
    : file_(std::move(file)),
      durable_(durable),
      fd_(::open(file_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0644)) {
  if (fd_ < 0) fail("cannot be made");
}

FileSink::~FileSink() {
  if (fd_ >= 0) ::close(fd_);
}

void FileSink::fail(const char* what) const {
  throw RecordingError(file_ + ": " + what + ": " + std::strerror(errno));
}

void FileSink::writeAll(ByteView bytes, std::uint64_t offset) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ::ssize_t n =
        ::pwrite(fd_, bytes.data() + done, bytes.size() - done, static_cast<::off_t>(offset + done));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) fail("cannot be written");
    done += static_cast<std::size_t>(n);
  }
}

void FileSink::write(ByteView bytes) {
  writeAll(bytes, size_);
  size_ += bytes.size();
}

void FileSink::overwrite(std::uint64_t offset, ByteView bytes) {
  writeAll(bytes, offset);
}

void FileSink::truncate(std::uint64_t size) {
  if (::ftruncate(fd_, static_cast<::off_t>(size)) != 0) fail("cannot be cut back");
  size_ = size;
}

void FileSink::sync() {
  if (durable_ && ::fdatasync(fd_) != 0 && errno != EINVAL && errno != EROFS) fail("cannot be synced");
}

}  // namespace vismem
