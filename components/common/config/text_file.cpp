#include "common/config/text_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <span>

#include "common/config/config_error.h"
#include "common/config/text_fields.h"

namespace vismem {
namespace {

/// A file descriptor that closes itself.
class Descriptor {
 public:
  explicit Descriptor(const std::filesystem::path& file) : fd_(::open(file.c_str(), O_RDONLY | O_CLOEXEC)) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }

 private:
  int fd_;
};

/// Length of the UTF-8 character at the beginning; 0 if there is none (RFC 3629, without surrogates and
/// overlong forms).
std::size_t characterLength(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned char first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return 0;
  }
  const unsigned char second = byte(1);
  if ((first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f)) return 0;
  if ((first == 0xf0 && second < 0x90) || (first == 0xf4 && second > 0x8f)) return 0;
  return length;
}

struct Beginning {
  std::string_view text;
  std::string_view kind;
};
/// Of the whole file, and of the first line of a text that is neither empty nor a comment.
constexpr Beginning kFileBeginnings[] = {{"\x89PNG", "a PNG image"},     {"\xff\xd8\xff", "a JPEG image"},
                                         {"%PDF-", "a PDF document"},    {"PK\3\4", "a ZIP archive"},
                                         {"\x1f\x8b", "a gzip archive"}, {"#ROSBAG V", "a ROS bag"}};
constexpr Beginning kLineBeginnings[] = {{"<", "XML, such as a world or a drawing"},
                                         {"{", "JSON"},
                                         {"x1_m,", kMapKind},
                                         {"class.", kPaletteKind},
                                         {"pair.", kPaletteKind},
                                         {"stripe.", kPaletteKind}};

std::string_view kindAmong(std::span<const Beginning> beginnings, std::string_view text) {
  const auto found = std::find_if(beginnings.begin(), beginnings.end(),
                                  [&](const Beginning& one) { return text.starts_with(one.text); });
  return found == beginnings.end() ? std::string_view() : found->kind;
}

/// "Component.Key = VALUE".
bool isSetting(std::string_view line) {
  const auto equals = line.find('=');
  const std::string_view key = line.substr(0, equals);
  return equals != std::string_view::npos && !key.empty() && key.front() >= 'A' && key.front() <= 'Z' &&
         key.find('.') != std::string_view::npos;
}

std::string escaped(std::string_view text) {
  static constexpr std::string_view kDigits = "0123456789abcdef";
  std::string result;
  while (!text.empty()) {
    const auto first = static_cast<unsigned char>(text.front());
    const std::size_t length = characterLength(text);
    const bool is_control =
        first < 0x20 || first == 0x7f || (first == 0xc2 && length == 2 && text[1] < '\xa0');
    if (length > 0 && !is_control) {
      result += text.substr(0, length);
      text.remove_prefix(length);
    } else {
      result += {'\\', 'x', kDigits[first >> 4], kDigits[first & 15]};
      text.remove_prefix(1);
    }
  }
  return result;
}

bool isInsideCharacter(char byte) {
  return (static_cast<unsigned char>(byte) & 0xc0) == 0x80;
}

}  // namespace

std::string readTextFile(const std::filesystem::path& file, std::string_view expected) {
  const auto failure = [&](const std::string& reason) {
    return ConfigError(
        {file.string() + ": cannot be read (" + reason + "; must be " + std::string(expected) + ")"});
  };
  const Descriptor descriptor(file);
  if (descriptor.get() < 0) throw failure(std::strerror(errno));
  struct stat info {};
  if (::fstat(descriptor.get(), &info) == 0 && S_ISDIR(info.st_mode)) throw failure("is a folder");
  std::string text;
  std::array<char, 1 << 16> buffer;
  for (;;) {
    const ssize_t count = ::read(descriptor.get(), buffer.data(), buffer.size());
    if (count == 0) return text;
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) throw failure(std::strerror(errno));
    text.append(buffer.data(), static_cast<std::size_t>(count));
    if (text.size() > kMaxTextFile) throw failure("more than 64 MB");
  }
}

std::string_view kindOf(std::string_view content) {
  if (const auto kind = kindAmong(kFileBeginnings, content); !kind.empty()) return kind;
  for (std::string_view rest = content; !rest.empty();) {
    const auto end = std::min(rest.find('\n'), rest.size());
    const std::string_view line = contentOf(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
    if (line.empty()) continue;
    if (isSetting(line)) return kConfigurationKind;
    if (const auto kind = kindAmong(kLineBeginnings, line); !kind.empty()) return kind;
    break;
  }
  return content.find('\0') == std::string_view::npos ? "" : "a binary file";
}

std::string shown(std::string_view text, std::size_t most) {
  if (text.size() <= most) return escaped(text);
  // The end of a message has the expected values.
  std::size_t head = most * 2 / 3;
  std::size_t tail = text.size() - (most - head);
  while (head > 0 && isInsideCharacter(text[head])) --head;
  while (tail < text.size() && isInsideCharacter(text[tail])) ++tail;
  return escaped(text.substr(0, head)) + "[... " + std::to_string(tail - head) + " bytes ...]" +
         escaped(text.substr(tail));
}

}  // namespace vismem
