#include "common/process/service_manager.h"

#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <utility>

#include "common/config/text_file.h"

namespace vismem {
namespace {

/// A datagram carries one assignment a line, so that a state with line breaks could assign anything.
std::string oneLine(std::string_view text) {
  std::string line(text);
  std::replace_if(
      line.begin(), line.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
  return line;
}

/// @return the whole of the text as a number.
std::optional<unsigned long long> wholeNumber(std::string_view text) {
  unsigned long long number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace

ServiceManager::ServiceManager(std::string socket) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (socket.size() < 2 || socket.size() >= sizeof address.sun_path) return;
  if (socket[0] != '/' && socket[0] != '@') return;
  std::memcpy(address.sun_path, socket.data(), socket.size());
  if (socket[0] == '@') address.sun_path[0] = '\0';
  const auto size = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + socket.size());
  const int descriptor = ::socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (descriptor < 0) return;
  if (connect(descriptor, reinterpret_cast<const sockaddr*>(&address), size) != 0) {
    close(descriptor);
    return;
  }
  descriptor_ = descriptor;
}

ServiceManager::~ServiceManager() {
  if (descriptor_ >= 0) close(descriptor_);
}

std::string ServiceManager::socketOfEnvironment() {
  const char* socket = std::getenv("NOTIFY_SOCKET");
  return socket == nullptr ? "" : socket;
}

bool ServiceManager::send(const std::string& text) {
  return ::send(descriptor_, text.data(), text.size(), MSG_NOSIGNAL) >= 0;
}

void ServiceManager::ready(std::string_view state) {
  if (!listens()) return;
  serves_ = true;
  pending_ = "READY=1\n";
  report(state, true);
}

void ServiceManager::report(std::string_view state, bool progress) {
  if (!listens() || !serves_) return;
  std::string line = oneLine(state);
  if (line != state_) {
    state_ = std::move(line);
    // The newest state replaces one that is still pending.
    pending_ = (pending_.starts_with("READY=1\n") ? "READY=1\n" : "") + ("STATUS=" + state_ + "\n");
  }
  const std::string text = pending_ + (progress ? "WATCHDOG=1\n" : "");
  if (!text.empty() && send(text)) pending_.clear();
}

void ServiceManager::stopping() {
  if (listens()) send("STOPPING=1\n");
}

bool leadsToJournal(int descriptor, std::string_view journal_stream) {
  const auto colon = journal_stream.find(':');
  if (colon == std::string_view::npos) return false;
  const auto device = wholeNumber(journal_stream.substr(0, colon));
  const auto inode = wholeNumber(journal_stream.substr(colon + 1));
  struct stat found {};
  if (!device || !inode || fstat(descriptor, &found) != 0) return false;
  return found.st_dev == *device && found.st_ino == *inode;
}

void addCredentials(Properties& properties, const std::filesystem::path& folder) {
  if (folder.empty()) return;
  for (const std::string key : {"Robot.Token", "Robot.ViewToken"}) {
    const auto file = folder / key;
    std::error_code failed;
    if (properties.find(key) != nullptr || !std::filesystem::exists(file, failed)) continue;
    std::string value = readTextFile(file, "a token");
    value.erase(value.find_last_not_of(" \t\r\n") + 1);
    if (!value.empty()) properties.set(key, value);
  }
}

}  // namespace vismem
