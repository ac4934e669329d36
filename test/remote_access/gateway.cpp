#include "remote_access/gateway.h"

#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <regex>
#include <stdexcept>
#include <utility>

#include "support/build_paths.h"
#include "support/eventually.h"

namespace vismem::test {
namespace {

/// A port that is free now.
int freePort() {
  const int socket = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof address;
  if (bind(socket, reinterpret_cast<sockaddr*>(&address), size) != 0 ||
      getsockname(socket, reinterpret_cast<sockaddr*>(&address), &size) != 0)
    throw std::runtime_error("no free port");
  close(socket);
  return ntohs(address.sin_port);
}

void runScript(std::vector<std::string> command, ChildProcess::Options options = {}) {
  command[0] = std::string(VISMEM_SOURCE_DIR) + "/" + command[0];
  ChildProcess script(command, std::move(options));
  const auto code = script.waitForExit(kPatience);
  if (code != 0) throw std::runtime_error(command[0] + ": " + script.error());
}

/// "127.0.0.1:9999" of each endpoint, as a router's address filter has them.
std::string addresses(const std::vector<std::string>& endpoints) {
  static const std::regex kPort("-p +([0-9]+)");
  std::string list;
  for (const std::string& text : endpoints) {
    for (std::sregex_iterator match(text.begin(), text.end(), kPort), end; match != end; ++match)
      list += (list.empty() ? "127.0.0.1:" : " 127.0.0.1:") + (*match)[1].str();
  }
  return list;
}

}  // namespace

void makeCertificate(const std::string& folder, const std::string& name, const std::string& role) {
  runScript({"deploy/pki/certificates", folder, "make", name, role, "127.0.0.1"});
}

std::shared_ptr<Ice::Communicator> tlsClient(const std::string& folder, const std::string& certificate) {
  Ice::InitializationData data;
  data.properties = Ice::createProperties();
  const std::map<std::string, std::string> settings{{"Ice.Plugin.IceSSL", "IceSSL:createIceSSL"},
                                                    {"IceSSL.DefaultDir", folder},
                                                    {"IceSSL.CAs", "ca.pem"},
                                                    {"IceSSL.CertFile", certificate},
                                                    {"IceSSL.CheckCertName", "1"},
                                                    {"Ice.MessageSizeMax", "16384"},
                                                    {"Ice.Default.InvocationTimeout", "10000"},
                                                    {"Ice.RetryIntervals", "-1"},
                                                    {"Ice.ThreadPool.Client.SizeMax", "4"}};
  for (const auto& [key, value] : settings) data.properties->setProperty(key, value);
  return Ice::initialize(data);
}

GatewaySession::GatewaySession(std::shared_ptr<Ice::Communicator> communicator, const std::string& router)
    : communicator_(std::move(communicator)),
      router_(Ice::uncheckedCast<Glacier2::RouterPrx>(communicator_->stringToProxy(router))) {}

Gateway::Gateway(const std::vector<std::string>& endpoints, const std::map<std::string, std::string>& leased,
                 const std::string& view_category) {
  makeFiles();
  std::vector<std::string> arguments{"deploy/gateway/gateway_access.cfg",
                                     "--GatewayAccess.Endpoints=tcp -h 127.0.0.1 -p 0",
                                     "--GatewayAccess.Operators=" + folder_ / "operators",
                                     "--GatewayAccess.Viewers=" + folder_ / "viewers",
                                     "--GatewayAccess.Leased.Base.Proxy=",
                                     "--GatewayAccess.Leased.PanTilt.Proxy="};
  for (const auto& [name, proxy] : leased)
    arguments.push_back("--GatewayAccess.Leased." + name + ".Proxy=" + proxy);
  ChildProcess::Options options;
  options.working_directory = VISMEM_SOURCE_DIR;
  access_ = std::make_unique<ComponentProcess>("gateway_access", arguments, options);
  if (!access_->readyLine()) throw std::runtime_error("gateway_access is not ready:\n" + access_->error());
  startRouter("operator", freePort(), endpoints, {});
  startRouter("viewer", freePort(), endpoints,
              {"--Glacier2.Filter.Category.Accept=\"" + view_category + "\""});
  for (const bool viewer : {false, true}) {
    const auto router = connect(viewer);
    const auto object = router->direct(routerProxy(viewer));
    const auto serves = [&] {
      try {
        object->ice_ping();
        return true;
      } catch (const Ice::LocalException&) {
        return false;
      }
    };
    if (!eventually(serves)) throw std::runtime_error("a router does not serve:\n" + routerLog(viewer));
  }
}

void Gateway::makeFiles() const {
  makeCertificate(folder_.path().string(), "gateway", "gateway");
  ChildProcess::Options options;
  options.environment = {{"VISMEM_GATEWAY", folder_.path().string()}, {"PASSWORD", kPassword}};
  const std::string add =
      std::string("printf '%s\\n' \"$PASSWORD\" | ") + VISMEM_SOURCE_DIR "/deploy/gateway/gateway_user ";
  for (const auto& [role, user] : {std::pair{"operator", kOperator}, std::pair{"operator", kSecondOperator},
                                   std::pair{"viewer", kViewer}}) {
    ChildProcess script({"bash", "-c", add + role + " add " + user}, options);
    if (script.waitForExit(kPatience) != 0) throw std::runtime_error("gateway_user: " + script.error());
  }
}

void Gateway::startRouter(const std::string& role, int port, const std::vector<std::string>& endpoints,
                          std::vector<std::string> more) {
  const int web_port = freePort();
  const std::string access = ":tcp -h 127.0.0.1 -p " + std::to_string(access_->port());
  std::vector<std::string> command{"glacier2router",
                                   "--Ice.Config=" VISMEM_SOURCE_DIR "/deploy/gateway/" + role + ".cfg",
                                   "--Glacier2.Client.Endpoints=ssl -h 127.0.0.1 -p " + std::to_string(port) +
                                       ":wss -h 127.0.0.1 -p " + std::to_string(web_port),
                                   "--Glacier2.PermissionsVerifier=" + role + "s" + access,
                                   "--Glacier2.SessionManager=sessions" + access,
                                   "--Glacier2.Filter.Address.Accept=" + addresses(endpoints),
                                   "--IceSSL.DefaultDir=" + folder_.path().string()};
  command.insert(command.end(), more.begin(), more.end());
  routers_.push_back(std::make_unique<ChildProcess>(command));
  ports_.insert(ports_.end(), {port, web_port});
}

int Gateway::port(bool viewer, const std::string& transport) const {
  return ports_[(viewer ? 2 : 0) + (transport == "wss" ? 1 : 0)];
}

std::shared_ptr<Ice::Communicator> Gateway::client() const {
  return tlsClient(folder_.path().string(), {});
}

std::string Gateway::routerProxy(bool viewer, const std::string& transport) const {
  return std::string(viewer ? "Viewer" : "Operator") + "/router:" + transport + " -h 127.0.0.1 -p " +
         std::to_string(port(viewer, transport));
}

std::unique_ptr<GatewaySession> Gateway::connect(bool viewer, const std::string& transport) const {
  return std::make_unique<GatewaySession>(client(), routerProxy(viewer, transport));
}

std::unique_ptr<GatewaySession> Gateway::operatorSession(const std::string& user) const {
  auto session = connect(false);
  session->logIn(user, kPassword);
  return session;
}

std::unique_ptr<GatewaySession> Gateway::viewerSession() const {
  auto session = connect(true);
  session->logIn(kViewer, kPassword);
  return session;
}

}  // namespace vismem::test
