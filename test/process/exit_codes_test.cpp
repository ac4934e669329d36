// A wrong command line ends every program of the project with the same code and a message.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/process/child_process.h"
#include "support/build_paths.h"

namespace vismem {
namespace {

class WrongCommandLine : public testing::TestWithParam<std::vector<std::string>> {};

TEST_P(WrongCommandLine, EndsWithCode2AndNamesTheOption) {
  auto command = GetParam();
  command[0] = std::string(VISMEM_BIN_DIR) + "/" + command[0];
  command.push_back("--bogus-option");
  ChildProcess program(command);
  EXPECT_EQ(program.waitForExit(std::chrono::seconds(20)), 2);
  // Of what is missing and what is not known CLI11 names one.
  EXPECT_THAT(program.error(),
              testing::AnyOf(testing::HasSubstr("bogus-option"), testing::HasSubstr("required")));
  EXPECT_EQ(program.out(), "");
}

INSTANTIATE_TEST_SUITE_P(
    Programs, WrongCommandLine,
    testing::Values(std::vector<std::string>{"active_visual_memory"}, std::vector<std::string>{"bag_info"},
                    std::vector<std::string>{"base_server"}, std::vector<std::string>{"camera_server"},
                    std::vector<std::string>{"detect_segments"}, std::vector<std::string>{"evaluate"},
                    std::vector<std::string>{"experiment"}, std::vector<std::string>{"label_palette"},
                    std::vector<std::string>{"localization"}, std::vector<std::string>{"make_map"},
                    std::vector<std::string>{"pantilt_server"}, std::vector<std::string>{"replay_server"},
                    std::vector<std::string>{"run_application"}, std::vector<std::string>{"show_status"},
                    std::vector<std::string>{"simulator"},
                    std::vector<std::string>{"simulator", "--render", "x.world"}),
    [](const auto& which) { return which.param[0] + (which.param.size() > 1 ? "_render" : ""); });

class MissingInput : public testing::TestWithParam<std::vector<std::string>> {};

TEST_P(MissingInput, EndsWithCode2AndNamesTheFile) {
  auto command = GetParam();
  command[0] = std::string(VISMEM_BIN_DIR) + "/" + command[0];
  ChildProcess program(command);
  EXPECT_EQ(program.waitForExit(std::chrono::seconds(20)), 2);
  EXPECT_THAT(program.error(), testing::HasSubstr("/nowhere"));
}

INSTANTIATE_TEST_SUITE_P(
    Programs, MissingInput,
    testing::Values(
        std::vector<std::string>{"bag_info", "/nowhere.bag"},
        std::vector<std::string>{"evaluate", "--bag", "/nowhere.bag", "--map", "m.csv", "--out", "/tmp/x"},
        std::vector<std::string>{"import_log", "/nowhere", "--out", "/tmp/x.bag", "--fov", "60"},
        std::vector<std::string>{"label_palette", "/nowhere.png"},
        std::vector<std::string>{"learn_palette", "--bag", "/nowhere.bag", "--out", "/tmp/x.palette"},
        std::vector<std::string>{"make_map", "/nowhere.world", "--palette", "cfg/maps/room.palette", "-o",
                                 "/tmp/x.csv"},
        std::vector<std::string>{"map_from_drive", "--bag", "/nowhere.bag", "--palette",
                                 "cfg/maps/room.palette", "--out", "/tmp/x"},
        std::vector<std::string>{"update_map", "/nowhere.csv", "/nowhere.changes", "--out", "/tmp/x"}),
    [](const auto& which) { return which.param[0]; });

}  // namespace
}  // namespace vismem
