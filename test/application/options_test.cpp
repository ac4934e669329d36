#include "application/app/options.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>
#include <vector>

#include "application/app/out_folder.h"
#include "support/build_paths.h"

namespace vismem {
namespace {

using testing::HasSubstr;

class Options : public testing::Test {
 protected:
  Options() : out_(std::filesystem::path(testing::TempDir()) / ("options_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(out_);
  }
  ~Options() override { std::filesystem::remove_all(out_); }

  std::optional<RunOptions> parse(std::vector<std::string> arguments) const {
    arguments.insert(arguments.begin(), "run_application");
    arguments.insert(arguments.end(), {"--out", (out_ / "run").string()});
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    return parseOptions(static_cast<int>(argv.size()), argv.data());
  }
  std::string failure(const std::vector<std::string>& arguments) const {
    try {
      parse(arguments);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "no failure";
  }

  const std::filesystem::path out_;
};

TEST_F(Options, DefaultToTheCorridor) {
  const auto options = parse({});
  ASSERT_TRUE(options);
  EXPECT_EQ(options->setup, Setup::kSimulation);
  EXPECT_EQ(options->folder, "sim");
  EXPECT_EQ(options->seed, 1u);
  EXPECT_FALSE(options->seconds);
  EXPECT_EQ(options->world.filename(), "corridor.world");
  EXPECT_EQ(options->route.filename(), "corridor.route");
  EXPECT_EQ(options->map.filename(), "corridor.csv");
  EXPECT_EQ(options->palette.filename(), "corridor.palette");
  EXPECT_FALSE(std::filesystem::exists(options->out)) << "nothing is made yet";
}

TEST_F(Options, TakeWorldAndMapOfTheSetup) {
  // A project of its own, with a robot in the room that has a map of its own.
  const std::filesystem::path project = out_ / "project";
  const std::filesystem::path here = std::filesystem::current_path();
  std::filesystem::create_directories(project / "cfg/mine");
  std::ofstream(project / "cfg/mine/simulator.cfg") << "Simulator.World = cfg/worlds/room.world\n";
  std::ofstream(project / "cfg/mine/localization.cfg") << "Localization.Map = cfg/mine/map.csv\n";
  for (const char* folder : {"worlds", "maps"}) {
    std::filesystem::create_directory_symlink(std::filesystem::path(VISMEM_SOURCE_DIR) / "cfg" / folder,
                                              project / "cfg" / folder);
  }
  std::filesystem::current_path(project);
  EXPECT_THAT(failure({"--setup", "mine"}), HasSubstr("cfg/mine/map.csv: no such file"));
  std::ofstream(project / "cfg/mine/map.csv") << "x1_m\n";
  EXPECT_FALSE(parse({"--setup", "mine"})->own_frame);
  std::ofstream(project / "cfg/mine/gui_server.cfg") << "GuiServer.Setup = mine\nGuiServer.Truth = no\n";
  const auto own = parse({"--setup", "mine"});
  const auto other = parse({"--setup", "mine", "--world", "cfg/worlds/curve.world"});
  std::filesystem::current_path(here);
  EXPECT_EQ(own->world.filename(), "room.world");
  EXPECT_EQ(own->route.filename(), "room.route");
  EXPECT_EQ(own->map, std::filesystem::canonical(project / "cfg/mine/map.csv"));
  EXPECT_TRUE(own->own_frame);
  EXPECT_FALSE(other->own_frame) << "not the setup's map";
  EXPECT_EQ(other->world.filename(), "curve.world");
  EXPECT_EQ(other->map.filename(), "curve.csv") << "the setup's map is that of its own world";
}

TEST_F(Options, ReadNumbers) {
  const auto options =
      parse({"--setup", "humanoid", "--seconds", "2.5", "--seed", "77", "--port-offset", "100"});
  EXPECT_EQ(options->folder, "humanoid");
  EXPECT_EQ(options->seconds, 2.5);
  EXPECT_EQ(options->seed, 77u);
  EXPECT_EQ(options->port_offset, 100);
}

TEST_F(Options, NameWhatIsWrong) {
  EXPECT_THAT(failure({"--setup", "car"}),
              HasSubstr("with a simulator or a replay server: humanoid, nao, replay, sim"));
  EXPECT_THAT(failure({"--seconds", "0"}), HasSubstr("--seconds 0 (must be a number above 0)"));
  EXPECT_THAT(failure({"--seconds", "3s"}), HasSubstr("--seconds 3s"));
  EXPECT_THAT(failure({"--seed", "-1"}), HasSubstr("--seed -1 (must be a whole number 0.."));
  EXPECT_THAT(failure({"--port-offset", "60000"}),
              HasSubstr("--port-offset 60000 (must be a whole number 0..50000)"));
  EXPECT_THAT(failure({"--world", "/nowhere.world"}), HasSubstr("--world /nowhere.world: no such file"));
  EXPECT_THAT(failure({"--unknown"}), HasSubstr("(see --help)"));
}

TEST_F(Options, OfOneSetupAreErrorsInAnother) {
  EXPECT_THAT(failure({"--bag", "a.bag"}), HasSubstr("--bag is for a setup with a replay server"));
  EXPECT_THAT(failure({"--setup", "replay"}), HasSubstr("--setup replay needs --bag FILE"));
  const std::string any_file = std::string(VISMEM_SOURCE_DIR) + "/cfg/sim/simulator.cfg";
  EXPECT_THAT(failure({"--setup", "replay", "--bag", any_file}),
              HasSubstr("--setup replay needs --map FILE"));
  EXPECT_THAT(failure({"--setup", "replay", "--world", "a.world"}),
              HasSubstr("--world is for simulated setups"));
}

TEST_F(Options, TakeABagAFolderOrSeveral) {
  const auto bagOf = [this](const std::string& bag) {
    const auto map = (std::filesystem::path(VISMEM_SOURCE_DIR) / "cfg/maps/room.csv").string();
    return parse({"--setup", "replay", "--bag", bag, "--map", map})->bag.string();
  };
  const std::string folder = (out_ / "drive").string();
  std::filesystem::create_directories(folder);
  for (const char* name : {"/a.bag", "/b.bag"}) std::ofstream(folder + name) << "-";
  EXPECT_EQ(bagOf(folder + "/a.bag"), folder + "/a.bag");
  EXPECT_EQ(bagOf(folder + "/"), folder);
  EXPECT_EQ(bagOf(folder + "/b.bag," + folder), folder + "/b.bag," + folder);
  EXPECT_THROW(bagOf(folder + "/a.bag," + folder + "/c.bag"), UsageError);
}

std::string failureOfFolder(const std::filesystem::path& folder) {
  try {
    const OutFolder made(folder);
  } catch (const UsageError& error) {
    return error.what();
  }
  return "no failure";
}

TEST_F(Options, AFileIsNoFolderForResults) {
  std::ofstream(out_ / "run") << "a file";
  EXPECT_THAT(failureOfFolder(out_ / "run"), HasSubstr("--out " + (out_ / "run").string()));
  EXPECT_THAT(failureOfFolder("/proc/run"), HasSubstr("--out /proc/run: cannot make this folder"));
}

TEST_F(Options, AnEmptyFolderOfResultsIsRemovedAndAFullOneStays) {
  const auto folder = out_ / "runs/monday";
  { const OutFolder empty(folder); }
  EXPECT_FALSE(std::filesystem::exists(out_ / "runs"));
  {
    const OutFolder full(folder);
    std::ofstream(folder / "trajectory.tum") << "1\n";
  }
  EXPECT_TRUE(std::filesystem::exists(folder / "trajectory.tum"));
  {
    OutFolder again(folder);
    again.discard();
  }
  EXPECT_TRUE(std::filesystem::exists(folder / "trajectory.tum")) << "of another run";
  {
    OutFolder own(out_ / "own");
    std::ofstream(out_ / "own/part") << "1\n";
    own.discard();
  }
  EXPECT_FALSE(std::filesystem::exists(out_ / "own"));
}

}  // namespace
}  // namespace vismem
