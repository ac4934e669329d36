// The program make_map as a user calls it for a world that cannot be read whole.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "support/build_paths.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string box(const std::string& name, const std::string& pose) {
  return "<model name='" + name + "'><static>1</static><pose>" + pose +
         "</pose><link name='l'><visual name='v'><geometry><box><size>0.5 0.5 0.5</size></box></geometry>"
         "<material><diffuse>0.9 0.9 0.9 1</diffuse></material></visual></link></model>";
}

class MakeMap : public testing::Test {
 protected:
  MakeMap() : folder_(fs::temp_directory_path() / ("make_map_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
    put("p.palette", "class.floor = value 0..30\nclass.box = value 40..100\npair.foot = floor box\n");
  }
  ~MakeMap() override { fs::remove_all(folder_); }

  void put(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  std::string content(const std::string& name) const {
    std::ifstream in(folder_ / name);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  /// A dark floor, a box at its middle, and another one.
  void putWorld(const std::string& pose_of_other) const {
    put("w.world",
        "<sdf version='1.6'><world name='w'><model name='floor'><static>1</static><link name='l'>"
        "<visual name='v'><geometry><plane><normal>0 0 1</normal><size>8 8</size></plane></geometry>"
        "<material><diffuse>0.1 0.1 0.1 1</diffuse></material></visual></link></model>" +
            box("one", "0 0 0.25 0 0 0") + box("other", pose_of_other) + "</world></sdf>");
  }
  int run(const std::string& options) const {
    const std::string folder = folder_.string() + "/";
    const std::string line = std::string(VISMEM_BIN_DIR) + "/make_map " + folder + "w.world --palette " +
                             folder + "p.palette -o " + folder + "map.csv " + options + " > " + folder +
                             "out 2> " + folder + "err";
    const int status = std::system(line.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  fs::path folder_;
};

TEST_F(MakeMap, OfAWholeWorldSaysHowManyVisualsItHas) {
  putWorld("2 0 0.25 0 0 0");
  EXPECT_EQ(run(""), 0) << content("err");
  EXPECT_THAT(content("out"), HasSubstr("\"visuals\":\"3 of 3 visuals\""));
  EXPECT_EQ(content("err"), "");
}

TEST_F(MakeMap, OfAWorldWithAPoseThatCannotBeReadNeedsALeave) {
  putWorld("2 0");
  EXPECT_EQ(run(""), 1);
  EXPECT_THAT(content("err"),
              HasSubstr("<model name=\"other\"> is left out: its <pose> \"2 0\" cannot be read"));
  EXPECT_THAT(content("err"), HasSubstr("2 of 3 visuals, the rest is left out (--allow-partial makes"));
  EXPECT_FALSE(fs::exists(folder_ / "map.csv"));
  EXPECT_EQ(run("--allow-partial"), 0) << content("err");
  EXPECT_THAT(content("out"), HasSubstr("\"visuals\":\"2 of 3 visuals\""));
  EXPECT_TRUE(fs::exists(folder_ / "map.csv"));
}

}  // namespace
}  // namespace vismem
