// The page's server: addresses, the policy of its answers, and who may read what.
#include <gmock/gmock.h>
#include <httplib.h>

#include <filesystem>
#include <fstream>
#include <thread>

#include "gui/server/http_endpoint.h"
#include "gui/server/page_server.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

TEST(HttpEndpoint, IsReadInTheFormOfAnIceEndpoint) {
  const auto endpoint = parseHttpEndpoint(" http  -h 127.0.0.1 -p 8770 ");
  ASSERT_TRUE(endpoint);
  EXPECT_EQ(endpoint->host, "127.0.0.1");
  EXPECT_EQ(endpoint->port, 8770);
  for (const auto* wrong :
       {"", "tcp -h 127.0.0.1 -p 8770", "http -p 8770", "http -h a -p 65536", "http -h a -p 1 -x"})
    EXPECT_FALSE(parseHttpEndpoint(wrong)) << wrong;
}

TEST(HttpEndpoint, AddressOfAnEndpointForAllIsThatOfThisMachine) {
  EXPECT_EQ(pageAddress({"127.0.0.1", 0}, 8770), "http://127.0.0.1:8770/");
  EXPECT_EQ(pageAddress({"0.0.0.0", 8770}, 8770), "http://localhost:8770/");
}

TEST(WebSocketSource, IsThatOfTheFirstWebSocketEndpoint) {
  EXPECT_EQ(webSocketSource("cameraA:tcp -h 127.0.0.1 -p 9999:ws -h 127.0.0.1 -p 11000"),
            "ws://127.0.0.1:11000");
  EXPECT_EQ(webSocketSource("cameraA -t:wss -p 7 -h robot.local"), "wss://robot.local:7");
  EXPECT_EQ(webSocketSource("cameraA:tcp -h 127.0.0.1 -p 9999"), std::nullopt);
  EXPECT_EQ(webSocketSource("cameraA:ws -h 127.0.0.1"), std::nullopt);
}

TEST(FaceProxy, HasTheCategoryAndTheNameOfAFace) {
  EXPECT_EQ(faceProxy("cameraA:ws -h 127.0.0.1 -p 11000", {}, "robot.T"),
            "robot.T/cameraA:ws -h 127.0.0.1 -p 11000");
  EXPECT_EQ(faceProxy("simulator/component:ws -h a -p 1", {}, "robot.T"),
            "robot.T/simulator.component:ws -h a -p 1");
  RobotKeys robot7;
  robot7.name = "robot7";
  EXPECT_EQ(faceProxy("robot7/cameraA:ws -h a -p 1", robot7, "robot7.T"), "robot7.T/cameraA:ws -h a -p 1");
  EXPECT_EQ(faceProxy("robot7.component/simulator:ws -h a -p 1", robot7, "robot7.T"),
            "robot7.T/simulator.component:ws -h a -p 1");
}

TEST(OwnProxy, HasTheRobotsNameOnce) {
  RobotKeys robot7;
  robot7.name = "robot7";
  for (const char* proxy : {"cameraA:tcp -h a -p 1", "robot7/cameraA:tcp -h a -p 1"})
    EXPECT_EQ(ownProxy(proxy, robot7), "robot7/cameraA:tcp -h a -p 1");
  EXPECT_EQ(ownProxy("simulator/component:tcp -p 1", robot7), "robot7.component/simulator:tcp -p 1");
  EXPECT_EQ(ownProxy("simulator/component:tcp -p 1", {}), "simulator/component:tcp -p 1");
}

TEST(Policy, AllowsOwnFilesAndTheNamedSocketsOnly) {
  const auto policy = contentSecurityPolicy({"ws://127.0.0.1:2", "ws://127.0.0.1:1", "ws://127.0.0.1:2"});
  EXPECT_THAT(policy, testing::HasSubstr("default-src 'none'; script-src 'self';"));
  EXPECT_THAT(policy, testing::HasSubstr(
                          "worker-src 'self'; connect-src 'self' ws://127.0.0.1:1 ws://127.0.0.1:2; "));
  EXPECT_THAT(policy, testing::Not(testing::HasSubstr("blob:")));
  EXPECT_THAT(policy, testing::Not(testing::HasSubstr("unsafe")));
}

class Pages : public testing::Test {
 protected:
  void SetUp() override {
    std::ofstream(folder_.path() / "index.html") << "<title>page</title>";
    PageServer::Options options;
    options.endpoint = {"127.0.0.1", 0};
    options.hosts = {"robot.local"};
    options.pages = folder_.path();
    options.config_json = R"({"token":"secret"})";
    options.sockets = {"ws://127.0.0.1:11000"};
    server_ = std::make_unique<PageServer>(options);
    server_->bind();
    thread_ = std::jthread([this] { server_->serve(); });
    client_ = std::make_unique<httplib::Client>("127.0.0.1", server_->port());
  }
  void TearDown() override {
    client_.reset();
    server_->stop();
  }
  std::string host(const std::string& name) const { return name + ":" + std::to_string(server_->port()); }

  TemporaryFolder folder_;
  std::unique_ptr<PageServer> server_;
  std::jthread thread_;
  std::unique_ptr<httplib::Client> client_;
};

TEST_F(Pages, ServesFilesAndItsConfigurationWithThePolicy) {
  for (const auto* path : {"/", "/config.json"}) {
    const auto answer = client_->Get(path);
    ASSERT_TRUE(answer) << path;
    EXPECT_EQ(answer->status, 200) << path;
    EXPECT_THAT(answer->get_header_value("Content-Security-Policy"),
                testing::HasSubstr("ws://127.0.0.1:11000"));
    EXPECT_EQ(answer->get_header_value("X-Content-Type-Options"), "nosniff");
    EXPECT_FALSE(answer->has_header("Access-Control-Allow-Origin"));
  }
  EXPECT_EQ(client_->Get("/none.html")->status, 404);
  EXPECT_EQ(client_->Get("/../gui_server.cfg")->status, 404);
}

TEST_F(Pages, SendsFilesAsTheyLieThereAndThePackedOneToWhomTakesIt) {
  std::filesystem::create_directory(folder_ / "assets");
  const std::string text(1'500'000, 'x');
  std::ofstream(folder_ / "assets/page-1.js") << text;
  client_->set_decompress(false);
  const httplib::Headers browser{{"Host", host("127.0.0.1")}, {"Accept-Encoding", "gzip, deflate, br"}};
  const auto plain = client_->Get("/assets/page-1.js", browser);
  ASSERT_TRUE(plain);
  EXPECT_EQ(plain->get_header_value("Content-Type"), "text/javascript; charset=utf-8");
  EXPECT_EQ(plain->get_header_value("Content-Encoding"), "") << "packing it for each request takes seconds";
  EXPECT_EQ(plain->body, text);
  std::ofstream(folder_ / "assets/page-1.js.gz") << "packed";
  const auto packed = client_->Get("/assets/page-1.js", browser);
  EXPECT_EQ(packed->get_header_value("Content-Encoding"), "gzip");
  EXPECT_EQ(packed->body, "packed");
  EXPECT_EQ(client_->Get("/assets/page-1.js", {{"Host", host("127.0.0.1")}})->body, text);
  EXPECT_EQ(client_->Get("/assets", browser)->status, 404);
  EXPECT_EQ(client_->Get("/assets/..", browser)->status, 404);
}

TEST_F(Pages, AnswersOnlyItsOwnNames) {
  for (const auto* name : {"127.0.0.1", "localhost", "robot.local"})
    EXPECT_EQ(client_->Get("/config.json", {{"Host", host(name)}})->status, 200) << name;
  for (const auto& wrong : {host("evil.example"), std::string("127.0.0.1:1"), std::string("robot.local")})
    EXPECT_EQ(client_->Get("/config.json", {{"Host", wrong}})->status, 403) << wrong;
}

TEST_F(Pages, GivesItsConfigurationToNoOtherSite) {
  EXPECT_EQ(
      client_->Get("/config.json", {{"Host", host("127.0.0.1")}, {"Sec-Fetch-Site", "cross-site"}})->status,
      403);
  EXPECT_EQ(
      client_->Get("/config.json", {{"Host", host("127.0.0.1")}, {"Sec-Fetch-Site", "same-site"}})->status,
      403);
  EXPECT_EQ(
      client_->Get("/config.json", {{"Host", host("127.0.0.1")}, {"Sec-Fetch-Site", "same-origin"}})->status,
      200);
  // A link from elsewhere may lead to the page.
  EXPECT_EQ(client_->Get("/", {{"Host", host("127.0.0.1")}, {"Sec-Fetch-Site", "cross-site"}})->status, 200);
}

TEST_F(Pages, NamesThePortThatIsInUse) {
  PageServer::Options options;
  options.endpoint = {"127.0.0.1", server_->port()};
  options.pages = folder_.path();
  PageServer second(options);
  EXPECT_THAT([&] { second.bind(); },
              testing::ThrowsMessage<std::runtime_error>(testing::HasSubstr(
                  "GuiServer.Http.Endpoints = http -h 127.0.0.1 -p " + std::to_string(server_->port()))));
}

TEST(PageServer, StopsThoughItWasAskedToBeforeItListened) {
  TemporaryFolder folder;
  for (int i = 0; i < 20; ++i) {
    PageServer::Options options;
    options.endpoint = {"127.0.0.1", 0};
    options.pages = folder.path();
    PageServer server(options);
    server.bind();
    const std::jthread thread([&] { server.serve(); });
    server.stop();
  }
}

TEST(PagesThatAreNotBuilt, SayWhatIsMissing) {
  TemporaryFolder folder;
  PageServer::Options options;
  options.endpoint = {"127.0.0.1", 0};
  options.pages = folder.path();
  PageServer server(options);
  server.bind();
  std::jthread thread([&] { server.serve(); });
  httplib::Client client("127.0.0.1", server.port());
  const auto answer = client.Get("/");
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->status, 503);
  EXPECT_THAT(answer->body, testing::HasSubstr("index.html is missing"));
  server.stop();
}

}  // namespace
}  // namespace vismem
