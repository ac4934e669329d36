#include "evaluation/report/run_files.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <fstream>
#include <sstream>

#include "support/temporary_folder.h"
#include "support/tum.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string contents(const fs::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

long lines(const fs::path& file) {
  const std::string text = contents(file);
  return std::count(text.begin(), text.end(), '\n');
}

MemorySnapshot memoryAt(double seconds) {
  MemorySnapshot memory;
  memory.stamp_us = toStampUs(seconds);
  memory.segments.resize(2);
  return memory;
}

TEST(RunFiles, AreWrittenAsTheyCome) {
  const TemporaryFolder folder;
  RunFiles files(folder.path() / "new");
  EXPECT_TRUE(fs::exists(folder.path() / "new/trajectory.tum")) << "checked at the start";
  EXPECT_FALSE(fs::exists(folder.path() / "new/truth.tum")) << "no truth";
  for (int i = 0; i <= 30; ++i) {
    files.addOdometry({i * 100'000, {0.1 * i, 0.0, 0.0}});
    PoseEstimate estimate;
    estimate.stamp_us = i * 100'000;
    estimate.races.resize(1);
    files.addEstimate(estimate);
  }
  // Stamps 0 to 3 s: all of the first two seconds is on the disk while the run goes on.
  EXPECT_GE(lines(folder.path() / "new/odometry.tum"), 1 + 20);
  EXPECT_GE(lines(folder.path() / "new/races.csv"), 1 + 20);
  files.finish(nullptr);
  EXPECT_EQ(lines(folder.path() / "new/odometry.tum"), 1 + 31);
  EXPECT_THAT(files.problems(), testing::IsEmpty());
}

TEST(RunFiles, KeepTheLastMemoryOrThatOfEachSecond) {
  for (const bool snapshots : {false, true}) {
    const TemporaryFolder folder;
    RunFiles files(folder.path(), snapshots);
    for (int i = 0; i <= 25; ++i) files.addMemory(memoryAt(0.1 * i));
    const MemorySnapshot last = memoryAt(2.5);
    files.finish(&last);
    // Snapshots at 0, 1, 2 and 2.5 s; two segments each.
    EXPECT_EQ(lines(folder.path() / "memory.csv"), snapshots ? 1 + 8 : 1 + 2);
  }
}

TEST(RunFiles, LeaveOutWhatIsNotNewer) {
  const TemporaryFolder folder;
  RunFiles files(folder.path());
  for (const StampUs stamp_us : {0, 200'000, 100'000, 200'000, 300'000}) files.addPose({stamp_us, {}});
  files.finish(nullptr);
  EXPECT_EQ(readTum(contents(folder.path() / "trajectory.tum")).size(), 3u);
}

TEST(RunFiles, AFullDiskStopsOneFileAndIsNamed) {
  const TemporaryFolder folder;
  RunFiles files(folder.path());
  // A device without room in place of a file; the truth comes first when the file is made.
  fs::create_symlink("/dev/full", folder.path() / "truth.tum");
  files.addTruth({0, {}});
  files.addOdometry({0, {}});
  files.finish(nullptr);
  EXPECT_THAT(files.problems(), testing::ElementsAre(HasSubstr("truth.tum: No space left on device")));
  EXPECT_EQ(lines(folder.path() / "odometry.tum"), 1 + 1);
}

TEST(RunFiles, NameAFolderThatCannotBeWrittenAtTheStart) {
  EXPECT_THAT([] { RunFiles("/proc/results"); }, testing::ThrowsMessage<std::runtime_error>(
                                                     HasSubstr("/proc/results: cannot make this folder")));
  const TemporaryFolder folder;
  fs::create_directories(folder.path() / "races.csv");
  EXPECT_THAT([&] { RunFiles files(folder.path()); },
              testing::ThrowsMessage<std::runtime_error>(HasSubstr("races.csv: Is a directory")));
}

}  // namespace
}  // namespace vismem
