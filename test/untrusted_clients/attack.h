/// @file Attacks on one server, and a well-behaved client that measures their effect on others.
#pragma once

#include <Ice/Ice.h>

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <mutex>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "untrusted_clients/absurd_values.h"
#include "untrusted_clients/raw_connection.h"

namespace vismem::test {

/// A server under attack: where it listens, and its objects with the interface of each.
struct Target {
  std::string name;
  int tcp_port = 0;
  int ws_port = 0;
  std::map<std::string, const SliceInterface*> objects;  ///< by identity ("cameraA", "simulator/component")
};

/// Sends well-formed calls with absurd values to every operation in turn, many in flight, and now and then a
/// wrong operation, identity, facet or mode, cut parameters, and oneways.
class AbsurdCaller {
 public:
  AbsurdCaller(const SliceModel& model, const Target& target, std::uint64_t seed);
  /// Makes so many calls (rounded up to whole batches); every twoway must be answered or its connection
  /// closed.
  /// @return false when the server cannot be reached or leaves calls unanswered.
  bool call(long count);

  long calls() const { return calls_; }
  long replies() const { return replies_; }
  /// Number of connections that the server closed, which is allowed.
  long closed() const { return closed_; }
  /// Well-formed calls per "identity operation".
  const std::map<std::string, long>& perOperation() const { return per_operation_; }

 private:
  bool connect();
  std::string next(bool& is_twoway);

  const Target& target_;
  std::mt19937_64 random_;
  AbsurdValues values_;
  std::vector<std::pair<std::string, const SliceOperation*>> operations_;
  std::size_t turn_ = 0;
  std::unique_ptr<RawConnection> connection_;
  long calls_ = 0;
  long replies_ = 0;
  long closed_ = 0;
  std::map<std::string, long> per_operation_;
};

/// @return deliveries of garbage made, to both ports in turn, each over a connection of its own; less than
/// asked for
///         when the server can no longer be reached.
long sendGarbage(const Target& target, long count, std::uint64_t seed);

/// Connections that stay open without bytes, or after half a header, message or handshake.
std::vector<RawConnection> leaveStanding(const Target& target, int count);

/// Sends requests repeatedly on a thread of its own, as a well-behaved program does.
class PoliteClient {
 public:
  /// @param ask  one request; throws when it fails.
  PoliteClient(std::string name, std::function<void()> ask);
  ~PoliteClient();
  void stop();

  struct Figures {
    std::string name;
    std::size_t answers = 0;
    double p50_ms = 0.0;
    double p99_ms = 0.0;
    double max_ms = 0.0;
    std::vector<std::string> failures;
  };
  Figures figures() const;

 private:
  const std::string name_;
  mutable std::mutex mutex_;
  std::vector<double> latencies_ms_;
  std::vector<std::string> failures_;
  std::jthread thread_;
};

/// Resident memory of a process [MB]; 0 if there is none.
double residentMb(pid_t pid);
/// Maximum resident memory so far [MB].
double peakMb(pid_t pid);

}  // namespace vismem::test
