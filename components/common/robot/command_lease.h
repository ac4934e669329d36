/// @file Who commands an actuator: one client at a time, by a lease that ends by itself. Pure: time and ids
/// are passed in. Implements the lease of interfaces/avm/lease.ice (docs/remote-access.md).
#pragma once

#include <chrono>
#include <functional>
#include <optional>
#include <string>

namespace vismem {

/// *Single-threaded* (owner: the servant's lock). Invariant: at most one holder; a holder whose time is over
/// holds nothing, whichever operation looks next.
class CommandLease {
 public:
  using Time = std::chrono::steady_clock::time_point;
  using Duration = std::chrono::steady_clock::duration;

  /// How long a lease lasts that was taken by a command without one, unless the command itself ends sooner.
  static constexpr std::chrono::milliseconds kImplicitTimeout{1000};
  /// How long nobody commands after stop().
  static constexpr std::chrono::milliseconds kStopTimeout{1000};
  static constexpr int kMaximumPriority = 100;

  struct State {
    bool held = false;
    std::string client;  ///< as it named itself, its connection, or "stop"
    int priority = 0;    ///< 0..kMaximumPriority; 0: implicit; kMaximumPriority + 1: stop()
    bool implicit = false;
    double remaining_s = 0.0;
  };

  struct Grant {
    std::string id;      ///< empty: refused
    std::string reason;  ///< why it was refused, for people
  };

  /// @param make_id gives a new id that nobody can guess; not empty.
  explicit CommandLease(std::function<std::string()> make_id) : make_id_(std::move(make_id)) {}

  /// Granted if nobody holds the lease, or if the holder's priority is lower. @param priority
  /// 0..kMaximumPriority. @param connection of the caller.
  Grant acquire(const std::string& client, int priority, Duration timeout, const std::string& connection,
                Time now);
  /// @return empty if the lease lasts its timeout from now on, else why not.
  std::string renew(const std::string& id, Time now);
  /// @return whether the lease was held until now.
  bool release(const std::string& id, Time now);
  /// A connection has ended, and with it the lease that was acquired over it. @return whether there was one.
  bool releaseConnection(const std::string& connection, Time now);

  /// Whether a command may be followed; renews the lease that it comes under, or takes an implicit one.
  /// @param id of the lease that came with the command; empty: none did. @param connection of the caller.
  /// @param implicit_timeout of an implicit lease: as long as the command holds.
  /// @return empty if it may, else why not.
  std::string admit(const std::string& id, const std::string& connection, Time now,
                    Duration implicit_timeout = kImplicitTimeout);
  /// Ends every lease; for kStopTimeout nothing is admitted or granted.
  void stop(Time now);

  State state(Time now) const;

 private:
  struct Holder {
    std::string id;  ///< empty: implicit
    std::string client;
    std::string connection;
    int priority = 0;
    Duration timeout{};
    Time end;
    bool implicit() const { return id.empty(); }
  };
  const Holder* holder(Time now) const { return holder_ && now < holder_->end ? &*holder_ : nullptr; }
  std::string busy(Time now) const;
  bool isHeldBy(const std::string& id, Time now) const;

  std::function<std::string()> make_id_;
  std::optional<Holder> holder_;  ///< may be over: holder() knows
};

}  // namespace vismem
