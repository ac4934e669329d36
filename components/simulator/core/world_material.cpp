#include "simulator/core/world_material.h"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "simulator/core/world_resolver.h"
#include "simulator/core/world_tga.h"

namespace vismem {
namespace {

constexpr int kMaxTexture_px = 4096;
constexpr std::size_t kMaxPicture_bytes = 128u << 20;
constexpr long kMaxPicture_px = 1L << 27;

/// A script without its comments.
std::string withoutComments(std::string_view text) {
  std::string plain;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text.compare(i, 2, "/*") == 0) {
      const auto end = text.find("*/", i + 2);
      if (end == std::string_view::npos) break;
      i = end + 1;
      plain.push_back(' ');
    } else if (text.compare(i, 2, "//") == 0 && (i == 0 || text[i - 1] != ':')) {
      i = std::min(text.find('\n', i), text.size()) - 1;
    } else {
      plain.push_back(text[i]);
    }
  }
  return plain;
}

/// Its statements as words: each line and each brace is one statement.
std::vector<std::vector<std::string>> linesOf(std::string_view text) {
  std::vector<std::vector<std::string>> lines;
  std::string line;
  const auto flush = [&] {
    std::istringstream words(line);
    std::vector<std::string> row;
    for (std::string word; words >> word;) {
      if (word.size() > 1 && word.front() == '"' && word.back() == '"')
        word = word.substr(1, word.size() - 2);
      row.push_back(word);
    }
    if (!row.empty()) lines.push_back(std::move(row));
    line.clear();
  };
  for (const char c : withoutComments(text)) {
    const bool brace = c == '{' || c == '}';
    if (brace || c == '\n') flush();
    if (brace) lines.push_back({std::string(1, c)});
    if (!brace && c != '\n') line.push_back(c);
  }
  flush();
  return lines;
}

std::optional<Eigen::Vector3f> colorOf(const std::vector<std::string>& words) {
  if (words.size() < 4) return std::nullopt;
  Eigen::Vector3f color;
  for (int i = 0; i < 3; ++i) {
    std::istringstream number(words[1 + i]);
    if (!(number >> color[i])) return std::nullopt;
  }
  if (!color.allFinite()) return std::nullopt;
  return color.cwiseMax(0.0f).cwiseMin(1.0f);
}

std::shared_ptr<const Texture> fromPicture(cv::Mat picture, const std::string& name) {
  if (picture.empty()) throw std::runtime_error(name + ": not a picture in a known format");
  if (static_cast<long>(picture.cols) * picture.rows > kMaxPicture_px) {
    throw std::runtime_error(name + ": too large a picture");
  }
  while (picture.cols > kMaxTexture_px || picture.rows > kMaxTexture_px) {
    cv::Mat half;
    cv::resize(picture, half, {std::max(1, picture.cols / 2), std::max(1, picture.rows / 2)}, 0, 0,
               cv::INTER_AREA);
    picture = half;
  }
  cv::Mat rgb;
  cv::cvtColor(picture, rgb, cv::COLOR_BGR2RGB);
  auto texture = std::make_shared<Texture>();
  texture->name = name;
  texture->width = rgb.cols;
  texture->height = rgb.rows;
  texture->rgb.assign(rgb.datastart, rgb.dataend);
  return texture;
}

}  // namespace

std::map<std::string, OgreMaterial> parseOgreScript(std::string_view text) {
  std::map<std::string, OgreMaterial> materials;
  std::string name;
  bool has_diffuse = false;
  bool has_texture = false;
  int depth = 0;
  for (const auto& words : linesOf(text)) {
    if (depth == 0 && words[0] == "material" && words.size() > 1) {
      name = words[1];
      has_diffuse = has_texture = false;
      OgreMaterial start;
      if (words.size() > 3 && words[2] == ":") {
        if (const auto parent = materials.find(words[3]); parent != materials.end()) start = parent->second;
        if (const auto parent = gazeboMaterial(words[3])) start = *parent;
      }
      materials[name] = start;
    } else if (depth > 0 && !name.empty()) {
      OgreMaterial& material = materials[name];
      // The first technique has the best graphics; later passes only add to the first pass.
      if (words[0] == "diffuse" && !has_diffuse) {
        if (const auto color = colorOf(words)) {
          material.diffuse = *color;
          has_diffuse = true;
        }
      } else if (words[0] == "emissive" && !has_diffuse) {
        if (const auto color = colorOf(words)) material.emissive = *color;
      } else if (words[0] == "texture" && words.size() > 1 && !has_texture) {
        material.texture = words[1];
        has_texture = true;
      } else if (words[0] == "set_texture_alias" && words.size() > 2 && !has_texture) {
        material.texture = words[2];
        has_texture = true;
      }
    }
    for (const auto& word : words) {
      if (word == "{") ++depth;
      if (word == "}" && depth > 0 && --depth == 0) name.clear();
    }
  }
  return materials;
}

std::optional<OgreMaterial> gazeboMaterial(const std::string& name) {
  static const std::map<std::string, Eigen::Vector3f> kColors{
      {"Grey", {0.7f, 0.7f, 0.7f}},
      {"DarkGrey", {0.175f, 0.175f, 0.175f}},
      {"LightGrey", {0.8f, 0.8f, 0.8f}},
      {"White", {1.0f, 1.0f, 1.0f}},
      {"FlatBlack", {0.1f, 0.1f, 0.1f}},
      {"Black", {0.0f, 0.0f, 0.0f}},
      {"Red", {1.0f, 0.0f, 0.0f}},
      {"RedBright", {0.87f, 0.26f, 0.07f}},
      {"Green", {0.0f, 1.0f, 0.0f}},
      {"Blue", {0.0f, 0.0f, 1.0f}},
      {"SkyBlue", {0.13f, 0.44f, 0.7f}},
      {"Yellow", {1.0f, 1.0f, 0.0f}},
      {"ZincYellow", {0.97f, 0.95f, 0.21f}},
      {"DarkYellow", {0.7f, 0.7f, 0.0f}},
      {"Purple", {1.0f, 0.0f, 1.0f}},
      {"Turquoise", {0.0f, 1.0f, 1.0f}},
      {"Orange", {1.0f, 0.51f, 0.05f}},
      {"Indigo", {0.33f, 0.0f, 0.5f}},
      {"Gold", {0.8f, 0.65f, 0.12f}},
      {"Bronze", {0.6f, 0.45f, 0.25f}},
      {"Chrome", {0.6f, 0.6f, 0.6f}},
      {"Wood", {0.55f, 0.4f, 0.25f}},
      {"WoodFloor", {0.6f, 0.45f, 0.3f}},
      {"WoodPallet", {0.6f, 0.5f, 0.35f}},
      {"CeilingTiled", {0.85f, 0.85f, 0.83f}},
      {"Bricks", {0.55f, 0.3f, 0.25f}},
      {"Grass", {0.25f, 0.45f, 0.2f}},
      {"Residential", {0.45f, 0.45f, 0.45f}},
      {"Road", {0.35f, 0.35f, 0.35f}},
      {"Asphalt", {0.35f, 0.35f, 0.35f}},
      {"Gray", {0.7f, 0.7f, 0.7f}},
      {"WhiteGlow", {1.0f, 1.0f, 1.0f}},
      {"GreenGlow", {0.0f, 1.0f, 0.0f}},
      {"BlueGlow", {0.0f, 0.0f, 1.0f}},
      {"RedGlow", {1.0f, 0.0f, 0.0f}},
      {"YellowGlow", {1.0f, 1.0f, 0.0f}},
      {"PurpleGlow", {1.0f, 0.0f, 1.0f}},
      {"TurquoiseGlow", {0.0f, 1.0f, 1.0f}},
      {"RedTransparent", {1.0f, 0.0f, 0.0f}},
      {"GreenTransparent", {0.0f, 1.0f, 0.0f}},
      {"BlueTransparent", {0.0f, 0.0f, 1.0f}},
      {"GreyTransparent", {0.5f, 0.5f, 0.5f}},
      {"BlackTransparent", {0.0f, 0.0f, 0.0f}},
      {"YellowTransparent", {1.0f, 1.0f, 0.0f}},
  };
  constexpr std::string_view kPrefix = "Gazebo/";
  if (name.compare(0, kPrefix.size(), kPrefix) != 0) return std::nullopt;
  const auto known = kColors.find(name.substr(kPrefix.size()));
  if (known == kColors.end()) return std::nullopt;
  OgreMaterial material;
  material.diffuse = known->second;
  if (name.ends_with("Glow")) material.emissive = known->second;
  return material;
}

std::shared_ptr<const Texture> loadTexture(const std::filesystem::path& file) {
  const auto bytes = readFile(file, kMaxPicture_bytes);
  if (!bytes) throw std::runtime_error(file.string() + ": cannot be read, or over 128 MB");
  return decodeTexture(*bytes, file.string());
}

std::shared_ptr<const Texture> decodeTexture(std::string_view bytes, const std::string& name) {
  if (bytes.empty()) throw std::runtime_error(name + ": is empty");
  try {
    const std::vector<unsigned char> buffer(bytes.begin(), bytes.end());
    cv::Mat picture = cv::imdecode(buffer, cv::IMREAD_COLOR);
    if (picture.empty()) picture = decodeTga(bytes);
    return fromPicture(picture, name);
  } catch (const cv::Exception& error) {
    throw std::runtime_error(name + ": not a picture in a known format (" + error.err + ")");
  }
}

}  // namespace vismem
