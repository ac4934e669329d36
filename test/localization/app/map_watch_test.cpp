// Tests C3: a map's files are read again when they have changed, and not while they are written.
#include "localization/app/map_watch.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <string>

namespace vismem {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

class MapWatchTest : public testing::Test {
 protected:
  MapWatchTest() : file_(fs::path(testing::TempDir()) / ("watched_" + std::to_string(getpid()) + ".csv")) {
    write("one");
  }
  ~MapWatchTest() override { fs::remove(file_); }
  void write(const std::string& text) { std::ofstream(file_) << text; }

  const fs::path file_;
  const MapWatch::Clock::time_point start_{};
};

TEST_F(MapWatchTest, ReportsAChangeOnceAndWhenItHasSettled) {
  MapWatch watch({file_, {}});
  EXPECT_FALSE(watch.hasChanged(start_));
  write("another length");
  EXPECT_FALSE(watch.hasChanged(start_ + 1s));  // just seen: it may go on
  write("yet another length");
  EXPECT_FALSE(watch.hasChanged(start_ + 2s));
  EXPECT_TRUE(watch.hasChanged(start_ + 3s));
  EXPECT_FALSE(watch.hasChanged(start_ + 4s));
}

TEST_F(MapWatchTest, LooksAtMostOncePerSecond) {
  MapWatch watch({file_});
  EXPECT_FALSE(watch.hasChanged(start_));
  write("another length");
  EXPECT_FALSE(watch.hasChanged(start_ + 500ms));
  EXPECT_FALSE(watch.hasChanged(start_ + 1s));
  EXPECT_FALSE(watch.hasChanged(start_ + 1500ms));
  EXPECT_TRUE(watch.hasChanged(start_ + 2s));
}

TEST_F(MapWatchTest, AFileThatVanishesHasChanged) {
  MapWatch watch({file_});
  fs::remove(file_);
  EXPECT_FALSE(watch.hasChanged(start_));
  EXPECT_TRUE(watch.hasChanged(start_ + 1s));
}

}  // namespace
}  // namespace vismem
