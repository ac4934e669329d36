// The page on which colours are named by clicks. What its script does: clicks_page_test.mjs. Tests V3, B5.
#include "calibration/app/clicks_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

namespace vismem {
namespace {

nlohmann::json dataOf(const std::string& page) {
  const std::string begin = "id=\"data\">";
  const std::size_t at = page.find(begin) + begin.size();
  return nlohmann::json::parse(page.substr(at, page.find("</script>", at) - at));
}

TEST(ClicksPage, HoldsImagesNamesAndTheClicksSoFar) {
  const cv::Mat grey(4, 6, CV_8UC3, cv::Scalar::all(90));
  const auto data = dataOf(clicksPage({{"7.50", grey}, {"9.00", grey}}, {"floor"}, {"wall 7.50 2 3"}));
  ASSERT_EQ(data["images"].size(), 2U);
  EXPECT_EQ(data["images"][0]["name"], "7.50");
  // A JPEG begins with FF D8 FF: 255 216 255 -> "/9j/".
  EXPECT_THAT(data["images"][0]["jpeg"].get<std::string>(), testing::StartsWith("/9j/"));
  EXPECT_EQ(data["images"][0]["jpeg"].get<std::string>().size() % 4, 0U);
  EXPECT_EQ(data["classes"], nlohmann::json::array({"floor"}));
  EXPECT_EQ(data["clicks"], nlohmann::json::array({"wall 7.50 2 3"}));
}

TEST(ClicksPage, ANameOfAFileDoesNotEndTheData) {
  const auto data =
      dataOf(clicksPage({{"</script>.png", cv::Mat(2, 2, CV_8UC3, cv::Scalar::all(0))}}, {}, {}));
  EXPECT_EQ(data["images"][0]["name"], "</script>.png");
}

}  // namespace
}  // namespace vismem
