#include "simulator/core/renderer.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <list>
#include <stdexcept>

#include "simulator/core/renderer_narrow.h"
#include "simulator/core/renderer_scene.h"
#include "simulator/core/renderer_shading.h"

namespace vismem {
namespace {

constexpr float kRayStart_m = 0.01f;
/// Neighbours that differ by more than this are refined [grey levels].
constexpr float kContrast = 8.0f;
/// Rotated grid of the refined pixels [px].
constexpr std::array<std::array<float, 2>, 4> kSubPixels{
    {{-0.375f, -0.125f}, {0.125f, -0.375f}, {0.375f, 0.125f}, {-0.125f, 0.375f}}};
constexpr int kSamples = static_cast<int>(kSubPixels.size());
static_assert(kPacket % kSamples == 0);
/// Packets are blocks of the image: their rays stay together longer than those of a row.
constexpr int kBlockWidth = 4;
constexpr int kBlockHeight = 2;
/// Rows of one task. Tasks do not depend on the number of threads.
constexpr int kBandRows = 8;
static_assert(kBandRows % kBlockHeight == 0);
/// Number of cameras with cached rays.
constexpr std::size_t kCameras = 8;

std::uint8_t toByte(float value) {
  return static_cast<std::uint8_t>(std::clamp(value * 255.0f + 0.5f, 0.0f, 255.0f));
}

/// The viewing rays of a camera, of unit length, in its own frame.
struct RayTable {
  CameraIntrinsics intrinsics;
  std::vector<Eigen::Vector3f> rays;  ///< of the pixels' centres, row by row
  float pixel_rad = 0.0f;             ///< angle of a pixel in the image's middle
  /// Corners of the image, as it would be without distortion [px].
  Eigen::Vector2d ideal_low = Eigen::Vector2d::Zero();
  Eigen::Vector2d ideal_high = Eigen::Vector2d::Zero();

  explicit RayTable(const CameraIntrinsics& k)
      : intrinsics(k), pixel_rad(static_cast<float>(1.0 / std::max(k.fx, k.fy))) {
    rays.reserve(static_cast<std::size_t>(k.width) * k.height);
    for (int v = 0; v < k.height; ++v) {
      for (int u = 0; u < k.width; ++u) {
        const Eigen::Vector2d ideal = undistortPixel(k, Eigen::Vector2d(u, v));
        ideal_low = ideal_low.cwiseMin(ideal);
        ideal_high = ideal_high.cwiseMax(ideal);
        const Eigen::Vector3d ray = idealPixelRay(k, ideal);
        rays.emplace_back(ray.normalized().cast<float>());
      }
    }
  }

  const Eigen::Vector3f& at(int u, int v) const {
    return rays[static_cast<std::size_t>(v) * intrinsics.width + u];
  }
  /// Change of the ray from a pixel to its right and lower neighbour.
  Eigen::Vector3f toRight(int u, int v) const {
    const int low = std::max(u - 1, 0);
    const int high = std::min(u + 1, intrinsics.width - 1);
    return high == low ? Eigen::Vector3f::Zero().eval()
                       : ((at(high, v) - at(low, v)) / static_cast<float>(high - low)).eval();
  }
  Eigen::Vector3f below(int u, int v) const {
    const int low = std::max(v - 1, 0);
    const int high = std::min(v + 1, intrinsics.height - 1);
    return high == low ? Eigen::Vector3f::Zero().eval()
                       : ((at(u, high) - at(u, low)) / static_cast<float>(high - low)).eval();
  }
};

}  // namespace

struct Renderer::Impl {
  RendererOptions options;
  RenderScene scene;
  Shader shader;
  NarrowBodies narrow;
  std::vector<char> narrow_marks;  ///< of all pixels; empty: none
  std::list<RayTable> tables;      ///< the last used first
  /// Colour and body of every pixel's centre, kept from frame to frame for their memory.
  std::array<std::vector<float>, 3> colors;
  std::vector<int> slots;

  Impl(const World& world, RendererOptions o) : options(std::move(o)), scene(world), shader(world, scene) {
    for (const auto& model : world.models) narrow.add(model);
  }

  const RayTable& tableFor(const CameraIntrinsics& k) {
    if (const auto problem = checkIntrinsics(k); !problem.empty()) {
      throw std::invalid_argument("camera to render: " + problem);
    }
    const auto known =
        std::find_if(tables.begin(), tables.end(), [&](const auto& table) { return table.intrinsics == k; });
    if (known != tables.end()) {
      tables.splice(tables.begin(), tables, known);
    } else {
      tables.emplace_front(k);
      if (tables.size() > kCameras) tables.pop_back();
    }
    return tables.front();
  }

  /// Rows [first, last) of every band, maybe on other threads.
  void forBands(int height, const std::function<void(int first, int last)>& rows) const {
    const int bands = (height + kBandRows - 1) / kBandRows;
    const auto task = [&](int band) { rows(band * kBandRows, std::min(height, (band + 1) * kBandRows)); };
    if (options.parallel_for) {
      options.parallel_for(bands, task);
    } else {
      for (int band = 0; band < bands; ++band) task(band);
    }
  }

  /// Intersects the pixels' centre rays of some rows, block by block.
  /// @param use takes a packet, how many lanes it has, and the pixels' indices.
  template <typename Use>
  void traceRows(const RayTable& table, const Pose3& T_world_camera, int first, int last,
                 const Use& use) const {
    const Eigen::Matrix3f R = T_world_camera.linear().cast<float>();
    const Eigen::Vector3f origin = T_world_camera.translation().cast<float>();
    const int width = table.intrinsics.width;
    RayPacket packet;
    std::array<int, kPacket> pixels;
    for (int v0 = first; v0 < last; v0 += kBlockHeight) {
      for (int u0 = 0; u0 < width; u0 += kBlockWidth) {
        int n = 0;
        for (int v = v0; v < std::min(v0 + kBlockHeight, last); ++v) {
          for (int u = u0; u < std::min(u0 + kBlockWidth, width); ++u) {
            const Eigen::Vector3f d = R * table.at(u, v);
            packet.set(n, origin, d.x(), d.y(), d.z(), kRayStart_m);
            pixels[n++] = v * width + u;
          }
        }
        packet.finish(n);
        scene.intersect(packet);
        use(packet, n, pixels);
      }
    }
  }

  /// Marks pixels of one row or of two where they differ from their neighbour `step` further on.
  void markSteps(int from, int count, int step, char* here, char* there) const {
    const int* slot = slots.data() + from;
    const float* r = colors[0].data() + from;
    const float* g = colors[1].data() + from;
    const float* b = colors[2].data() + from;
    constexpr float kStep = kContrast / 255.0f;
    for (int i = 0; i < count; ++i) {
      const int j = i + step;
      const int differs =
          static_cast<int>(slot[i] != slot[j]) | static_cast<int>(std::abs(r[i] - r[j]) > kStep) |
          static_cast<int>(std::abs(g[i] - g[j]) > kStep) | static_cast<int>(std::abs(b[i] - b[j]) > kStep);
      here[i] = static_cast<char>(here[i] | differs);
      there[i] = static_cast<char>(there[i] | differs);
    }
  }
  /// For the pixels of some rows: whether they differ from a direct neighbour, whichever packet it was in.
  void findSteps(int first, int last, int width, int height, std::vector<char>& marks) const {
    marks.assign(static_cast<std::size_t>(last - first + 2) * width, 0);  // a row more above and below
    for (int v = std::max(first - 1, 0); v < last; ++v) {
      char* row = marks.data() + static_cast<std::size_t>(v - first + 1) * width;
      markSteps(v * width, width - 1, 1, row, row + 1);
      if (v + 1 < height) markSteps(v * width, width, width, row, row + width);
    }
  }

  /// Writes some rows of the image, with four rays for those pixels that need them.
  void refineRows(const RayTable& table, const Pose3& T_world_camera, int first, int last,
                  cv::Mat& image) const {
    const Eigen::Matrix3f R = T_world_camera.linear().cast<float>();
    const Eigen::Vector3f origin = T_world_camera.translation().cast<float>();
    const int width = table.intrinsics.width;
    const int height = table.intrinsics.height;
    const auto write = [&](int pixel, const Eigen::Vector3f& color) {
      std::uint8_t* bytes = image.data + 3 * static_cast<std::size_t>(pixel);
      for (int c = 0; c < 3; ++c) bytes[c] = toByte(color[c]);
    };
    std::vector<char> marks;
    findSteps(first, last, width, height, marks);
    RayPacket packet;
    std::array<Shaded, kPacket> fine;
    std::array<int, kPacket / kSamples> waiting;
    int count = 0;
    const auto flush = [&] {
      if (count == 0) return;
      packet.finish(count * kSamples);
      scene.intersect(packet);
      shader.shade(packet, count * kSamples, 0.5f * table.pixel_rad, fine.data());
      for (int p = 0; p < count; ++p) {
        Eigen::Vector3f color = Eigen::Vector3f::Zero();
        for (int s = 0; s < kSamples; ++s) {
          color += fine[p * kSamples + s].color.cwiseMin(1.0f) / static_cast<float>(kSamples);
        }
        write(waiting[p], color);
      }
      count = 0;
    };
    for (int v = first; v < last; ++v) {
      for (int u = 0; u < width; ++u) {
        const int pixel = v * width + u;
        const bool may_hide_some = !narrow_marks.empty() && narrow_marks[pixel] != 0;
        if (marks[static_cast<std::size_t>(pixel - (first - 1) * width)] == 0 && !may_hide_some) {
          write(pixel, {colors[0][pixel], colors[1][pixel], colors[2][pixel]});
          continue;
        }
        const Eigen::Vector3f centre = R * table.at(u, v);
        const Eigen::Vector3f right = R * table.toRight(u, v);
        const Eigen::Vector3f down = R * table.below(u, v);
        for (int s = 0; s < kSamples; ++s) {
          const Eigen::Vector3f d = centre + kSubPixels[s][0] * right + kSubPixels[s][1] * down;
          packet.set(count * kSamples + s, origin, d.x(), d.y(), d.z(), kRayStart_m);
        }
        waiting[count++] = pixel;
        if (count == static_cast<int>(waiting.size())) flush();
      }
    }
    flush();
  }

  void prepare(const Pose3& T_world_camera) {
    if (!T_world_camera.matrix().allFinite()) {
      throw std::invalid_argument("camera to render: its pose is not finite");
    }
    scene.commit();
  }
};

Renderer::Renderer(const World& world, RendererOptions options)
    : impl_(std::make_unique<Impl>(world, std::move(options))) {}
Renderer::~Renderer() = default;

int Renderer::addModel(const WorldModel& model) {
  const int index = impl_->scene.addModel(model);
  impl_->shader.addSlots();
  impl_->narrow.add(model);
  return index;
}

int Renderer::modelCount() const {
  return impl_->scene.modelCount();
}

void Renderer::setModelPose(int model, const Pose3& T_world_model) {
  impl_->scene.setPose(model, T_world_model);
}

void Renderer::setModelVisible(int model, bool visible) {
  impl_->scene.setVisible(model, visible);
}

cv::Mat Renderer::render(const CameraIntrinsics& k, const Pose3& T_world_camera) {
  Impl& m = *impl_;
  enterStage(m.options.probe, "prepare");
  const RayTable& table = m.tableFor(k);
  m.prepare(T_world_camera);
  enterStage(m.options.probe, "first rays");
  for (auto& plane : m.colors) plane.resize(table.rays.size());
  m.slots.resize(table.rays.size());
  m.forBands(k.height, [&](int first, int last) {
    std::array<Shaded, kPacket> colors;
    m.traceRows(table, T_world_camera, first, last, [&](const RayPacket& packet, int n, const auto& pixels) {
      m.shader.shade(packet, n, table.pixel_rad, colors.data());
      for (int i = 0; i < n; ++i) {
        m.slots[pixels[i]] = colors[i].slot;
        for (int c = 0; c < 3; ++c) m.colors[c][pixels[i]] = colors[i].color[c];
      }
    });
  });
  enterStage(m.options.probe, "antialiasing");
  m.narrow.mark(k, T_world_camera, table.ideal_low, table.ideal_high, m.scene, m.narrow_marks);
  cv::Mat image(k.height, k.width, CV_8UC3);
  m.forBands(k.height, [&](int first, int last) { m.refineRows(table, T_world_camera, first, last, image); });
  return image;
}

TruthImages Renderer::renderTruth(const CameraIntrinsics& k, const Pose3& T_world_camera) {
  Impl& m = *impl_;
  const RayTable& table = m.tableFor(k);
  m.prepare(T_world_camera);
  TruthImages truth{cv::Mat(k.height, k.width, CV_32F), cv::Mat(k.height, k.width, CV_32S),
                    cv::Mat(k.height, k.width, CV_32S)};
  auto* depth = truth.depth_m.ptr<float>();
  auto* model = truth.model.ptr<std::int32_t>();
  auto* body = truth.body.ptr<std::int32_t>();
  m.forBands(k.height, [&](int first, int last) {
    m.traceRows(table, T_world_camera, first, last, [&](const RayPacket& packet, int n, const auto& pixels) {
      for (int i = 0; i < n; ++i) {
        const int at = pixels[i];
        const bool hit = packet.slot[i] != kNoSlot;
        depth[at] =
            hit ? packet.rays.ray.tfar[i] * table.rays[at].z() : std::numeric_limits<float>::infinity();
        model[at] = hit ? m.scene.slot(packet.slot[i]).model : TruthImages::kNothing;
        body[at] = hit ? m.scene.slot(packet.slot[i]).body : TruthImages::kNothing;
      }
    });
  });
  return truth;
}

std::optional<RayHit> Renderer::cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
  Impl& m = *impl_;
  m.scene.commit();
  const Eigen::Vector3f d = direction.normalized().cast<float>();
  RayPacket packet;
  packet.set(0, origin.cast<float>(), d.x(), d.y(), d.z(), 0.0f);
  packet.finish(1);
  m.scene.intersect(packet);
  if (packet.slot[0] == kNoSlot) return std::nullopt;
  Shaded shaded;
  m.shader.shade(packet, 1, 0.0f, &shaded);
  const BodySlot& slot = m.scene.slot(packet.slot[0]);
  Eigen::Vector3f normal(packet.nx[0], packet.ny[0], packet.nz[0]);
  normal.normalize();
  const bool from_inside = normal.dot(d) > 0.0f;
  if (from_inside) normal = -normal;
  return RayHit{packet.rays.ray.tfar[0], slot.model,   slot.body,
                normal.cast<double>(),   shaded.color, from_inside};
}

}  // namespace vismem
