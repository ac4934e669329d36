// Reading of text files, and escaping of untrusted text.
#include "common/config/text_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "common/config/config_error.h"

namespace vismem {
namespace {

using testing::ElementsAre;

std::vector<std::string> problemsOf(const std::string& file) {
  try {
    readTextFile(file, "a poem");
  } catch (const ConfigError& error) {
    return error.problems();
  }
  return {};
}

TEST(TextFile, IsReadByteForByte) {
  const auto file = std::filesystem::path(testing::TempDir()) / ("text_" + std::to_string(getpid()));
  const std::string content("a\0b\r\n\xff", 6);
  std::ofstream(file, std::ios::binary) << content;
  EXPECT_EQ(readTextFile(file, "a poem"), content);
  std::filesystem::remove(file);
}

TEST(TextFile, SaysWhyItCannotBeRead) {
  EXPECT_THAT(problemsOf("no/poem"),
              ElementsAre("no/poem: cannot be read (No such file or directory; must be a poem)"));
  EXPECT_THAT(problemsOf("."), ElementsAre(".: cannot be read (is a folder; must be a poem)"));
  EXPECT_THAT(problemsOf("/dev/zero"),
              ElementsAre("/dev/zero: cannot be read (more than 64 MB; must be a poem)"));
}

TEST(KindOf, NamesFilesByTheirBeginning) {
  EXPECT_EQ(kindOf("\x89PNG\r\n\x1a\n"), "a PNG image");
  EXPECT_EQ(kindOf("#ROSBAG V2.0\n"), "a ROS bag");
  EXPECT_EQ(kindOf("# a place\n\n x1_m,y1_m,z1_m,x2_m,y2_m,z2_m,label\n"), kMapKind);
  EXPECT_EQ(kindOf("\n# colours\nclass.floor = value 40..80\n"), kPaletteKind);
  EXPECT_EQ(kindOf("# a setup\nLocalization.Seed = 1\n"), kConfigurationKind);
  EXPECT_EQ(kindOf("<?xml version='1.0'?>"), "XML, such as a world or a drawing");
  EXPECT_EQ(kindOf(std::string("\x7f"
                               "ELF\2\1\1\0",
                               8)),
            "a binary file");
  EXPECT_EQ(kindOf("x1,y1,x2,y2,label\n"), "");
  EXPECT_EQ(kindOf("# only\n#comments\n"), "");
}

TEST(Shown, KeepsUtf8AndEscapesTheRest) {
  EXPECT_EQ(shown("Cañas \xf0\x9f\xa4\x96 \"x\""), "Cañas \xf0\x9f\xa4\x96 \"x\"");
  EXPECT_EQ(shown(std::string("a\0b\n\x1b[2J\x7f", 9)), "a\\x00b\\x0a\\x1b[2J\\x7f");
  EXPECT_EQ(shown("caf\xe9"), "caf\\xe9") << "Latin-1";
  EXPECT_EQ(shown("\xc3"), "\\xc3") << "cut";
  EXPECT_EQ(shown("\xc0\xaf"), "\\xc0\\xaf") << "overlong";
  EXPECT_EQ(shown("\xed\xa0\x80"), "\\xed\\xa0\\x80") << "half of a surrogate pair";
  EXPECT_EQ(shown("\xf4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80") << "beyond the last character";
  EXPECT_EQ(shown("\xc2\x9b"), "\\xc2\\x9b") << "a control character of the second set";
}

TEST(Shown, CutsTheMiddleBetweenCharacters) {
  EXPECT_EQ(shown(std::string(20, 'x'), 20), std::string(20, 'x'));
  EXPECT_EQ(shown("0123456789abcdefghij", 9), "012345[... 11 bytes ...]hij");
  std::string umlauts;
  for (int i = 0; i < 50; ++i) umlauts += "ü";
  const std::string cut = shown(umlauts, 11);
  EXPECT_EQ(cut.find('\\'), std::string::npos) << cut;
  EXPECT_EQ(shown(std::string(10'000'000, 'A')).size(),
            1000u + std::string("[... 9999000 bytes ...]").size());
}

TEST(ConfigErrorText, IsShortAndReportsHowMuchIsLeftOut) {
  std::vector<std::string> problems(100, "x.cfg:1: \"\x1b\" (must be y)");
  const ConfigError error(problems);
  EXPECT_EQ(error.problems().size(), 100u);
  EXPECT_EQ(error.problems().front(), "x.cfg:1: \"\\x1b\" (must be y)");
  const std::string text = error.what();
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 20);
  EXPECT_TRUE(text.ends_with("\nand 80 more problems"));
}

}  // namespace
}  // namespace vismem
