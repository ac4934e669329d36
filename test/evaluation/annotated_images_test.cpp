#include "evaluation/app/annotated_images.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>
#include <opencv2/imgcodecs.hpp>

namespace vismem {
namespace {

class AnnotatedImages : public testing::Test {
 protected:
  AnnotatedImages()
      : folder_(std::filesystem::path(testing::TempDir()) / ("annotated_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~AnnotatedImages() override { std::filesystem::remove_all(folder_); }
  void image(const std::string& name, const std::string& annotation) const {
    cv::imwrite((folder_ / (name + ".png")).string(), cv::Mat(20, 40, CV_8UC3, cv::Scalar(1, 2, 3)));
    if (!annotation.empty()) std::ofstream(folder_ / (name + "_gt.txt")) << annotation;
  }
  std::string failure() const {
    try {
      loadAnnotated(folder_, folder_);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return {};
  }
  const std::filesystem::path folder_;
};

TEST_F(AnnotatedImages, AreSortedAndShiftedToPixelCentres) {
  image("b", "10.75 5.75 30.75 5.75\n\n");
  image("a", "1 1 1 1\n");
  const auto images = loadAnnotated(folder_, folder_);
  ASSERT_EQ(images.size(), 2u);
  EXPECT_EQ(images[0].name, "a");
  EXPECT_TRUE(images[0].annotated.empty()) << "a segment without length";
  ASSERT_EQ(images[1].annotated.size(), 1u);
  EXPECT_NEAR(images[1].annotated[0].a.x(), 10.0, 1e-12);
  EXPECT_NEAR(images[1].annotated[0].b.y(), 5.0, 1e-12);
  EXPECT_TRUE(loadAnnotated(folder_ / "nowhere", folder_).empty());
}

TEST_F(AnnotatedImages, AreScaledWithTheirAnnotation) {
  image("a", "10.75 5.75 30.75 5.75\n");
  const AnnotatedImage half = atWidth(loadAnnotated(folder_, folder_).at(0), 20);
  EXPECT_EQ(half.rgb.cols, 20);
  EXPECT_EQ(half.rgb.rows, 10);
  EXPECT_NEAR(half.annotated[0].a.x(), 5.0, 1e-12);
  EXPECT_NEAR(half.annotated[0].b.x(), 15.0, 1e-12);
}

TEST_F(AnnotatedImages, NameABadAnnotationWithItsLine) {
  image("a", "1 2 3 4\n1 2 3\n");
  EXPECT_THAT(failure(), testing::HasSubstr("a_gt.txt:2: 1 2 3 (must be x1 y1 x2 y2)"));
  std::filesystem::remove(folder_ / "a_gt.txt");
  EXPECT_THAT(failure(), testing::HasSubstr("a_gt.txt: cannot be read (each image needs its annotation)"));
}

}  // namespace
}  // namespace vismem
