// Processes that register at an Ice locator: an in-process one, which comes and goes. Tests C3.
#include <Ice/Ice.h>
#include <avm/component.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <map>
#include <mutex>
#include <thread>

#include "support/component_process.h"

namespace vismem {
namespace {

using testing::HasSubstr;

/// What the processes have registered. Thread-safe.
class Registry : public Ice::LocatorRegistry {
 public:
  explicit Registry(std::string only) : only_(std::move(only)) {}

  void setAdapterDirectProxyAsync(std::string id, std::shared_ptr<Ice::ObjectPrx> proxy,
                                  std::function<void()> response,
                                  std::function<void(std::exception_ptr)> exception,
                                  const Ice::Current&) override {
    if (id != only_) return exception(std::make_exception_ptr(Ice::AdapterNotFoundException()));
    set(id, proxy);
    response();
  }
  void setReplicatedAdapterDirectProxyAsync(std::string id, std::string group,
                                            std::shared_ptr<Ice::ObjectPrx> proxy,
                                            std::function<void()> response,
                                            std::function<void(std::exception_ptr)>,
                                            const Ice::Current&) override {
    set(group + "/" + id, proxy);
    std::this_thread::sleep_for(delay_.load());
    response();
  }
  void setServerProcessProxyAsync(std::string id, std::shared_ptr<Ice::ProcessPrx> process,
                                  std::function<void()> response, std::function<void(std::exception_ptr)>,
                                  const Ice::Current&) override {
    set("process " + id, process);
    response();
  }
  /// Registrations of groups are kept at once and answered after this time.
  void answerAfter(std::chrono::milliseconds delay) { delay_ = delay; }
  /// Null: not registered, or withdrawn.
  std::shared_ptr<Ice::ObjectPrx> find(const std::string& id) const {
    const std::scoped_lock lock(mutex_);
    const auto found = proxies_.find(id);
    return found == proxies_.end() ? nullptr : found->second;
  }

 private:
  void set(const std::string& id, const std::shared_ptr<Ice::ObjectPrx>& proxy) {
    const std::scoped_lock lock(mutex_);
    proxies_[id] = proxy;
  }
  const std::string only_;
  std::atomic<std::chrono::milliseconds> delay_{};
  mutable std::mutex mutex_;
  std::map<std::string, std::shared_ptr<Ice::ObjectPrx>> proxies_;
};

/// A locator at a port that it keeps over its absences.
class TestLocator {
 public:
  explicit TestLocator(const std::string& adapter_id) : registry_(std::make_shared<Registry>(adapter_id)) {
    start();
    stop();
  }
  void start() {
    communicator_ = std::make_unique<Ice::CommunicatorHolder>(Ice::initialize());
    const auto adapter =
        (*communicator_)
            ->createObjectAdapterWithEndpoints("Locator", "tcp -h 127.0.0.1 -p " + std::to_string(port_));
    const auto info = adapter->getEndpoints().front()->getInfo();
    port_ = std::dynamic_pointer_cast<Ice::IPEndpointInfo>(info)->port;
    const auto registry =
        Ice::uncheckedCast<Ice::LocatorRegistryPrx>(adapter->add(registry_, {"registry", ""}));
    adapter->add(std::make_shared<Servant>(registry_, registry), {"locator", ""});
    adapter->activate();
  }
  void stop() { communicator_.reset(); }
  std::string proxy() const { return "locator:tcp -h 127.0.0.1 -p " + std::to_string(port_); }
  Registry& registry() { return *registry_; }

 private:
  class Servant : public Ice::Locator {
   public:
    Servant(std::shared_ptr<Registry> registry, std::shared_ptr<Ice::LocatorRegistryPrx> proxy)
        : registry_(std::move(registry)), proxy_(std::move(proxy)) {}
    void findObjectByIdAsync(Ice::Identity, std::function<void(const std::shared_ptr<Ice::ObjectPrx>&)>,
                             std::function<void(std::exception_ptr)> exception,
                             const Ice::Current&) const override {
      exception(std::make_exception_ptr(Ice::ObjectNotFoundException()));
    }
    void findAdapterByIdAsync(std::string id,
                              std::function<void(const std::shared_ptr<Ice::ObjectPrx>&)> response,
                              std::function<void(std::exception_ptr)>, const Ice::Current&) const override {
      response(registry_->find(id));
    }
    std::shared_ptr<Ice::LocatorRegistryPrx> getRegistry(const Ice::Current&) const override {
      return proxy_;
    }

   private:
    const std::shared_ptr<Registry> registry_;
    const std::shared_ptr<Ice::LocatorRegistryPrx> proxy_;
  };

  const std::shared_ptr<Registry> registry_;
  std::unique_ptr<Ice::CommunicatorHolder> communicator_;
  int port_ = 0;
};

class RegistrationTest : public testing::Test {
 protected:
  static avm::ComponentStatus statusAt(const std::shared_ptr<Ice::ObjectPrx>& proxy) {
    return Ice::uncheckedCast<avm::ComponentPrx>(proxy->ice_invocationTimeout(5000))->getStatus();
  }
  avm::ComponentStatus statusOf(const ComponentProcess& probe) {
    return statusAt(client_->stringToProxy(probe.statusProxy()));
  }
  Ice::CommunicatorHolder client_{Ice::initialize()};
};

TEST_F(RegistrationTest, TakesTheEndpointsAsAnIceGridNodeWritesThem) {
  const ComponentProcess probe("probe_component", {"--ProbeAdapter.Endpoints=tcp -h 127.0.0.1"});
  EXPECT_GT(probe.port(), 0) << probe.error();
  EXPECT_THAT(probe.error(), HasSubstr("ProbeAdapter.Endpoints = tcp -h 127.0.0.1   # command line"));
  const ComponentProcess both("probe_component", {"--ProbeAdapter.Endpoints=tcp -h 127.0.0.1",
                                                  "--Probe.Endpoints=tcp -h 127.0.0.1 -p 0"});
  EXPECT_EQ(both.waitForExit(kPatience), 2);
  EXPECT_EQ(
      both.error(),
      "command line: ProbeAdapter.Endpoints = tcp -h 127.0.0.1 (is the same as Probe.Endpoints, which is "
      "set too: keep one)\n");
  const ComponentProcess wrong("probe_component", {"--ProbeAdapter.Endpoints=carrier pigeon"});
  EXPECT_EQ(wrong.waitForExit(kPatience), 2);
  EXPECT_THAT(wrong.error(), HasSubstr("command line: ProbeAdapter.Endpoints = carrier pigeon (must be "
                                       "endpoints such as tcp -h 127.0.0.1 -p 9999: "));
}

TEST_F(RegistrationTest, ServesWithoutARegistryAndRegistersWhenItComes) {
  TestLocator locator("robot7.probe");
  const ComponentProcess probe("probe_component",
                               {"--Ice.Default.Locator=" + locator.proxy(), "--Ice.RetryIntervals=-1",
                                "--ProbeAdapter.AdapterId=robot7.probe"});
  ASSERT_TRUE(probe.waitUntilReady());
  EXPECT_TRUE(eventually([&] { return statusOf(probe).state == avm::ComponentState::Degraded; }));
  EXPECT_EQ(statusOf(probe).reason, "registration: connection refused");
  locator.start();
  ASSERT_TRUE(eventually([&] { return locator.registry().find("robot7.probe") != nullptr; }));
  EXPECT_TRUE(eventually([&] { return statusOf(probe).state == avm::ComponentState::Running; }));
  const auto located =
      client_->stringToProxy("probe_component/component@robot7.probe")
          ->ice_locator(Ice::uncheckedCast<Ice::LocatorPrx>(client_->stringToProxy(locator.proxy())));
  EXPECT_EQ(statusAt(located).name, "probe_component");
}

TEST_F(RegistrationTest, WithdrawsAtItsEnd) {
  TestLocator locator("");
  locator.registry().answerAfter(std::chrono::milliseconds(200));
  locator.start();
  ComponentProcess probe("probe_component",
                         {"--Ice.Default.Locator=" + locator.proxy(), "--ProbeAdapter.AdapterId=robot7.probe",
                          "--ProbeAdapter.ReplicaGroupId=probes"});
  ASSERT_TRUE(eventually([&] { return locator.registry().find("probes/robot7.probe") != nullptr; }));
  EXPECT_EQ(probe.stop(kPatience), 0);
  EXPECT_EQ(locator.registry().find("probes/robot7.probe"), nullptr);
}

TEST_F(RegistrationTest, ARegistryThatVanishedDelaysNoEnd) {
  TestLocator locator("robot7.probe");
  locator.start();
  ComponentProcess probe("probe_component", {"--Ice.Default.Locator=" + locator.proxy(),
                                             "--ProbeAdapter.AdapterId=robot7.probe"});
  ASSERT_TRUE(eventually([&] { return locator.registry().find("robot7.probe") != nullptr; }));
  locator.stop();
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EQ(probe.stop(kPatience), 0);
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(2));
}

TEST_F(RegistrationTest, AnUnknownAdapterIdIsAFaultThatNamesIt) {
  TestLocator locator("robot8.probe");
  locator.start();
  const ComponentProcess probe("probe_component", {"--Ice.Default.Locator=" + locator.proxy(),
                                                   "--ProbeAdapter.AdapterId=robot7.probe"});
  ASSERT_TRUE(probe.waitUntilReady());
  EXPECT_TRUE(eventually([&] { return statusOf(probe).state == avm::ComponentState::Degraded; }));
  EXPECT_THAT(statusOf(probe).reason, HasSubstr("the registry knows no AdapterId robot7.probe"));
}

TEST_F(RegistrationTest, ANodeGetsTheProcessItStartedThoughTheRegistryCameLater) {
  TestLocator locator("");
  const ComponentProcess probe(
      "probe_component", {"--Ice.Default.Locator=" + locator.proxy(), "--Ice.Admin.ServerId=robot7.probe",
                          "--Ice.Admin.Endpoints=tcp -h 127.0.0.1"});
  ASSERT_TRUE(probe.waitUntilReady());
  EXPECT_TRUE(eventually([&] { return statusOf(probe).state == avm::ComponentState::Degraded; }));
  locator.start();
  ASSERT_TRUE(eventually([&] { return locator.registry().find("process robot7.probe") != nullptr; }));
  // As a node stops its servers.
  Ice::uncheckedCast<Ice::ProcessPrx>(
      client_->stringToProxy(locator.registry().find("process robot7.probe")->ice_toString()))
      ->shutdown();
  EXPECT_EQ(probe.waitForExit(kPatience), 0) << probe.error();
}

}  // namespace
}  // namespace vismem
