// Every component against wrong configurations: exact messages and exit codes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>

#include "broken_config/cases.h"
#include "common/process/child_process.h"
#include "support/component_process.h"

namespace vismem::test {
namespace {

namespace fs = std::filesystem;

constexpr const char* kMap = "x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,label\n0,0,0,4,0,0,skirting\n";
constexpr const char* kPalette = "class.floor = 0..360 0..30 40..80\n";
constexpr const char* kWorld =
    "<?xml version='1.0'?>\n<sdf version='1.6'><world name='w'><model name='box'><static>true</static>"
    "<pose>3 0 0.5 0 0 0</pose><link name='l'><collision name='c'><geometry><box><size>1 1 1</size></box>"
    "</geometry></collision><visual name='v'><geometry><box><size>1 1 1</size></box></geometry></visual>"
    "</link></model></world></sdf>\n";

using Setting = std::pair<std::string, std::string>;

/// The smallest configuration with which each component would start.
std::vector<Setting> validConfiguration(const std::string& component) {
  static const std::map<std::string, std::vector<Setting>> valid = {
      {"localization",
       {{"Localization.Endpoints", "tcp -h 127.0.0.1 -p 0"},
        {"Localization.VisualMemory.Proxy", "VisualMemory:tcp -h 127.0.0.1 -p 1"},
        {"Localization.Map", "map.csv"}}},
      {"active_visual_memory",
       {{"ActiveVisualMemory.Endpoints", "tcp -h 127.0.0.1 -p 0"},
        {"ActiveVisualMemory.Camera.Proxy", "cameraA:tcp -h 127.0.0.1 -p 1"},
        {"ActiveVisualMemory.Odometry.Proxy", "Encoders:tcp -h 127.0.0.1 -p 1"}}},
      {"camera_server",
       {{"CameraServer.Endpoints", "tcp -h 127.0.0.1 -p 0"},
        {"CameraServer.Camera.cameraA.Driver", "pattern"}}},
      {"pantilt_server",
       {{"PanTiltServer.Endpoints", "tcp -h 127.0.0.1 -p 0"}, {"PanTiltServer.Driver", "simulated"}}},
      {"base_server",
       {{"BaseServer.Endpoints", "tcp -h 127.0.0.1 -p 0"}, {"BaseServer.Driver", "simulated"}}},
      {"gui_server", {{"GuiServer.Endpoints", "tcp -h 127.0.0.1 -p 0"}}},
      {"simulator", {{"Simulator.Endpoints", "tcp -h 127.0.0.1 -p 0"}, {"Simulator.World", "world.sdf"}}},
      {"replay_server",
       {{"ReplayServer.Endpoints", "tcp -h 127.0.0.1 -p 0"}, {"ReplayServer.File", "log.bag"}}},
  };
  return valid.at(component);
}

/// A folder of its own for each case, gone afterwards.
class Folder {
 public:
  explicit Folder(const std::string& name)
      : path_(fs::path(testing::TempDir()) / ("broken_" + std::to_string(getpid()) + "_" + name)) {
    fs::remove_all(path_);
    fs::create_directories(path_);
  }
  ~Folder() { fs::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  void write(const std::string& name, const std::string& content) const {
    std::ofstream(path_ / name, std::ios::binary) << content;
  }
  const fs::path& path() const { return path_; }

 private:
  const fs::path path_;
};

/// A port of the loopback with a listener.
class PortInUse {
 public:
  PortInUse() : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    if (::bind(socket_, reinterpret_cast<sockaddr*>(&address), size) != 0 || ::listen(socket_, 1) != 0 ||
        ::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &size) != 0) {
      throw std::runtime_error("no port for the test");
    }
    number_ = std::to_string(ntohs(address.sin_port));
  }
  ~PortInUse() { ::close(socket_); }
  PortInUse(const PortInUse&) = delete;
  PortInUse& operator=(const PortInUse&) = delete;
  const std::string& number() const { return number_; }

 private:
  int socket_;
  std::string number_;
};

void replaceAll(std::string& text, const std::string& what, const std::string& by) {
  for (auto place = text.find(what); place != std::string::npos; place = text.find(what, place + by.size())) {
    text.replace(place, what.size(), by);
  }
}

std::string configurationOf(const BrokenConfig& broken) {
  if (!broken.whole.empty()) return broken.whole;
  std::string text;
  for (const auto& line : broken.lines) text += line + "\n";
  for (const auto& [key, value] : validConfiguration(broken.component)) {
    const auto named = [&key = key](const std::string& line) { return line.starts_with(key + " ="); };
    if (std::any_of(broken.lines.begin(), broken.lines.end(), named)) continue;
    if (std::find(broken.without.begin(), broken.without.end(), key) != broken.without.end()) continue;
    text += key + " = " + value + "\n";
  }
  return text;
}

/// The lines of a log that are errors, without stamp and name; all lines of a configuration's error.
std::vector<std::string> messagesIn(const std::string& text, int exit_code) {
  std::vector<std::string> messages;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const auto error = line.find(" ERROR ");
    const bool is_log =
        line.find(" INFO ") != std::string::npos || line.find(" WARNING ") != std::string::npos;
    if (exit_code == 2 && !is_log) {
      messages.push_back(line);
    } else if (error != std::string::npos) {
      messages.push_back(line.substr(error + std::string(" ERROR ").size()));
    }
  }
  return messages;
}

class BrokenConfigTest : public testing::TestWithParam<BrokenConfig> {};

TEST_P(BrokenConfigTest, EndsWithItsMessage) {
  const BrokenConfig& broken = GetParam();
  const Folder folder(broken.name);
  const PortInUse taken;
  folder.write("map.csv", kMap);
  folder.write("map.palette", kPalette);
  folder.write("world.sdf", kWorld);
  for (const auto& file : broken.files) folder.write(file.name, file.content);
  std::string text = configurationOf(broken);
  replaceAll(text, "PORT", taken.number());
  folder.write("broken.cfg", text);

  ChildProcess::Options options;
  options.working_directory = folder.path();
  const auto arguments =
      broken.arguments.empty() ? std::vector<std::string>{"--Ice.Config=broken.cfg"} : broken.arguments;
  const ComponentProcess process(broken.component, arguments, options);
  EXPECT_EQ(process.waitForExit(kPatience), broken.exit_code) << process.out() << process.error();

  std::string error = process.error();
  EXPECT_LT(error.size(), 20'000u) << "a message is for people, whatever it is about";
  replaceAll(error, folder.path().string(), "HERE");
  replaceAll(error, taken.number(), "PORT");
  EXPECT_EQ(messagesIn(error, broken.exit_code), broken.expected);
  EXPECT_EQ(process.out(), "");
}

std::string nameOf(const testing::TestParamInfo<BrokenConfig>& info) {
  return info.param.name;
}

INSTANTIATE_TEST_SUITE_P(FilesAndLines, BrokenConfigTest, testing::ValuesIn(filesAndLines()), nameOf);
INSTANTIATE_TEST_SUITE_P(ValuesOfKeys, BrokenConfigTest, testing::ValuesIn(valuesOfKeys()), nameOf);
INSTANTIATE_TEST_SUITE_P(ProxiesAndEndpoints, BrokenConfigTest, testing::ValuesIn(proxiesAndEndpoints()),
                         nameOf);
INSTANTIATE_TEST_SUITE_P(MapsAndPalettes, BrokenConfigTest, testing::ValuesIn(mapsAndPalettes()), nameOf);
INSTANTIATE_TEST_SUITE_P(Worlds, BrokenConfigTest, testing::ValuesIn(worlds()), nameOf);
INSTANTIATE_TEST_SUITE_P(Recordings, BrokenConfigTest, testing::ValuesIn(recordings()), nameOf);
INSTANTIATE_TEST_SUITE_P(Servers, BrokenConfigTest, testing::ValuesIn(servers()), nameOf);

}  // namespace
}  // namespace vismem::test
