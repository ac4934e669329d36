#include "calibration/app/body_files.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <sstream>

#include "common/config/config_error.h"
#include "common/config/text_file.h"

namespace vismem {
namespace {

using Json = nlohmann::json;

constexpr int kVersion = 1;

Json viewToJson(const BoardView& view) {
  Json corners = Json::array();
  for (const BoardCorner& c : view.corners) corners.push_back({c.id, c.pixel.x(), c.pixel.y(), c.sigma_px});
  return {{"stamp_us", view.stamp_us}, {"corners", corners}};
}

BoardView viewFrom(const Json& json) {
  BoardView view;
  view.stamp_us = json.at("stamp_us");
  for (const Json& c : json.at("corners")) {
    view.corners.push_back(
        {c.at(0).get<int>(), {c.at(1).get<double>(), c.at(2).get<double>()}, c.at(3).get<double>()});
  }
  return view;
}

Json lensToJson(const CameraIntrinsics& k) {
  return {{"width", k.width},
          {"height", k.height},
          {"pinhole_px", {k.fx, k.fy, k.cx, k.cy}},
          {"distortion", {k.k1, k.k2, k.p1, k.p2, k.k3}}};
}

CameraIntrinsics lensFrom(const Json& json) {
  const auto p = json.at("pinhole_px").get<std::array<double, 4>>();
  const auto d = json.at("distortion").get<std::array<double, 5>>();
  return {json.at("width").get<int>(),
          json.at("height").get<int>(),
          p[0],
          p[1],
          p[2],
          p[3],
          d[0],
          d[1],
          d[2],
          d[3],
          d[4]};
}

BoardSpec boardFrom(const Json& json) {
  BoardSpec board;
  board.columns = json.at("columns");
  board.rows = json.at("rows");
  const auto square = json.at("square_m").get<std::array<double, 2>>();
  board.square_m = {square[0], square[1]};
  board.first_tag = json.at("first_tag");
  return board;
}

std::string rowText(const ParameterInfo& info, const EstimatedParameter& row) {
  std::ostringstream text;
  text << "  " << std::left << std::setw(30) << info.name << std::right;
  if (!row.sigma) {
    text << "not observable";
    return text.str();
  }
  const double sigma = *row.sigma * info.to_unit;
  const int digits = std::clamp(static_cast<int>(std::ceil(1.0 - std::log10(std::max(sigma, 1e-9)))), 0, 6);
  text << std::fixed << std::setprecision(digits) << std::setw(12) << row.value * info.to_unit << " +- "
       << sigma << " " << info.unit;
  return text.str();
}

Json rowJson(const ParameterInfo& info, const EstimatedParameter& row) {
  Json json{{"unit", info.unit}, {"observable", row.sigma.has_value()}};
  if (row.sigma) {
    json["value"] = row.value * info.to_unit;
    json["sigma"] = *row.sigma * info.to_unit;
  }
  return json;
}

}  // namespace

nlohmann::json toJson(const BodyRecord& record) {
  const BoardSpec& b = record.board;
  Json json{{"version", kVersion},
            {"place", record.place == BoardPlace::kFloor ? "floor" : "wall"},
            {"board",
             {{"columns", b.columns},
              {"rows", b.rows},
              {"square_m", {b.square_m.x(), b.square_m.y()}},
              {"first_tag", b.first_tag}}},
            {"lens", lensToJson(record.intrinsics)}};
  Json& views = json["views"] = Json::array();
  for (const BoardView& view : record.views) views.push_back(viewToJson(view));
  Json& joints = json["joints"] = Json::array();
  for (const auto& s : record.joints) joints.push_back({s.stamp_us, s.pan_rad, s.tilt_rad});
  Json& odometry = json["odometry"] = Json::array();
  for (const auto& s : record.odometry) {
    const Pose2& p = s.T_odom_robot;
    odometry.push_back({s.stamp_us, p.x, p.y, p.theta});
  }
  return json;
}

BodyRecord bodyRecordFrom(const nlohmann::json& json, const std::string& file) {
  BodyRecord record;
  try {
    if (json.at("version") != kVersion) {
      throw ConfigError(
          {file + ": version: " + json.at("version").dump() + " (must be " + std::to_string(kVersion) + ")"});
    }
    record.board = boardFrom(json.at("board"));
    record.place = json.at("place") == "wall" ? BoardPlace::kWall : BoardPlace::kFloor;
    record.intrinsics = lensFrom(json.at("lens"));
    for (const Json& view : json.at("views")) record.views.push_back(viewFrom(view));
    for (const Json& s : json.at("joints")) {
      record.joints.push_back({s.at(0).get<StampUs>(), 0, s.at(1).get<double>(), s.at(2).get<double>()});
    }
    for (const Json& s : json.at("odometry")) {
      const Pose2 pose{s.at(1).get<double>(), s.at(2).get<double>(), s.at(3).get<double>()};
      record.odometry.push_back({s.at(0).get<StampUs>(), 0, pose, 0.0, 0.0});
    }
  } catch (const Json::exception& error) {
    throw ConfigError({file + ": " + error.what() + " (must be what calibrate body wrote)"});
  }
  return record;
}

BodyRecord readBodyRecord(const std::filesystem::path& file) {
  const Json json = Json::parse(readTextFile(file, "a record of calibrate body"), nullptr, false);
  if (json.is_discarded())
    throw ConfigError({file.string() + ": no JSON (must be what calibrate body wrote)"});
  return bodyRecordFrom(json, file.string());
}

nlohmann::json reportOf(const BodyEstimate& estimate) {
  Json json;
  for (const auto& row : estimate.place) {
    const ParameterInfo& info = cameraPlaceInfos()[row.index];
    json["camera_at_zero"][std::string(info.name)] = rowJson(info, row);
  }
  for (const auto& row : estimate.rows) {
    const ParameterInfo& info = parameterInfos()[row.index];
    json["parameters"][std::string(info.name)] = rowJson(info, row);
  }
  json["not_observable"] = Json::array();
  for (const auto& direction : estimate.unknown) json["not_observable"].push_back(direction.text);
  json["warnings"] = estimate.warnings;
  json["views"] = estimate.views;
  json["corners"] = estimate.fit.corners;
  json["outliers"] = estimate.outliers;
  json["rms_px"] = estimate.fit.rms_px;
  json["corner_noise"] = estimate.noise.corners;
  json["wheel_noise_m"] = estimate.noise.wheel_sqrtm;
  return json;
}

std::string tableOf(const BodyEstimate& estimate) {
  std::ostringstream text;
  text << "The camera on the robot, joints at 0:\n";
  for (const auto& row : estimate.place) text << rowText(cameraPlaceInfos()[row.index], row) << "\n";
  text << "Parts, joints, wheels and times:\n";
  for (const auto& row : estimate.rows) text << rowText(parameterInfos()[row.index], row) << "\n";
  if (!estimate.unknown.empty()) text << "Not observable from these views, each line together:\n";
  for (const auto& direction : estimate.unknown) text << "  " << direction.text << "\n";
  for (const auto& warning : estimate.warnings) text << "warning: " << warning << "\n";
  text << estimate.views << " views, " << estimate.fit.corners << " corners within " << std::fixed
       << std::setprecision(2) << estimate.fit.rms_px << " px RMS, " << estimate.outliers << " left out\n";
  return text.str();
}

}  // namespace vismem
