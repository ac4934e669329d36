#include "common/process/registration.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "common/process/ice_failure.h"
#include "common/process/status.h"

namespace vismem {
namespace {

using std::chrono::milliseconds;

constexpr milliseconds kFirstRetry{500};
constexpr milliseconds kLongestRetry{5000};
constexpr milliseconds kRenewal{30'000};
constexpr int kWithdrawal_ms = 500;
constexpr const char* kFault = "registration";

std::string endpointsOf(const std::shared_ptr<Ice::ObjectPrx>& proxy) {
  std::string text;
  for (const auto& endpoint : proxy->ice_getEndpoints()) text += endpoint->toString() + ":";
  return text;
}

/// @param proxy null withdraws.
void setProxy(Ice::LocatorRegistryPrx& registry, const std::string& id, const std::string& group,
              const std::shared_ptr<Ice::ObjectPrx>& proxy) {
  if (group.empty()) {
    registry.setAdapterDirectProxy(id, proxy);
  } else {
    registry.setReplicatedAdapterDirectProxy(id, group, proxy);
  }
}

}  // namespace

bool registersProcess(const Ice::PropertiesPtr& properties) {
  return !properties->getProperty("Ice.Admin.ServerId").empty() &&
         !properties->getProperty("Ice.Admin.Endpoints").empty() &&
         !properties->getProperty("Ice.Default.Locator").empty();
}

Registration::Registration(std::shared_ptr<Ice::Communicator> communicator,
                           const std::vector<std::shared_ptr<Ice::ObjectAdapter>>& adapters,
                           StatusBoard& status)
    : communicator_(std::move(communicator)), status_(status) {
  const auto properties = communicator_->getProperties();
  if (registersProcess(properties)) server_id_ = properties->getProperty("Ice.Admin.ServerId");
  for (const auto& adapter : adapters) {
    if (!adapter) continue;
    Entry entry{adapter, adapter->getLocator(), properties->getProperty(adapter->getName() + ".AdapterId"),
                properties->getProperty(adapter->getName() + ".ReplicaGroupId")};
    if (!entry.locator || entry.id.empty()) continue;
    adapter->setLocator(nullptr);
    entries_.push_back(std::move(entry));
  }
}

Registration::~Registration() = default;

void Registration::begin() {
  if (entries_.empty() && server_id_.empty()) return;
  thread_ = std::jthread([this](const std::stop_token& stop) { run(stop); });
}

void Registration::withdraw() {
  thread_.request_stop();
  // The registry may have taken an entry whose answer is still on its way.
  const std::unique_lock lock(calls_, milliseconds(kWithdrawal_ms));
  if (!is_registered_) return;
  for (const Entry& entry : entries_) {
    try {
      const auto locator = entry.locator->ice_invocationTimeout(kWithdrawal_ms);
      const auto registry = locator->getRegistry()->ice_invocationTimeout(kWithdrawal_ms);
      setProxy(*registry, entry.id, entry.replica_group, nullptr);
    } catch (const Ice::Exception&) {
      // The registry is away: clients find out when they connect.
    }
  }
}

void Registration::run(const std::stop_token& stop) {
  std::condition_variable_any pause;
  milliseconds retry = kFirstRetry;
  std::unique_lock lock(calls_);
  while (!stop.stop_requested()) {
    milliseconds wait = kRenewal;
    try {
      if (!server_id_.empty()) registerProcess();
      for (const Entry& entry : entries_) registerAdapter(entry);
      is_registered_ = true;
      status_.healthy(kFault);
      retry = kFirstRetry;
    } catch (const Ice::CommunicatorDestroyedException&) {
      return;
    } catch (const std::exception& failure) {
      if (stop.stop_requested()) return;
      status_.fault(kFault, describeFailure(failure));
      wait = std::exchange(retry, std::min(2 * retry, kLongestRetry));
    }
    pause.wait_for(lock, stop, wait, [] { return false; });
  }
}

void Registration::registerProcess() {
  std::shared_ptr<Ice::ObjectPrx> admin;
  try {
    admin = communicator_->getAdmin();
  } catch (const Ice::CommunicatorDestroyedException&) {
    throw;
  } catch (const Ice::LocalException&) {
    // The first call makes the object and registers it; after a failed registration the object is there.
    admin = communicator_->getAdmin();
  }
  if (!admin) return;
  const auto process = Ice::uncheckedCast<Ice::ProcessPrx>(admin->ice_facet("Process"));
  communicator_->getDefaultLocator()->getRegistry()->setServerProcessProxy(server_id_, process);
}

void Registration::registerAdapter(const Entry& entry) {
  // The registry keeps the endpoints alone.
  const auto proxy = entry.adapter->createDirectProxy({"dummy", ""});
  try {
    setProxy(*entry.locator->getRegistry(), entry.id, entry.replica_group, proxy);
  } catch (const Ice::AdapterAlreadyActiveException&) {
    // A node refuses a second registration, also of the same endpoints.
    const auto known = entry.locator->findAdapterById(entry.id);
    if (!known || endpointsOf(known) != endpointsOf(proxy)) {
      throw std::runtime_error("another process has the AdapterId " + entry.id);
    }
  } catch (const Ice::AdapterNotFoundException&) {
    throw std::runtime_error("the registry knows no AdapterId " + entry.id +
                             " (IceGrid.Registry.DynamicRegistration=1 takes any)");
  } catch (const Ice::InvalidReplicaGroupIdException&) {
    throw std::runtime_error("the registry knows no ReplicaGroupId " + entry.replica_group);
  }
}

}  // namespace vismem
