/// @file Registration of a process at an Ice locator such as an IceGrid registry, which may be away. See C3.
#pragma once

#include <Ice/Ice.h>

#include <atomic>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace vismem {

class StatusBoard;

/// Registers adapters that have an AdapterId and a locator, and the process where an IceGrid node started it
/// (Ice.Admin.ServerId). Ice itself would fail to activate such an adapter while the registry is away; here
/// it serves at once and is registered as soon as the registry answers. A failure is a fault of the status.
/// Renewed every 30 s: a registry that lost its database knows the process again. The methods are called by
/// one thread.
class Registration {
 public:
  /// Takes the adapters' registration over from Ice. They are not active yet.
  Registration(std::shared_ptr<Ice::Communicator> communicator,
               const std::vector<std::shared_ptr<Ice::ObjectAdapter>>& adapters, StatusBoard& status);
  /// Waits for a call in flight: the communicator is destroyed before, which ends it.
  ~Registration();
  Registration(const Registration&) = delete;
  Registration& operator=(const Registration&) = delete;

  /// Registers in a thread of its own. Call it when the adapters are active.
  void begin();
  /// Ends that and withdraws what is registered. Takes at most half a second, and as much for each adapter.
  void withdraw();

 private:
  struct Entry {
    std::shared_ptr<Ice::ObjectAdapter> adapter;
    std::shared_ptr<Ice::LocatorPrx> locator;
    std::string id;
    std::string replica_group;  ///< empty: of none
  };

  void run(const std::stop_token& stop);
  void registerProcess();
  void registerAdapter(const Entry& entry);

  const std::shared_ptr<Ice::Communicator> communicator_;
  StatusBoard& status_;
  std::vector<Entry> entries_;
  std::string server_id_;  ///< empty: no node started this process
  std::atomic<bool> is_registered_ = false;
  std::timed_mutex calls_;  ///< held by the thread of begin() while it calls the registry
  std::jthread thread_;
};

/// Ice.Admin.ServerId makes Ice register the process while its communicator is made, which fails without a
/// registry. @return whether Registration does that for these properties.
bool registersProcess(const Ice::PropertiesPtr& properties);

}  // namespace vismem
