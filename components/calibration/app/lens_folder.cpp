#include "calibration/app/lens_folder.h"

#include <cmath>
#include <iomanip>
#include <opencv2/imgproc.hpp>
#include <sstream>

#include "calibration/app/output_files.h"
#include "calibration/core/lens/lens_pictures.h"
#include "camera_server/core/camera_info.h"
#include "common/config/config_error.h"
#include "common/config/text_file.h"
#include "common/vision/app/image_file.h"

namespace vismem {
namespace {

using nlohmann::json;

json boardJson(const BoardSpec& board) {
  return {{"columns", board.columns},
          {"rows", board.rows},
          {"first_tag", board.first_tag},
          {"square_m", {board.square_m.x(), board.square_m.y()}}};
}

json viewJson(const BoardView& view) {
  json corners = json::array();
  for (const BoardCorner& corner : view.corners)
    corners.push_back({corner.id, corner.pixel.x(), corner.pixel.y(), corner.sigma_px});
  return {{"stamp_us", view.stamp_us}, {"corners", corners}};
}

BoardView viewFrom(const json& value, int corners) {
  BoardView view;
  view.stamp_us = value.at("stamp_us").get<std::int64_t>();
  for (const json& corner : value.at("corners")) {
    BoardCorner one{corner.at(0).get<int>(),
                    {corner.at(1).get<double>(), corner.at(2).get<double>()},
                    corner.at(3).get<double>()};
    if (one.id < 0 || one.id >= corners) throw std::out_of_range("a corner that the board does not have");
    view.corners.push_back(one);
  }
  return view;
}

std::string numbered(std::size_t number) {
  std::ostringstream name;
  name << std::setw(3) << std::setfill('0') << number << ".png";
  return name.str();
}

json lensJson(const CameraIntrinsics& lens) {
  return {{"width", lens.width}, {"height", lens.height}, {"fx_px", lens.fx}, {"fy_px", lens.fy},
          {"cx_px", lens.cx},    {"cy_px", lens.cy},      {"k1", lens.k1},    {"k2", lens.k2},
          {"p1", lens.p1},       {"p2", lens.p2},         {"k3", lens.k3}};
}

json modelsJson(const std::vector<ModelScore>& scores) {
  json models = json::array();
  for (const ModelScore& score : scores) {
    models.push_back({{"model", nameOf(score.model)},
                      {"training_rms_px", score.training_rms_px},
                      {"held_out_rms_px", score.held_out_rms_px}});
  }
  return models;
}

json sigmasJson(const LensMatrix& P) {
  json sigmas = json::array();
  for (int i = 0; i < kLensParameters; ++i) sigmas.push_back(std::sqrt(P(i, i)));
  return sigmas;
}

std::string inDigits(double value) {
  std::ostringstream text;
  text << std::setprecision(3) << value;
  return text.str();
}

}  // namespace

LensFolder::LensFolder(std::filesystem::path folder, const BoardSpec& board)
    : folder_(std::move(folder)), board_(board) {
  const auto file = folder_ / "views.json";
  if (std::filesystem::exists(file)) read(file);
}

void LensFolder::read(const std::filesystem::path& file) {
  try {
    const json root = json::parse(readTextFile(file, "views that calibrate lens accepted"));
    if (root.at("board") != boardJson(board_)) {
      throw ConfigError({file.string() +
                         ": has views of another board or of another ruler: " + root["board"].dump() +
                         " (must be " + boardJson(board_).dump() + "; or begin with an empty --out)"});
    }
    width_ = root.at("width").get<int>();
    height_ = root.at("height").get<int>();
    for (const json& view : root.at("views")) views_.push_back(viewFrom(view, board_.corners()));
  } catch (const ConfigError&) {
    throw;
  } catch (const std::exception& error) {
    throw ConfigError({file.string() + ": " + error.what() + " (must be as calibrate lens writes it)"});
  }
}

void LensFolder::write() const {
  json root{{"board", boardJson(board_)}, {"width", width_}, {"height", height_}, {"views", json::array()}};
  for (const BoardView& view : views_) root["views"].push_back(viewJson(view));
  writeWholeFile(folder_ / "views.json", root.dump() + "\n");
}

void LensFolder::add(const BoardView& view, const cv::Mat& image) {
  width_ = image.cols;
  height_ = image.rows;
  views_.push_back(view);
  cv::Mat colour = image;
  if (image.channels() == 1) cv::cvtColor(image, colour, cv::COLOR_GRAY2RGB);
  writeImageFile(colour, folder_ / "views" / numbered(views_.size()));
  write();
}

void LensFolder::writeProgress(const LensProgress& progress, double goal_px) const {
  writeImageFile(drawProgress(progress, views_, goal_px, width_, height_), folder_ / "progress.png");
}

std::filesystem::path LensFolder::writeResults(const LensCalibration& calibration,
                                               const Report& report) const {
  const LensFit& fit = calibration.fit;
  LensProgress last;
  last.views = views_.size();
  last.is_enough = true;
  last.uncertainty = calibration.uncertainty;
  writeImageFile(drawProgress(last, views_, report.goal_px, width_, height_), folder_ / "uncertainty.png");
  writeImageFile(drawResiduals(fit, views_), folder_ / "residuals.png");
  json document = report.summary;
  document["lens"] = lensJson(fit.lens);
  document["sigmas"] = sigmasJson(fit.P_lens);
  document["models"] = modelsJson(calibration.scores);
  document["bow_m"] = {fit.bow_m.x(), fit.bow_m.y()};
  document["grid_sigma_px"] = calibration.uncertainty.sigma_px;
  writeWholeFile(folder_ / "report.json", document.dump(2) + "\n");
  const auto file = folder_ / "camera.yaml";
  const double worst_px = calibration.uncertainty.sigma_px[calibration.uncertainty.worst];
  writeWholeFile(
      file, writeCameraInfo(
                fit.lens, report.camera_name,
                {"Written by calibrate lens from " + std::to_string(views_.size()) + " views.",
                 "Held-out error " + inDigits(calibration.held_out_rms_px) +
                     " px; standard deviation of the projection at worst " + inDigits(worst_px) + " px."}));
  return file;
}

}  // namespace vismem
