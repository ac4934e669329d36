/// @file The GUI's files and what they need to know, over HTTP. Thread-safe after construction.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "gui/server/http_endpoint.h"

namespace vismem {

/// Serves a folder of files and one text, /config.json, to pages of its own origin.
/// Safety: every answer carries a strict Content-Security-Policy; a request whose Host is another name is
/// refused (a page that rebinds its name to 127.0.0.1 would read the token otherwise), and so is one that the
/// browser marks as sent by another site.
class PageServer {
 public:
  struct Options {
    HttpEndpoint endpoint;
    /// Names besides the endpoint's own, localhost and 127.0.0.1 under which browsers reach this server:
    /// "robot.local".
    std::vector<std::string> hosts;
    std::filesystem::path pages;
    /// Body of /config.json.
    std::string config_json;
    /// Sources of the policy's connect-src: "ws://127.0.0.1:11000".
    std::vector<std::string> sockets;
    /// Called once per answered request, from the server's threads.
    std::function<void(int status)> on_answer;
  };

  explicit PageServer(Options options);
  ~PageServer();
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;

  /// Binds. @throw std::runtime_error that names the endpoint when the port cannot be had.
  void bind();
  /// The real port, after bind().
  int port() const { return port_; }
  /// What a person opens: "http://127.0.0.1:8770/".
  std::string address() const;
  /// Serves until stop(); call it from a thread of its own after bind().
  void serve();
  void stop();

 private:
  struct Http;

  void addRoutes();
  bool isOwnHost(const std::string& host) const;

  const Options options_;
  int port_ = 0;
  std::atomic<bool> serving_ = false;
  std::atomic<bool> stopping_ = false;
  std::unique_ptr<Http> http_;
};

/// The Content-Security-Policy of every answer; `sockets` as in PageServer::Options.
std::string contentSecurityPolicy(const std::vector<std::string>& sockets);

}  // namespace vismem
