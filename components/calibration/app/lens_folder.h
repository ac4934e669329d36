/// @file The folder of a calibration of a lens: accepted views, so that it can go on later, and the results.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "calibration/core/lens/lens_calibration.h"
#include "calibration/core/lens/lens_session.h"

namespace vismem {

/// FOLDER/views.json and FOLDER/views/NNN.png: what was accepted; camera.yaml, report.json, uncertainty.png,
/// residuals.png: the results. *Single-threaded.*
class LensFolder {
 public:
  /// Reads the views of an earlier run. @throw ConfigError for views of another board, or a damaged file.
  LensFolder(std::filesystem::path folder, const BoardSpec& board);

  const std::vector<BoardView>& views() const { return views_; }
  /// Of the images; 0 before the first view.
  int width() const { return width_; }
  int height() const { return height_; }

  /// @param image R, G, B or grey; all of one size.
  void add(const BoardView& view, const cv::Mat& image);
  void writeProgress(const LensProgress& progress, double goal_px) const;

  struct Report {
    std::string camera_name;
    double goal_px = 0.0;
    double camera_height_m = 0.0;
    nlohmann::json summary;  ///< what is said on the last line
  };
  /// Writes camera.yaml, report.json and the pictures. @return camera.yaml.
  std::filesystem::path writeResults(const LensCalibration& calibration, const Report& report) const;

 private:
  void read(const std::filesystem::path& file);
  void write() const;

  std::filesystem::path folder_;
  BoardSpec board_;
  std::vector<BoardView> views_;
  int width_ = 0;
  int height_ = 0;
};

}  // namespace vismem
