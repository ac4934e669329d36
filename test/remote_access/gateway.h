/// @file The gateway of deploy/gateway as it stands, on ports of its own: gateway_access and two routers of
/// Glacier2.
#pragma once

#include <Glacier2/Router.h>
#include <Ice/Ice.h>

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "support/component_process.h"
#include "support/temporary_folder.h"

namespace vismem::test {

/// FOLDER/NAME.pem for 127.0.0.1; the first call makes the authority FOLDER/ca.pem.
void makeCertificate(const std::string& folder, const std::string& name, const std::string& role);

/// A client over TLS that trusts FOLDER/ca.pem. @param certificate that it shows; empty: none.
std::shared_ptr<Ice::Communicator> tlsClient(const std::string& folder, const std::string& certificate);

/// A session of one person through one router; ends with this object.
class GatewaySession {
 public:
  /// @param communicator of this session alone, over TLS.
  GatewaySession(std::shared_ptr<Ice::Communicator> communicator, const std::string& router);

  /// @throw Glacier2::PermissionDeniedException, Ice::LocalException.
  void logIn(const std::string& user, const std::string& password) { router_->createSession(user, password); }

  /// An object behind the gateway, such as "Motors:tcp -h 127.0.0.1 -p 9990".
  template <typename Prx = Ice::ObjectPrx>
  std::shared_ptr<Prx> find(const std::string& proxy) {
    return Ice::uncheckedCast<Prx>(communicator_->stringToProxy(proxy)->ice_router(router_));
  }
  /// The same proxy without the router: to the router's own endpoints.
  std::shared_ptr<Ice::ObjectPrx> direct(const std::string& proxy) {
    return communicator_->stringToProxy(proxy);
  }

 private:
  Ice::CommunicatorHolder communicator_;
  std::shared_ptr<Glacier2::RouterPrx> router_;
};

class Gateway {
 public:
  static constexpr const char* kOperator = "ana";
  static constexpr const char* kSecondOperator = "ben";
  static constexpr const char* kViewer = "vera";
  static constexpr const char* kPassword = "open sesame";

  /// Waits until both routers serve. @param endpoints that sessions reach, "tcp -h 127.0.0.1 -p 9999:...".
  /// @param leased proxies of actuators by name. @param view_category of the viewers' router.
  Gateway(const std::vector<std::string>& endpoints, const std::map<std::string, std::string>& leased,
          const std::string& view_category = "robot.view");

  /// A connection that is not logged in. @param viewer to the viewers' router, else to the operators'.
  std::unique_ptr<GatewaySession> connect(bool viewer, const std::string& transport = "ssl") const;
  std::unique_ptr<GatewaySession> operatorSession(const std::string& user = kOperator) const;
  std::unique_ptr<GatewaySession> viewerSession() const;

  /// A client of the routers without a session, and what it calls: for many sessions in one client.
  std::shared_ptr<Ice::Communicator> client() const;
  std::string routerProxy(bool viewer, const std::string& transport = "ssl") const;

  int port(bool viewer, const std::string& transport = "ssl") const;
  pid_t router(bool viewer) const { return routers_[viewer ? 1 : 0]->pid(); }
  const ComponentProcess& access() const { return *access_; }
  std::string routerLog(bool viewer) const { return routers_[viewer ? 1 : 0]->error(); }

 private:
  void makeFiles() const;
  void startRouter(const std::string& role, int port, const std::vector<std::string>& endpoints,
                   std::vector<std::string> more);

  TemporaryFolder folder_;
  std::vector<int> ports_;
  std::unique_ptr<ComponentProcess> access_;
  std::vector<std::unique_ptr<ChildProcess>> routers_;
};

}  // namespace vismem::test
