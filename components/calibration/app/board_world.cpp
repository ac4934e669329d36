#include "calibration/app/board_world.h"

#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "calibration/app/output_files.h"
#include "calibration/core/target/board_drawing.h"

namespace vismem {
namespace {

/// Pixels of the picture a millimetre.
constexpr int kScale = 4;
/// Of white paper around the chessboard [mm].
constexpr double kRim_mm = 50.0;

/// The printed page as an image; its lower left corner is the image's.
cv::Mat pictureOf(const PrintedPage& page) {
  const auto px = [](double mm) { return static_cast<int>(std::lround(mm * kScale)); };
  const int height = px(page.height_mm);
  cv::Mat picture(height, px(page.width_mm), CV_8UC1, cv::Scalar(255));
  for (const PrintedRectangle& r : page.black) {
    const cv::Rect area(px(r.x), height - px(r.y + r.height), px(r.x + r.width) - px(r.x),
                        px(r.y + r.height) - px(r.y));
    cv::rectangle(picture, area, cv::Scalar(0), cv::FILLED);
  }
  return picture;
}

std::string worldWith(const PrintedPage& page, const Eigen::Vector2d& middle_m) {
  std::ostringstream world;
  world << "<?xml version=\"1.0\"?>\n<sdf version=\"1.6\"><world name=\"board\">\n"
           "<scene><ambient>1 1 1 1</ambient><shadows>false</shadows></scene>\n"
           "<model name=\"floor\"><static>true</static><pose>0 0 -0.06 0 0 0</pose><link name=\"link\">"
           "<visual name=\"v\"><geometry><box><size>12 12 0.1</size></box></geometry><material>"
           "<ambient>0.5 0.45 0.4 1</ambient><diffuse>0.5 0.45 0.4 1</diffuse></material></visual></link>"
           "</model>\n"
           "<model name=\"board\"><static>true</static><link name=\"link\"><visual name=\"v\"><pose>"
        << middle_m.x() << " " << middle_m.y() << " -0.005 0 0 0</pose><geometry><box><size>"
        << 1e-3 * page.width_mm << " " << 1e-3 * page.height_mm
        << " 0.01</size></box></geometry><material><ambient>1 1 1 1</ambient><diffuse>1 1 1 1</diffuse>"
           "<pbr><metal><albedo_map>board.png</albedo_map></metal></pbr></material></visual></link></model>\n"
           "</world></sdf>\n";
  return world.str();
}

}  // namespace

std::filesystem::path writeBoardWorld(const BoardSpec& board, const std::filesystem::path& folder) {
  const Eigen::Vector2d size_mm(1e3 * board.columns * board.square_m.x(),
                                1e3 * board.rows * board.square_m.y());
  const PrintedPage page = drawBoard(board, {"large", size_mm.x() + 2 * kRim_mm, size_mm.y() + 2 * kRim_mm});
  std::vector<unsigned char> png;
  cv::imencode(".png", pictureOf(page), png);
  writeWholeFile(folder / "board.png", {png.begin(), png.end()});
  const Eigen::Vector2d page_mm(page.width_mm, page.height_mm);
  const std::filesystem::path file = folder / "board.world";
  writeWholeFile(file, worldWith(page, 0.5e-3 * (page_mm - size_mm) - 1e-3 * page.origin_mm));
  return file;
}

}  // namespace vismem
