// Programs find their data from any working directory.
#include <gmock/gmock.h>

#include <filesystem>
#include <map>
#include <memory>

#include "common/process/child_process.h"
#include "support/build_paths.h"
#include "support/temporary_folder.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;

class OtherFolder : public testing::Test {
 protected:
  std::unique_ptr<ChildProcess> start(std::vector<std::string> command) const {
    command[0] = std::string(VISMEM_BIN_DIR) + "/" + command[0];
    ChildProcess::Options options;
    options.working_directory = folder_.path();
    return std::make_unique<ChildProcess>(std::move(command), std::move(options));
  }

  TemporaryFolder folder_;
};

TEST_F(OtherFolder, ComponentsFindWhatTheirConfigurationNames) {
  for (const auto& [name, prefix] :
       std::map<std::string, std::string>{{"simulator", "Simulator"},
                                          {"active_visual_memory", "ActiveVisualMemory"},
                                          {"localization", "Localization"}}) {
    const auto component =
        start({name, std::string("--Ice.Config=" VISMEM_SOURCE_DIR "/cfg/sim/") + name + ".cfg",
               "--" + prefix + ".Endpoints=tcp -h 127.0.0.1 -p 0"});
    EXPECT_TRUE(component->waitForLine(name + " ready: ", 60s)) << component->error();
    component->stop(5s);
  }
}

TEST_F(OtherFolder, ToolsFindTheirDefaults) {
  const auto palette =
      start({"label_palette", VISMEM_SOURCE_DIR "/cfg/files/corridor.jpg", "--out", folder_ / "labels.png"});
  EXPECT_EQ(palette->waitForExit(60s), 0) << palette->error();
  const auto evaluation =
      start({"evaluate", "--world", VISMEM_SOURCE_DIR "/cfg/worlds/corridor.world", "--map",
             VISMEM_SOURCE_DIR "/cfg/maps/corridor.csv", "--seconds", "1", "--out", "here"});
  EXPECT_EQ(evaluation->waitForExit(120s), 0) << evaluation->error();
  EXPECT_TRUE(std::filesystem::exists(folder_.path() / "here/top_view.png"));
}

}  // namespace
}  // namespace vismem
