/// @file The log folders that JdeRobot's recorder writes, read as they are. See C1.
/// FOLDER/images/cameraN/cameraData.jde has a line with the milliseconds of each image, which lies beside it
/// as MILLISECONDS.png or .jpg; FOLDER/encoders/encoderN/encoderData.jde likewise, each sample beside it in a
/// file MILLISECONDS of five floats (x and y [mm], heading [deg], its cosine and sine).
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "common/recording/bag_format.h"

namespace vismem {

struct JdeRobotLog {
  struct Image {
    std::int64_t stamp_us = 0;
    std::filesystem::path file;
    std::string format;  ///< "jpeg" or "png"
  };
  struct Odometry {
    std::int64_t stamp_us = 0;
    double x_m = 0.0;
    double y_m = 0.0;
    double theta_rad = 0.0;
  };
  std::vector<Image> images;       ///< of one camera, stamps strictly increase
  std::vector<Odometry> odometry;  ///< stamps strictly increase
  std::vector<std::string> notes;  ///< what is missing or could not be read, for people
};

/// @param camera number N of cameraN. @throws RecordingError when the folder has no images of that camera:
/// folder, found, expected.
JdeRobotLog readJdeRobotLog(const std::filesystem::path& folder, int camera);

/// The milliseconds of a .jde file, one a line; lines that are no number >= 0 are skipped and counted in
/// `wrong`. Pure.
std::vector<std::int64_t> parseJdeStamps(const std::string& text, std::size_t& wrong);

}  // namespace vismem
