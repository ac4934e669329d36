// The programs detect_segments and label_palette as a user calls them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "support/build_paths.h"
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
  EXPECT_THAT(content("err"), HasSubstr(file("none.png") + ": cannot be opened (No such file or directory)"));
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

// The overlay is the image, magnified by a whole factor up to 1000 px, with red lines where the CSV says.
TEST_F(Tools, DetectSegmentsDrawsWhereTheSegmentsAre) {
  ASSERT_EQ(run("detect_segments --overlay " + file("pictures") + " --csv " + file("s.csv") + " " +
                file("square.png")),
            0)
      << content("err");
  const cv::Mat picture = cv::imread(file("pictures/square.png"));
  ASSERT_EQ(picture.size(), cv::Size(640, 480));
  const auto red = [&](int x, int y) {
    const auto& p = picture.at<cv::Vec3b>(y, x);
    return p[2] > 120 && p[0] < 90;
  };
  // Sides 100 px from the middle (319.5, 239.5): between two pixels, so at least one of them is red.
  EXPECT_TRUE(red(219, 210) || red(220, 210));
  EXPECT_TRUE(red(419, 210) || red(420, 210));
  EXPECT_TRUE(red(290, 139) || red(290, 140));
  EXPECT_FALSE(red(300, 220));
}

TEST_F(Tools, DetectSegmentsKeepsPicturesOfOneNameApart) {
  fs::create_directories(folder_ / "a");
  fs::copy(folder_ / "square.png", folder_ / "a" / "square.png");
  ASSERT_EQ(run("detect_segments --overlay " + file("pictures") + " " + file("square.png") + " " +
                file("a/square.png")),
            0);
  EXPECT_TRUE(fs::exists(folder_ / "pictures/square.png"));
  EXPECT_TRUE(fs::exists(folder_ / "pictures/square_2.png"));
}

// Without --csv and --overlay the CSV is all there is on standard output, the JSON line goes beside it.
TEST_F(Tools, DetectSegmentsWritesCsvToStandardOutputAndJsonBeside) {
  ASSERT_EQ(run("detect_segments --min-length 150 " + file("square.png")), 0);
  std::istringstream out(content("out"));
  std::string line;
  int lines = 0;
  while (std::getline(out, line)) ++lines;
  EXPECT_EQ(lines, 1 + 4);
  EXPECT_THAT(content("err"), HasSubstr("\"segments\": 4"));
  ASSERT_EQ(run("detect_segments --min-length 250 " + file("square.png")), 0);
  EXPECT_THAT(content("err"), HasSubstr("\"segments\": 0"));
}

// Reads what OpenCV reads: gray, 16 bits, transparency, other formats; and names with commas and quotes.
TEST_F(Tools, DetectSegmentsReadsManyKindsOfFiles) {
  const cv::Mat color = cv::imread(file("square.png"));
  cv::Mat gray;
  cv::cvtColor(color, gray, cv::COLOR_BGR2GRAY);
  cv::Mat deep;
  gray.convertTo(deep, CV_16U, 257.0);
  cv::Mat transparent;
  cv::cvtColor(color, transparent, cv::COLOR_BGR2BGRA);
  cv::imwrite(file("gray.png"), gray);
  cv::imwrite(file("deep.png"), deep);
  cv::imwrite(file("transparent.png"), transparent);
  cv::imwrite(file("photo.jpg"), color, {cv::IMWRITE_JPEG_QUALITY, 100});
  cv::imwrite(file("map.pgm"), gray);
  cv::imwrite(file("small.png"), cv::Mat(9, 9, CV_8UC1, cv::Scalar(3)));
  fs::copy(folder_ / "gray.png", folder_ / "a,b\"c.png");
  for (const char* name : {"gray.png", "deep.png", "transparent.png", "photo.jpg", "map.pgm"}) {
    ASSERT_EQ(run("detect_segments --csv " + file("s.csv") + " " + file(name)), 0) << name << content("err");
    EXPECT_THAT(content("out"), HasSubstr("\"segments\": 4")) << name;
  }
  ASSERT_EQ(run("detect_segments --csv " + file("s.csv") + " " + file("small.png")), 0);
  EXPECT_THAT(content("out"), HasSubstr("\"segments\": 0"));
  ASSERT_EQ(run("detect_segments --csv " + file("s.csv") + " '" + file("a,b\"c.png") + "'"), 0);
  EXPECT_THAT(content("s.csv"), HasSubstr("a,b\"\"c.png\","));
}

// A header that promises more pixels than OpenCV takes must not stop the others.
TEST_F(Tools, DetectSegmentsGoesOnAfterAnImpossiblyLargeImage) {
  std::ofstream(folder_ / "huge.pgm") << "P5\n2000000 2000000\n255\n";
  EXPECT_EQ(run("detect_segments --csv " + file("s.csv") + " " + file("huge.pgm") + " " + folder_.string() +
                " " + file("square.png")),
            1);
  EXPECT_THAT(content("err"), HasSubstr(file("huge.pgm") + ": not an image that can be read"));
  EXPECT_THAT(content("err"), HasSubstr(folder_.string() + ": not an image that can be read"));
  EXPECT_THAT(content("s.csv"), HasSubstr("square.png,"));
  EXPECT_THAT(content("out"), HasSubstr("\"unreadable\": 2"));
}

TEST_F(Tools, DetectSegmentsRefusesBadOptions) {
  EXPECT_EQ(run("detect_segments --size 320 " + file("square.png")), 2);
  EXPECT_THAT(content("err"), HasSubstr("--size: 320 (must be WxH, for example 320x240)"));
  EXPECT_EQ(run("detect_segments --size 0x240 " + file("square.png")), 2);
  EXPECT_EQ(run("detect_segments --min-length -1 " + file("square.png")), 2);
  EXPECT_EQ(run("detect_segments"), 2);
  EXPECT_EQ(run("detect_segments --detector lsd " + file("square.png")), 2);
  EXPECT_NE(run("detect_segments --csv /nowhere/s.csv " + file("square.png")), 0);
  EXPECT_THAT(content("err"), HasSubstr("/nowhere/s.csv: cannot be written"));
}

TEST_F(Tools, LabelPaletteDrawsClassesAndReportsABadPalette) {
  const std::string palette = (fs::path(VISMEM_SOURCE_DIR) / "cfg/maps/field.palette").string();
  ASSERT_EQ(run("label_palette " + file("square.png") + " --palette " + palette + " --out " + file("l.png")),
            0)
      << content("err");
  EXPECT_FALSE(cv::imread(file("l.png")).empty());
  EXPECT_THAT(content("out"), HasSubstr("\"unknown\":4"));

  std::ofstream(folder_ / "bad.palette") << "class.x = value 0..300\n";
  EXPECT_EQ(run("label_palette " + file("square.png") + " --palette " + file("bad.palette") + " --out " +
                file("m.png")),
            2);
  EXPECT_THAT(content("err"),
              HasSubstr("bad.palette:1: class.x = value 0..300 (must be within 0..100 per cent)"));
  EXPECT_FALSE(fs::exists(folder_ / "m.png"));
}

// The upper half is one class, the lower one another; the border between them has the pair's label.
TEST_F(Tools, LabelPaletteShowsClassesAndLabels) {
  cv::Mat field(240, 320, CV_8UC3, cv::Scalar(40, 120, 40));
  field.rowRange(120, 240).setTo(cv::Scalar(230, 230, 230));
  cv::imwrite(file("field.png"), field);
  std::ofstream(folder_ / "f.palette") << "class.grass = hue 90..150 saturation 40..100\n"
                                          "class.line = saturation 0..20 value 60..100\n"
                                          "pair.edge = grass line\n";
  const std::string options = " --palette " + file("f.palette") + " --out ";
  // A folder gets a picture of another name than the image: its own folder too.
  ASSERT_EQ(run("label_palette " + file("field.png") + options + folder_.string()), 0) << content("err");
  EXPECT_THAT(content("out"), HasSubstr("\"edge\":1"));
  EXPECT_THAT(content("out"), HasSubstr("\"grass\":0.5"));
  EXPECT_EQ(cv::imread(file("field.png")).rows, 240);
  const cv::Mat picture = cv::imread(file("field_labels.png"));
  ASSERT_GT(picture.rows, 720);  // three times the image, and the legend
  ASSERT_EQ(picture.cols, 2 * 960);
  // Right: the classes in their mean colours.
  EXPECT_EQ(picture.at<cv::Vec3b>(100, 960 + 300), cv::Vec3b(40, 120, 40));
  EXPECT_EQ(picture.at<cv::Vec3b>(600, 960 + 300), cv::Vec3b(230, 230, 230));

  EXPECT_EQ(run("label_palette " + file("broken.png") + options + file("x.png")), 1);
  EXPECT_THAT(content("err"), HasSubstr("broken.png: not an image that can be read"));
  EXPECT_EQ(run("label_palette " + file("none.png") + options + file("x.png")), 2);
  EXPECT_EQ(content("err"), file("none.png") + ": cannot be opened (No such file or directory)\n");
  EXPECT_EQ(run("label_palette " + file("field.png") + options + file("x.unknown")), 1);
  EXPECT_THAT(content("err"), HasSubstr("x.unknown: cannot be written (its ending must be that of an image"));
  EXPECT_EQ(run("label_palette " + file("field.png") + " --palette /nowhere.palette --out " + file("x.png")),
            2);
  EXPECT_THAT(content("err"), HasSubstr("/nowhere.palette"));
}

TEST_F(Tools, LabelPaletteSaysWhichRuleTookAPixel) {
  cv::Mat image(120, 160, CV_8UC3, cv::Scalar(60, 60, 60));
  image.colRange(80, 160).setTo(cv::Scalar(20, 100, 200));  // B, G, R
  cv::imwrite(file("two.png"), image);
  std::ofstream(folder_ / "t.palette") << "# comment\nclass.dark = value 0..30\nclass.wood = hue 15..40\n"
                                          "class.all = value 0..100\nclass.late = value 40..60\n"
                                          "pair.foot = dark wood\n";
  const std::string palette = file("t.palette");
  // From another folder, with a palette outside the checkout.
  ASSERT_EQ(run("label_palette " + file("two.png") + " --palette " + palette +
                " --at 10 20 --at 100 20 --out " + file("l.png")),
            0)
      << content("err");
  EXPECT_THAT(content("out"), HasSubstr("{\"at\":[10,20],\"class\":\"dark\",\"hue\":null,\"rgb\":[60,60,60],"
                                        "\"rules\":[\"" +
                                        palette + ":2: class.dark\",\"" + palette +
                                        ":4: class.all\"],\"saturation\":0.0,\"value\":23.5}"));
  EXPECT_THAT(content("out"),
              HasSubstr("{\"at\":[100,20],\"class\":\"wood\",\"hue\":26.7,\"rgb\":[200,100,20],"));
  EXPECT_THAT(content("out"), HasSubstr("\"" + palette + ":2: class.dark\":0.5"));
  EXPECT_THAT(content("err"), HasSubstr(palette + ":5: class late gets no colour: before it come "));
  EXPECT_EQ(run("label_palette " + file("two.png") + " --palette " + palette + " --at 160 20 --out " +
                file("m.png")),
            2);
  EXPECT_THAT(content("err"), HasSubstr("--at 160 20 (must be within 0..159 and 0..119)"));
}

}  // namespace
}  // namespace vismem
