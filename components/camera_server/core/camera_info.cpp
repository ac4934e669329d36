#include "camera_server/core/camera_info.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <vector>

#include "common/config/config_error.h"
#include "common/config/text_format.h"

namespace vismem {
namespace {

constexpr std::size_t kCoefficients = 5;

class CameraInfoReader {
 public:
  explicit CameraInfoReader(std::string file) : file_(std::move(file)) {}

  CameraIntrinsics read(const YAML::Node& root) const {
    if (!root.IsMap()) fail(root, "must hold keys such as image_width: 640");
    CameraIntrinsics lens;
    lens.width = side(root, "image_width");
    lens.height = side(root, "image_height");
    const auto k = numbers(root, "camera_matrix");
    if (k.size() != 9) fail(root["camera_matrix"], "camera_matrix must have 9 numbers");
    lens.fx = k[0];
    lens.cx = k[2];
    lens.fy = k[4];
    lens.cy = k[5];
    const auto d = distortion(root);
    lens.k1 = d[0];
    lens.k2 = d[1];
    lens.p1 = d[2];
    lens.p2 = d[3];
    lens.k3 = d[4];
    if (const std::string problem = checkIntrinsics(lens); !problem.empty())
      fail(root["camera_matrix"], problem);
    return lens;
  }

  [[noreturn]] void fail(const YAML::Node& where, const std::string& why) const {
    const int line = where.IsDefined() ? where.Mark().line + 1 : 0;
    failAt(line, why);
  }
  [[noreturn]] void failAt(int line, const std::string& why) const {
    throw ConfigError({file_ + (line > 0 ? ":" + std::to_string(line) : "") + ": " + why});
  }

 private:
  YAML::Node required(const YAML::Node& root, const std::string& key) const {
    const YAML::Node node = root[key];
    if (!node.IsDefined()) failAt(0, "missing key \"" + key + "\"");
    return node;
  }

  int side(const YAML::Node& root, const std::string& key) const {
    const YAML::Node node = required(root, key);
    int value = 0;
    if (!node.IsScalar() || !YAML::convert<int>::decode(node, value) || value < 1 || value > 16384) {
      fail(node, key + " must be a whole number, 1..16384");
    }
    return value;
  }

  std::vector<double> numbers(const YAML::Node& root, const std::string& key) const {
    const YAML::Node node = required(root, key);
    const YAML::Node data = node.IsMap() ? node["data"] : node;
    if (!data.IsDefined() || !data.IsSequence()) fail(node, key + " must have data: [numbers]");
    std::vector<double> values;
    for (const YAML::Node& entry : data) {
      double value = 0.0;
      if (!entry.IsScalar() || !YAML::convert<double>::decode(entry, value) || !std::isfinite(value)) {
        fail(entry, key + " must hold numbers");
      }
      values.push_back(value);
    }
    return values;
  }

  std::vector<double> distortion(const YAML::Node& root) const {
    std::vector<double> d;
    const YAML::Node coefficients = root["distortion_coefficients"];
    if (coefficients.IsDefined()) d = numbers(root, "distortion_coefficients");
    const YAML::Node model_node = root["distortion_model"];
    const std::string model =
        model_node.IsDefined() && model_node.IsScalar() ? model_node.Scalar() : "plumb_bob";
    if (model != "plumb_bob" && model != "rational_polynomial") {
      fail(model_node,
           "distortion_model " + model + " (must be plumb_bob, or rational_polynomial without k4, k5, k6)");
    }
    const auto is_zero = [](double value) { return value == 0.0; };
    if (d.size() > kCoefficients && !std::all_of(d.begin() + kCoefficients, d.end(), is_zero)) {
      fail(coefficients, "distortion_coefficients after the first 5 must be 0");
    }
    if (d.size() < 4 && !d.empty()) {
      fail(coefficients, "distortion_coefficients must be k1, k2, p1, p2 and, if wanted, k3");
    }
    d.resize(kCoefficients, 0.0);
    return d;
  }

  const std::string file_;
};

/// Shortest text that reads as the same number.
std::string exact(double value) {
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  return {text, end};
}

std::string matrix(const std::string& name, int rows, int columns, const std::vector<double>& data) {
  return name + ":\n  rows: " + std::to_string(rows) + "\n  cols: " + std::to_string(columns) +
         "\n  data: [" + joined(data, ", ", exact) + "]\n";
}

}  // namespace

std::string writeCameraInfo(const CameraIntrinsics& k, const std::string& camera_name,
                            const std::vector<std::string>& comments) {
  std::string text;
  for (const std::string& comment : comments) text += "# " + comment + "\n";
  text += "image_width: " + std::to_string(k.width) + "\nimage_height: " + std::to_string(k.height) +
          "\ncamera_name: " + camera_name + "\n";
  text += matrix("camera_matrix", 3, 3, {k.fx, 0, k.cx, 0, k.fy, k.cy, 0, 0, 1});
  text += "distortion_model: plumb_bob\n";
  text += matrix("distortion_coefficients", 1, 5, {k.k1, k.k2, k.p1, k.p2, k.k3});
  text += matrix("rectification_matrix", 3, 3, {1, 0, 0, 0, 1, 0, 0, 0, 1});
  text += matrix("projection_matrix", 3, 4, {k.fx, 0, k.cx, 0, 0, k.fy, k.cy, 0, 0, 0, 1, 0});
  return text;
}

CameraIntrinsics parseCameraInfo(const std::string& text, const std::string& file) {
  const CameraInfoReader reader(file);
  YAML::Node root;
  try {
    root = YAML::Load(text);
  } catch (const YAML::Exception& error) {
    reader.failAt(error.mark.line + 1, error.msg);
  }
  try {
    return reader.read(root);
  } catch (const YAML::Exception& error) {
    reader.failAt(error.mark.line + 1, error.msg);
  }
}

}  // namespace vismem
