#include "simulator/core/renderer_texture.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace vismem {
namespace {

/// Columns or rows that a pixel of the smaller image covers, and their shares of it.
struct Cover {
  int first = 0;
  int count = 0;
  std::array<float, 3> weights{};
};

/// Two halves, or parts of three where the size is odd: a picture whose pixels lie askew would look moved.
Cover coverOf(int i, int small, int large) {
  const int begin = i * large;  // both in parts of 1 / small of a pixel
  const int end = begin + large;
  Cover cover{begin / small, 0, {}};
  for (int pixel = cover.first; pixel * small < end; ++pixel) {
    const int part = std::min(end, (pixel + 1) * small) - std::max(begin, pixel * small);
    cover.weights[static_cast<std::size_t>(cover.count++)] = static_cast<float>(part) / static_cast<float>(large);
  }
  return cover;
}

}  // namespace

TexturePyramid::TexturePyramid(const Texture& texture) {
  Level whole{texture.width, texture.height, {}};
  whole.pixels.reserve(texture.rgb.size() / 3);
  for (std::size_t i = 0; i + 2 < texture.rgb.size(); i += 3) {
    whole.pixels.push_back({texture.rgb[i], texture.rgb[i + 1], texture.rgb[i + 2], 0});
  }
  levels_.push_back(std::move(whole));
  while (levels_.back().width > 1 || levels_.back().height > 1) levels_.push_back(halved(levels_.back()));
}

TexturePyramid::Level TexturePyramid::halved(const Level& from) {
  Level to{std::max(1, from.width / 2), std::max(1, from.height / 2), {}};
  to.pixels.resize(static_cast<std::size_t>(to.width) * to.height);
  for (int y = 0; y < to.height; ++y) {
    const Cover rows = coverOf(y, to.height, from.height);
    for (int x = 0; x < to.width; ++x) {
      const Cover columns = coverOf(x, to.width, from.width);
      std::array<float, 3> mean{0.5f, 0.5f, 0.5f};  // rounds
      for (int k = 0; k < rows.count; ++k) {
        for (int l = 0; l < columns.count; ++l) {
          const auto& pixel =
              from.pixels[static_cast<std::size_t>(rows.first + k) * from.width + columns.first + l];
          const float weight = rows.weights[k] * columns.weights[l];
          for (int c = 0; c < 3; ++c) mean[c] += weight * static_cast<float>(pixel[c]);
        }
      }
      auto& pixel = to.pixels[static_cast<std::size_t>(y) * to.width + x];
      for (int c = 0; c < 3; ++c) pixel[c] = static_cast<std::uint8_t>(mean[c]);
    }
  }
  return to;
}

Eigen::Vector3f TexturePyramid::bilinear(const Level& level, float u, float v) {
  const auto split = [](float coordinate, int size) {
    // Repeated first: far outside 0..1 a float has no fraction left.
    const float at = (coordinate - std::floor(coordinate)) * static_cast<float>(size) - 0.5f;
    const float whole = std::floor(at);
    const int low = std::clamp(static_cast<int>(whole), -1, size - 1);
    return std::tuple{low < 0 ? size - 1 : low, low + 1 >= size ? 0 : low + 1, at - whole};
  };
  const auto [x0, x1, fx] = split(u, level.width);
  const auto [y0, y1, fy] = split(v, level.height);
  const auto at = [&](int x, int y) {
    const auto& p = level.pixels[static_cast<std::size_t>(y) * level.width + x];
    return Eigen::Vector3f(p[0], p[1], p[2]);
  };
  const Eigen::Vector3f top = (1.0f - fx) * at(x0, y0) + fx * at(x1, y0);
  const Eigen::Vector3f bottom = (1.0f - fx) * at(x0, y1) + fx * at(x1, y1);
  return ((1.0f - fy) * top + fy * bottom) / 255.0f;
}

Eigen::Vector3f TexturePyramid::sample(float u, float v, float texels) const {
  if (!std::isfinite(u) || !std::isfinite(v)) return Eigen::Vector3f::Zero();
  const float last = static_cast<float>(levels_.size() - 1);
  const float level = texels > 1.0f ? std::min(std::log2(texels), last) : 0.0f;
  const auto low = static_cast<std::size_t>(level);
  const float fraction = level - static_cast<float>(low);
  const Eigen::Vector3f sharp = bilinear(levels_[low], u, v);
  if (fraction == 0.0f) return sharp;
  return (1.0f - fraction) * sharp + fraction * bilinear(levels_[low + 1], u, v);
}

std::vector<float> texelsPerMetre(const WorldBody& body) {
  if (!body.texture || body.uvs.empty()) return {};
  std::vector<float> result;
  result.reserve(body.triangles.size());
  const float texels = static_cast<float>(body.texture->width) * static_cast<float>(body.texture->height);
  for (const auto& t : body.triangles) {
    const float area =
        (body.vertices[t[1]] - body.vertices[t[0]]).cross(body.vertices[t[2]] - body.vertices[t[0]]).norm();
    const Eigen::Vector2f p = body.uvs[t[1]] - body.uvs[t[0]];
    const Eigen::Vector2f q = body.uvs[t[2]] - body.uvs[t[0]];
    const float density = std::sqrt(std::abs(p.x() * q.y() - p.y() * q.x()) * texels / area);
    result.push_back(std::isfinite(density) ? density : 0.0f);
  }
  return result;
}

}  // namespace vismem
