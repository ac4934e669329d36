#include "gateway_access/ice/access_servants.h"

#include <Ice/Ice.h>

#include <cmath>
#include <system_error>
#include <utility>

#include "common/config/config_error.h"
#include "common/config/text_file.h"
#include "common/process/ice_failure.h"
#include "common/process/log.h"

namespace vismem {
namespace {

constexpr std::size_t kLongestUser = 100;

/// An entry of the context that a router adds; empty without it. At a login a client's own entries are
/// dropped.
std::string entry(const Ice::Current& current, const char* name) {
  const auto found = current.ctx.find(name);
  return found == current.ctx.end() ? "" : found->second;
}

std::string addressOf(const Ice::Current& current) {
  const std::string address = entry(current, "_con.remoteAddress");
  return address.empty() ? "local" : address;
}

}  // namespace

std::chrono::milliseconds LoginGuard::wait(const std::string& address) {
  const std::scoped_lock lock(mutex_);
  return limiter_.wait(limitedAddress(address), now_());
}

void LoginGuard::wrong(const std::string& address) {
  const std::scoped_lock lock(mutex_);
  limiter_.wrong(limitedAddress(address), now_());
}

Passwords::Passwords(std::filesystem::path file)
    : file_(std::move(file)),
      read_(std::filesystem::last_write_time(file_)),
      users_(std::make_shared<PasswordFile>(
          PasswordFile::parse(readTextFile(file_, "users and hashes of passwords"), file_.string()))) {}

std::shared_ptr<const PasswordFile> Passwords::users(std::string& problem) {
  const std::scoped_lock lock(mutex_);
  std::error_code failed;
  const auto written = std::filesystem::last_write_time(file_, failed);
  if (failed || written == read_) return users_;
  read_ = written;
  try {
    users_ = std::make_shared<PasswordFile>(
        PasswordFile::parse(readTextFile(file_, "users and hashes of passwords"), file_.string()));
  } catch (const ConfigError& wrong) {
    problem = wrong.what();
  }
  return users_;
}

bool LoginVerifier::checkPermissions(std::string user, std::string password, std::string& reason,
                                     const Ice::Current& current) const {
  const std::string address = addressOf(current);
  const std::string who = shown(user, kLongestUser) + " at " + address + " as " + role_;
  const auto wait = guard_->wait(address);
  if (wait.count() > 0) {
    reason = "too many wrong logins: try again in " +
             std::to_string(static_cast<int>(std::ceil(static_cast<double>(wait.count()) / 1000.0))) + " s";
    return false;
  }
  std::string problem;
  const auto users = passwords_->users(problem);
  if (!problem.empty()) log_.error("passwords stay as they were: " + problem);
  if (user.size() <= kLongestUser && users->isRight(user, password)) {
    log_.info("logged in: " + who);
    return true;
  }
  guard_->wrong(address);
  log_.warning("wrong login: " + who);
  reason = "wrong user or password";
  return false;
}

class Sessions::Session : public Glacier2::Session {
 public:
  Session(Sessions& sessions, std::string user, std::string client)
      : sessions_(sessions), user_(std::move(user)), client_(std::move(client)) {}

  void destroy(const Ice::Current& current) override {
    current.adapter->remove(current.id);
    sessions_.ended(user_, client_);
  }

 private:
  Sessions& sessions_;
  const std::string user_;
  const std::string client_;
};

std::shared_ptr<Glacier2::SessionPrx> Sessions::create(std::string user,
                                                       std::shared_ptr<Glacier2::SessionControlPrx>,
                                                       const Ice::Current& current) {
  const std::string client = addressOf(current) + ":" + entry(current, "_con.remotePort");
  const auto session = Ice::uncheckedCast<Glacier2::SessionPrx>(
      current.adapter->addWithUUID(std::make_shared<Session>(*this, user, client)));
  const std::scoped_lock lock(mutex_);
  changed_(++count_);
  return session;
}

void Sessions::ended(const std::string& user, const std::string& client) {
  log_.info("session ended: " + shown(user, kLongestUser) + " at " + client);
  for (const Leased& leased : leased_) {
    // A peer that is away holds no lease of anybody's for longer than the lease's own time.
    leased.proxy->endSessionAsync(
        client, [](const avm::CommandReply&) {},
        [name = leased.name, &log = log_](std::exception_ptr failure) {
          try {
            std::rethrow_exception(failure);
          } catch (const std::exception& error) {
            log.warning(name + ": the lease of an ended session stays until its time is over (" +
                        describeFailure(error) + ")");
          }
        });
  }
  const std::scoped_lock lock(mutex_);
  changed_(--count_);
}

}  // namespace vismem
