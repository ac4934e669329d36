#include "gui/server/page_server.h"

#include <httplib.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <fstream>
#include <iterator>
#include <set>
#include <stdexcept>
#include <thread>

namespace vismem {

struct PageServer::Http {
  httplib::Server server;
};

namespace {

/// Browsers refuse scripts and styles of another type.
const char* mimeTypeOf(const std::filesystem::path& file) {
  static constexpr std::array<std::pair<std::string_view, const char*>, 5> kTypes{
      {{".html", "text/html; charset=utf-8"},
       {".js", "text/javascript; charset=utf-8"},
       {".css", "text/css; charset=utf-8"},
       {".svg", "image/svg+xml"},
       {".woff2", "font/woff2"}}};
  for (const auto& [ending, type] : kTypes) {
    if (file.extension() == ending) return type;
  }
  return "application/octet-stream";
}

/// Sends a file as it lies there, read anew for each request: a build shows at the next load. The packed one
/// beside it serves browsers that take gzip.
void sendFile(const std::filesystem::path& file, const httplib::Request& request,
              httplib::Response& response) {
  if (!std::filesystem::is_regular_file(file)) {
    response.status = 404;
    return;
  }
  const std::string packed_file = file.string() + ".gz";
  const bool packed = request.get_header_value("Accept-Encoding").find("gzip") != std::string::npos &&
                      std::filesystem::exists(packed_file);
  std::ifstream stream(packed ? packed_file : file.string(), std::ios::binary);
  const auto content =
      std::make_shared<std::string>(std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>());
  if (packed) response.set_header("Content-Encoding", "gzip");
  response.set_header("Vary", "Accept-Encoding");
  // With a known length: a plain body would be compressed by the library for each request, which takes
  // seconds.
  response.set_content_provider(content->size(), mimeTypeOf(file),
                                [content](size_t offset, size_t length, httplib::DataSink& sink) {
                                  return sink.write(content->data() + offset, length);
                                });
}

}  // namespace

std::string contentSecurityPolicy(const std::vector<std::string>& sockets) {
  std::string connect = "connect-src 'self'";
  for (const auto& source : std::set<std::string>(sockets.begin(), sockets.end())) connect += " " + source;
  return "default-src 'none'; script-src 'self'; style-src 'self'; worker-src 'self'; " + connect +
         "; img-src 'self'; font-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
}

PageServer::PageServer(Options options) : options_(std::move(options)), http_(std::make_unique<Http>()) {
  addRoutes();
}

PageServer::~PageServer() {
  stop();
}

bool PageServer::isOwnHost(const std::string& host) const {
  const auto matches = [&](const std::string& name) {
    return host == name + ":" + std::to_string(port_) || (port_ == 80 && host == name);
  };
  return matches(options_.endpoint.host) || matches("localhost") || matches("127.0.0.1") ||
         std::any_of(options_.hosts.begin(), options_.hosts.end(), matches);
}

void PageServer::addRoutes() {
  auto& server = http_->server;
  // Not the library's default, which lets a second process share the port unnoticed.
  server.set_socket_options([](socket_t socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  server.set_default_headers({{"Content-Security-Policy", contentSecurityPolicy(options_.sockets)},
                              {"X-Content-Type-Options", "nosniff"},
                              {"Referrer-Policy", "no-referrer"},
                              {"Cross-Origin-Resource-Policy", "same-origin"},
                              {"Cross-Origin-Opener-Policy", "same-origin"},
                              // A new build must be seen at the next load; files are small and near.
                              {"Cache-Control", "no-cache"}});
  server.set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
    const auto site = request.get_header_value("Sec-Fetch-Site");
    const bool foreign = site == "cross-site" || site == "same-site";
    // Following a link to the page itself is no harm; asking for its data from elsewhere is.
    const bool data = request.path == "/config.json";
    if (isOwnHost(request.get_header_value("Host")) && !(foreign && data))
      return httplib::Server::HandlerResponse::Unhandled;
    response.status = 403;
    response.set_content("This server answers only its own page.\n", "text/plain");
    return httplib::Server::HandlerResponse::Handled;
  });
  server.Get("/config.json", [this](const httplib::Request&, httplib::Response& response) {
    response.set_content(options_.config_json, "application/json");
  });
  if (std::filesystem::exists(options_.pages / "index.html")) {
    server.Get("/", [this](const httplib::Request& request, httplib::Response& response) {
      sendFile(options_.pages / "index.html", request, response);
    });
    // Names without a leading dot in two folders: nothing leads out of them.
    server.Get(R"(/((?:assets/)?[\w-][\w.-]*))",
               [this](const httplib::Request& request, httplib::Response& response) {
                 sendFile(options_.pages / request.matches[1].str(), request, response);
               });
  } else {
    server.Get("/", [this](const httplib::Request&, httplib::Response& response) {
      response.status = 503;
      response.set_content("The page is not built: " + (options_.pages / "index.html").string() +
                               " is missing. scripts/build makes it (target gui_page).\n",
                           "text/plain");
    });
  }
  server.set_logger([this](const httplib::Request&, const httplib::Response& response) {
    if (options_.on_answer) options_.on_answer(response.status);
  });
}

void PageServer::bind() {
  auto& server = http_->server;
  const auto& [host, port] = options_.endpoint;
  if (port == 0) {
    port_ = server.bind_to_any_port(host);
  } else if (server.bind_to_port(host, port)) {
    port_ = port;
  }
  if (port_ <= 0)
    throw std::runtime_error("GuiServer.Http.Endpoints = http -h " + host + " -p " + std::to_string(port) +
                             " (the address is in use or not of this machine)");
}

std::string PageServer::address() const {
  return pageAddress(options_.endpoint, port_);
}

void PageServer::serve() {
  serving_ = true;
  if (!stopping_) http_->server.listen_after_bind();
  serving_ = false;
}

void PageServer::stop() {
  stopping_ = true;
  // The library ignores a stop that comes before it listens, and would then listen for ever.
  while (serving_ && !http_->server.is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  http_->server.stop();
}

}  // namespace vismem
