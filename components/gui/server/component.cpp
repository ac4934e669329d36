#include "gui/server/component.h"

#include <array>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "common/config/project_file.h"
#include "common/config/text_fields.h"
#include "common/process/ice_setup.h"
#include "common/process/log.h"
#include "common/process/robot_identity.h"
#include "common/process/status.h"
#include "gui/server/http_endpoint.h"
#include "gui/server/page_server.h"

namespace vismem {
namespace {

/// Objects that the page may talk to: name of the key, and of the entry in /config.json.
constexpr std::array<std::string_view, 10> kObjects{"Camera",       "PanTilt", "Base",         "Odometry",
                                                    "VisualMemory", "Gaze",    "Localization", "Simulation",
                                                    "Replay",       "Recorder"};

/// gui/ beside the folder of the program (build/release/bin/gui_server, build/release/gui); of an installed
/// one share/vismem/gui below a folder above it.
std::filesystem::path defaultPages() {
  std::error_code error;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) return "gui";
  const auto installed = findUpwards(program.parent_path(), "share/vismem/gui");
  return installed.empty() ? program.parent_path().parent_path() / "gui" : installed;
}

class GuiServer : public Component {
 public:
  explicit GuiServer(PageServer::Options options) : options_(std::move(options)) {}

  void start(ComponentHost& host) override {
    options_.on_answer = [&host](int) { host.status().count("requests"); };
    server_ = std::make_unique<PageServer>(options_);
    server_->bind();
    host.log().info("pages at " + server_->address());
    if (!isLoopback(options_.endpoint.host)) {
      host.status().error("pages open to other machines: " + server_->address() +
                          " (they hold the token; 127.0.0.1 keeps them to this machine)");
    }
    thread_ = std::jthread(host.guarded([this](const std::stop_token&) { server_->serve(); }));
  }

  void stop() override {
    if (server_) server_->stop();
    if (thread_.joinable()) thread_.join();
  }

 private:
  PageServer::Options options_;
  std::unique_ptr<PageServer> server_;
  std::jthread thread_;
};

/// How pages reach the objects.
struct Access {
  RobotKeys robot;
  /// Only reading operations.
  bool viewer = false;
  /// Proxy of a Glacier2 router; empty: pages connect to the components themselves.
  std::string gateway;
  /// Of the faces; empty behind a gateway for operators, who use the objects' own identities.
  std::string category;
};

/// Notes the socket of a proxy for the policy.
/// @return whether a browser can use it; a problem if not.
bool noteSocket(ConfigReader& config, const std::string& name, const std::string& proxy,
                std::vector<std::string>& sockets) {
  const auto socket = webSocketSource(proxy);
  if (socket)
    sockets.push_back(*socket);
  else
    config.problem(name,
                   "must have an endpoint of protocol ws or wss with -h and -p: a browser speaks no other");
  return socket.has_value();
}

/// Reads a proxy and names the object as pages reach it. Behind a gateway its endpoints are those that the
/// gateway reaches.
std::string readProxy(ConfigReader& config, const std::string& name, const Access& access,
                      std::vector<std::string>& sockets) {
  const auto proxy = config.text(name, "");
  if (proxy.empty()) return proxy;
  if (access.gateway.empty() && !noteSocket(config, name, proxy, sockets)) return proxy;
  return access.category.empty() ? ownProxy(proxy, access.robot)
                                 : faceProxy(proxy, access.robot, access.category);
}

/// A problem without the token that pages need.
Access readAccess(ConfigReader& root, ConfigReader& config, std::vector<std::string>& sockets) {
  Access access;
  access.robot = readRobotKeys(root);
  access.viewer = config.boolean("ReadOnly", false);
  access.gateway = config.text("Gateway.Router", "");
  if (!access.gateway.empty()) {
    noteSocket(config, "Gateway.Router", access.gateway, sockets);
    if (access.viewer) access.category = access.robot.viewCategory();
    return access;
  }
  access.category = access.viewer ? access.robot.viewTokenCategory() : access.robot.tokenCategory();
  const std::string token = access.viewer ? "Robot.ViewToken" : "Robot.Token";
  if (root.text(token, "").empty()) {
    config.problem(
        "ReadOnly",
        "needs " + token +
            ", as scripts/start and scripts/run draw it: components answer web pages only with a token");
  }
  return access;
}

/// What /config.json says: the objects, under the names that hold the token.
nlohmann::json readObjects(ConfigReader& root, ConfigReader& config, std::vector<std::string>& sockets) {
  const Access access = readAccess(root, config, sockets);
  nlohmann::json objects = nlohmann::json::object();
  for (const auto name : kObjects) {
    config.group(name).describe(
        {basic("Proxy", "an object that the page uses, at a ws endpoint; empty: not shown")});
    const auto proxy = readProxy(config, std::string(name) + ".Proxy", access, sockets);
    if (!proxy.empty()) objects[std::string(name)] = proxy;
  }
  nlohmann::json components = nlohmann::json::array();
  for (const auto& name : config.children("Components")) {
    config.group("Components." + name).describe({basic("Proxy", "whose state the page shows")});
    const auto proxy = readProxy(config, "Components." + name + ".Proxy", access, sockets);
    if (!proxy.empty()) components.push_back({{"name", name}, {"proxy", proxy}});
  }
  return {{"version", VISMEM_VERSION}, {"robot", root.text("Robot.Name", "")},
          {"viewer", access.viewer},   {"gateway", access.gateway},
          {"proxies", objects},        {"components", components}};
}

void describeKeys(ConfigReader& config) {
  config.describe({basic("Http.Endpoints", "where pages are served; port 0: a free one, which the log names"),
                   expert("Http.Hosts", "more names of this server, with blanks between; others are refused"),
                   expert("Pages", "folder of the page; empty: that of this program"),
                   basic("ReadOnly", "the page only watches; needs Robot.ViewToken"),
                   expert("Gateway.Router", "a router of Glacier2, at which the page logs in; empty: none"),
                   basic("Setup", "name on top of the page, where the robot has none"),
                   expert("Truth", "no: the map has a frame of its own, in which true poses mean nothing")});
}

std::unique_ptr<Component> configure(ConfigReader& reader) {
  ConfigReader config = reader.group("GuiServer");
  describeKeys(config);
  PageServer::Options options;
  const auto endpoint_text = config.text("Http.Endpoints", kDefaultHttpEndpoint);
  if (const auto endpoint = parseHttpEndpoint(endpoint_text))
    options.endpoint = *endpoint;
  else
    config.problem("Http.Endpoints", "must be http -h HOST -p PORT, such as http -h 127.0.0.1 -p 8770");
  const bool plain_remote = config.boolean("PlainRemote", false);
  if (!options.endpoint.host.empty() && !isLoopback(options.endpoint.host) && !plain_remote) {
    config.problem(
        "Http.Endpoints",
        "must be http -h 127.0.0.1 -p PORT, since pages are served without TLS and may hold a token; "
        "GuiServer.PlainRemote = yes serves them to everybody");
  }
  const auto hosts = config.text("Http.Hosts", "");
  for (const auto host : words(hosts)) options.hosts.emplace_back(host);
  options.pages = config.existingPath("Pages");
  if (options.pages.empty()) options.pages = defaultPages();
  auto description = readObjects(reader, config, options.sockets);
  description["setup"] = config.text("Setup", "");
  description["truth"] = config.boolean("Truth", true);
  options.config_json = description.dump();
  if (!config.good()) return nullptr;
  return std::make_unique<GuiServer>(std::move(options));
}

}  // namespace

ComponentSpec guiServerSpec() {
  ComponentSpec spec;
  spec.name = "gui_server";
  spec.prefix = "GuiServer";
  spec.summary = "Serves the page of the graphical user interface and says where the components are.";
  spec.default_endpoints = "tcp -h 127.0.0.1 -p 9975";
  spec.configure = configure;
  return spec;
}

}  // namespace vismem
