#include "evaluation/report/run_pictures.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "common/config/text_format.h"
#include "evaluation/figures/error_figure.h"

namespace vismem {
namespace {

/// @return empty, or why it cannot be written.
std::string writePng(const std::filesystem::path& file, const cv::Mat& rgb) {
  cv::Mat bgr;
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
  std::vector<unsigned char> bytes;
  cv::imencode(".png", bgr, bytes);
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  out.flush();
  return out ? std::string() : "cannot write " + file.string() + ": " + std::strerror(errno);
}

}  // namespace

std::vector<std::string> writePictures(const std::filesystem::path& folder, const RunRecord& record,
                                       const RunSummary& summary, const RunMap& map,
                                       const std::string& title) {
  std::vector<std::string> problems;
  const auto write = [&](const char* name, const cv::Mat& picture) {
    const std::string problem = writePng(folder / name, picture);
    if (!problem.empty()) problems.push_back(problem);
  };
  const std::string note = summary.score.is_twin ? " (the map looks the same from the twin place)" : "";
  write("top_view.png", drawTopView(topViewOf(record, summary, map.map, title + note)));
  if (!record.truth.empty()) {
    write("error.png", drawErrors({title + note + ": error over time", summary.score, {}}));
  }
  if (record.last_analysis) {
    const std::string when = formatted(": image at %.2f s", toSeconds(record.last_analysis->stamp_us));
    const auto figure = imageFigureOf(record, map.edges, title + note + when);
    if (figure) write("last_image.png", drawLastImage(*figure));
  }
  return problems;
}

}  // namespace vismem
