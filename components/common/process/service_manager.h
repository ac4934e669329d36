/// @file The process under systemd: readiness, state, watchdog, journal, credentials. No Ice, no libsystemd.
/// docs/deployment.md has the units that use it.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "common/config/properties.h"

namespace vismem {

/// Sends the service manager the datagrams of sd_notify(3). Without a manager every call does nothing. A
/// datagram that the manager does not take is sent again with the next report. *Single-threaded* (owner:
/// main).
class ServiceManager {
 public:
  /// @param socket value of NOTIFY_SOCKET: an absolute path, or '@' and an abstract name; empty: no manager.
  explicit ServiceManager(std::string socket);
  ~ServiceManager();
  ServiceManager(const ServiceManager&) = delete;
  ServiceManager& operator=(const ServiceManager&) = delete;

  /// The manager of this process's environment.
  static std::string socketOfEnvironment();

  /// @return whether a manager listens.
  bool listens() const { return descriptor_ >= 0; }

  /// The process serves: `systemctl start` returns.
  /// @param state one line for `systemctl status`; control characters become blanks.
  void ready(std::string_view state);
  /// Feeds the watchdog if `progress`; sends the state if it has changed. Call it more often than half of the
  /// unit's WatchdogSec.
  void report(std::string_view state, bool progress);
  /// The process ends by its own decision or on request.
  void stopping();

 private:
  bool send(const std::string& text);

  int descriptor_ = -1;
  bool serves_ = false;
  /// Lines that the manager has not taken yet.
  std::string pending_;
  std::string state_;
};

/// @param journal_stream value of JOURNAL_STREAM, "DEVICE:INODE".
/// @return whether the file descriptor leads to the journal (systemd.exec(5)).
bool leadsToJournal(int descriptor, std::string_view journal_stream);

/// Sets Robot.Token and Robot.ViewToken from the files of these names, where the command line or the file of
/// configuration does not. An absent or empty file sets nothing.
/// @param folder value of CREDENTIALS_DIRECTORY; empty: no credentials.
void addCredentials(Properties& properties, const std::filesystem::path& folder);

}  // namespace vismem
