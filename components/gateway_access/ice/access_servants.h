/// @file What a Glacier2 router asks: whether a password is right, and for an object for each session.
#pragma once

#include <Glacier2/PermissionsVerifier.h>
#include <Glacier2/Session.h>
#include <avm/lease.h>

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "gateway_access/core/login_limiter.h"
#include "gateway_access/core/password_file.h"

namespace vismem {

class Logger;

/// Wrong logins of all routers of a gateway: an address may not try at the one what the other refuses.
/// *Thread-safe.*
class LoginGuard {
 public:
  using Now = std::function<LoginLimiter::Time()>;

  explicit LoginGuard(int most_wrong, Now now = std::chrono::steady_clock::now)
      : now_(std::move(now)), limiter_(most_wrong) {}

  /// @return how long the address must wait; zero if it may try now.
  std::chrono::milliseconds wait(const std::string& address);
  void wrong(const std::string& address);

 private:
  const Now now_;
  std::mutex mutex_;
  LoginLimiter limiter_;
};

/// The passwords of one router, from a file that may change while it is used. *Thread-safe.*
class Passwords {
 public:
  /// @throw ConfigError.
  explicit Passwords(std::filesystem::path file);

  /// The users as the file has them now. Of a changed file that is wrong, those before.
  /// @param problem set to what is wrong with a changed file, once.
  std::shared_ptr<const PasswordFile> users(std::string& problem);

 private:
  const std::filesystem::path file_;
  std::mutex mutex_;
  std::filesystem::file_time_type read_;
  std::shared_ptr<const PasswordFile> users_;
};

/// Answers one router's question whether somebody may log in. Needs the router's
/// Glacier2.AddConnectionContext: the client's address counts wrong logins. A call without an address counts
/// for "local".
class LoginVerifier : public Glacier2::PermissionsVerifier {
 public:
  LoginVerifier(std::string role, std::shared_ptr<Passwords> passwords, std::shared_ptr<LoginGuard> guard,
                Logger& log)
      : role_(std::move(role)), passwords_(std::move(passwords)), guard_(std::move(guard)), log_(log) {}

  bool checkPermissions(std::string user, std::string password, std::string& reason,
                        const Ice::Current& current) const override;

 private:
  const std::string role_;
  const std::shared_ptr<Passwords> passwords_;
  const std::shared_ptr<LoginGuard> guard_;
  Logger& log_;
};

/// Makes the object of each session. When a router destroys it (log out, lost connection, time out), the
/// leases that the session's client holds end.
class Sessions : public Glacier2::SessionManager {
 public:
  struct Leased {
    std::string name;  ///< for people: "Base"
    std::shared_ptr<avm::LeasablePrx> proxy;
  };

  /// @param changed called with the number of sessions after each change.
  Sessions(std::vector<Leased> leased, std::function<void(int)> changed, Logger& log)
      : leased_(std::move(leased)), changed_(std::move(changed)), log_(log) {}

  std::shared_ptr<Glacier2::SessionPrx> create(std::string user,
                                               std::shared_ptr<Glacier2::SessionControlPrx> control,
                                               const Ice::Current& current) override;

 private:
  class Session;
  void ended(const std::string& user, const std::string& client);

  const std::vector<Leased> leased_;
  const std::function<void(int)> changed_;
  Logger& log_;
  std::mutex mutex_;
  int count_ = 0;
};

}  // namespace vismem
