// Maps in the making beside the drive. Tests B6, C3.
#include "mapper/app/map_builder.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>

#include "support/build_paths.h"
#include "support/eventually.h"
#include "support/temporary_folder.h"
#include "synthetic_drive.h"

namespace vismem {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

RecordedDrive halfRing() {
  RecordedDrive drive;
  drive.record = vismem::drive(ringOfCorridors(), ringWay(12.0), {}).record;
  drive.palette_file = VISMEM_SOURCE_DIR "/cfg/maps/corridor.palette";
  return drive;
}

class MapBuilderTest : public testing::Test {
 protected:
  MapFilesOptions into(const std::string& folder) {
    MapFilesOptions files;
    files.out = folder_ / folder;
    return files;
  }
  BuiltMap built(int number) {
    EXPECT_TRUE(eventually([&] { return builder_.status().built == number; }));
    return builder_.status().last;
  }

  TemporaryFolder folder_;
  int announced_ = 0;
  MapBuilder builder_{[this](const BuiltMap&) { ++announced_; }};
};

TEST_F(MapBuilderTest, MakesOneMapAtATime) {
  ASSERT_TRUE(builder_.build(halfRing(), into("maps")).ok());
  EXPECT_THAT(builder_.build(halfRing(), into("others")).message, HasSubstr("another map"));
  const BuiltMap map = built(1);
  EXPECT_THAT(map.problems, IsEmpty());
  EXPECT_TRUE(std::filesystem::exists(map.file));
  EXPECT_GT(map.edges, 10);
  EXPECT_NEAR(map.way_m, 12.0, 0.3);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "others"));
  ASSERT_TRUE(builder_.build(halfRing(), into("others")).ok());
  EXPECT_EQ(built(2).edges, map.edges);
  EXPECT_EQ(announced_, 2);
}

TEST_F(MapBuilderTest, AFolderThatCannotBeMadeIsAProblemOfTheMapAlone) {
  std::ofstream(folder_ / "file") << "in the way\n";
  ASSERT_TRUE(builder_.build(halfRing(), into("file/maps")).ok());
  const BuiltMap map = built(1);
  EXPECT_THAT(map.problems, ElementsAre(HasSubstr("file")));
  EXPECT_TRUE(map.file.empty());
  ASSERT_TRUE(builder_.build(halfRing(), into("maps")).ok());
  EXPECT_THAT(built(2).problems, IsEmpty());
}

TEST_F(MapBuilderTest, ADriveThatShowedNothingSaysSo) {
  RecordedDrive nothing;
  nothing.palette_file = VISMEM_SOURCE_DIR "/cfg/maps/corridor.palette";
  ASSERT_TRUE(builder_.build(nothing, into("maps")).ok());
  EXPECT_THAT(built(1).problems, testing::Contains(HasSubstr("no edge on the floor was confirmed")));
}

}  // namespace
}  // namespace vismem
