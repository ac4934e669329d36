// The programs detect_segments and label_palette as a user calls them (DESIGN 11).
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "vision/support/synthetic.h"

namespace vismem {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

class Tools : public testing::Test {
 protected:
  Tools() : folder_(fs::temp_directory_path() / ("vismem_tools_" + std::to_string(getpid()))) {
    fs::create_directories(folder_);
    cv::Mat image(480, 640, CV_8UC3, cv::Scalar::all(60));
    fillQuad(image, squareAt({319.5, 239.5}, 200, 0), cv::Scalar::all(150));
    cv::imwrite((folder_ / "square.png").string(), image);
    std::ofstream(folder_ / "broken.png") << "not an image";
  }
  ~Tools() override { fs::remove_all(folder_); }

  /// Exit code; what it wrote is in out() and errors().
  int run(const std::string& command) {
    const std::string line = std::string(VISMEM_BIN_DIR) + "/" + command + " > " +
                             (folder_ / "out").string() + " 2> " + (folder_ / "err").string();
    const int status = std::system(line.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }
  std::string file(const std::string& name) const { return (folder_ / name).string(); }
  std::string content(const std::string& name) const {
    std::ifstream in(folder_ / name);
    std::stringstream text;
    text << in.rdbuf();
    return text.str();
  }

  fs::path folder_;
};

TEST_F(Tools, DetectSegmentsWritesTheContractedCsvAtTheEvaluatedSize) {
  ASSERT_EQ(run("detect_segments --size 320x240 --csv " + file("s.csv") + " " + file("square.png")), 0)
      << content("err");
  std::istringstream csv(content("s.csv"));
  std::string line;
  std::getline(csv, line);
  EXPECT_EQ(line, "image,x1_px,y1_px,x2_px,y2_px,label,strength");
  int rows = 0;
  while (std::getline(csv, line)) {
    ++rows;
    std::istringstream cells(line.substr(file("square.png").size() + 1));
    double x1 = 0, y1 = 0, x2 = 0, y2 = 0;
    char comma = 0;
    cells >> x1 >> comma >> y1 >> comma >> x2 >> comma >> y2;
    // The middle of 640x480 at (319.5, 239.5) is that of 320x240 at (159.5, 119.5); sides 50 px away.
    const bool upright = std::abs(x1 - x2) < std::abs(y1 - y2);
    EXPECT_NEAR(upright ? std::abs(x1 - 159.5) : std::abs(y1 - 119.5), 50.0, 0.15) << line;
    EXPECT_THAT(line, HasSubstr(",unknown,"));
  }
  EXPECT_EQ(rows, 4);
  EXPECT_THAT(content("out"), HasSubstr("\"segments\": 4"));
}

TEST_F(Tools, DetectSegmentsNamesWhatItCannotReadAndDoesTheOthers) {
  EXPECT_EQ(run("detect_segments --csv " + file("s.csv") + " " + file("broken.png") + " " + file("none.png") +
                " " + file("square.png")),
            1);
  EXPECT_THAT(content("err"), HasSubstr(file("broken.png") + ": not an image that can be read"));
  EXPECT_THAT(content("err"), HasSubstr(file("none.png") + ": not an image that can be read"));
  EXPECT_THAT(content("s.csv"), HasSubstr("square.png,"));
}

TEST_F(Tools, DetectSegmentsDrawsAndFilters) {
  ASSERT_EQ(run("detect_segments --detector hough --min-length 1000 --csv " + file("s.csv") + " --overlay " +
                file("pictures") + " " + file("square.png")),
            0)
      << content("err");
  EXPECT_EQ(content("s.csv"), "image,x1_px,y1_px,x2_px,y2_px,label,strength\n");
  EXPECT_FALSE(cv::imread(file("pictures/square.png")).empty());
}

TEST_F(Tools, DetectSegmentsRefusesBadOptions) {
  EXPECT_NE(run("detect_segments --size 320 " + file("square.png")), 0);
  EXPECT_THAT(content("err"), HasSubstr("--size 320 (must be WxH, for example 320x240)"));
  EXPECT_NE(run("detect_segments --detector lsd " + file("square.png")), 0);
  EXPECT_NE(run("detect_segments --csv /nowhere/s.csv " + file("square.png")), 0);
  EXPECT_THAT(content("err"), HasSubstr("/nowhere/s.csv: cannot be written"));
}

TEST_F(Tools, LabelPaletteDrawsClassesAndReportsABadPalette) {
  const std::string palette = (fs::path(VISMEM_SOURCE_DIR) / "cfg/maps/field.palette").string();
  ASSERT_EQ(run("label_palette " + file("square.png") + " --palette " + palette + " --out " + file("l.png")),
            0)
      << content("err");
  EXPECT_FALSE(cv::imread(file("l.png")).empty());
  EXPECT_THAT(content("out"), HasSubstr("\"unknown\": 4"));

  std::ofstream(folder_ / "bad.palette") << "class.x = value 0..300\n";
  EXPECT_EQ(run("label_palette " + file("square.png") + " --palette " + file("bad.palette") + " --out " +
                file("m.png")),
            1);
  EXPECT_THAT(content("err"),
              HasSubstr("bad.palette:1: class.x = value 0..300 (must be within 0..100 per cent)"));
  EXPECT_FALSE(fs::exists(folder_ / "m.png"));
}

}  // namespace
}  // namespace vismem
