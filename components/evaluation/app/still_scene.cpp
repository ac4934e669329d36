#include "evaluation/app/still_scene.h"

#include <memory>

#include "active_visual_memory/core/ground/floor_evidence.h"

namespace vismem {
namespace {

constexpr double kBeside_px = 3.0;
constexpr std::size_t kExposures = 4;

/// A walker's edge is one of which less than half the step of colours is left without the walkers.
EdgeOwner ownerOf(const std::optional<SideColours>& with, const std::optional<SideColours>& without) {
  if (!with || !without) return EdgeOwner::kNone;
  const Eigen::Vector3d step = with->left - with->right;
  const double left = step.dot(without->left - without->right);
  return left < 0.5 * step.squaredNorm() ? EdgeOwner::kMoving : EdgeOwner::kStill;
}

}  // namespace

StillScene::StillScene(Simulation& simulation)
    : simulation_(simulation), renderer_(simulation.config().world) {}

std::optional<Frame> StillScene::withoutWalkers(const Frame& frame) {
  const auto exposed = exposures_.find(frame.seq);
  if (exposed == exposures_.end() || walkers_.empty()) return std::nullopt;
  SceneState still = *exposed->second.scene;
  for (const std::size_t walker : walkers_) {
    if (walker < still.models.size()) still.models[walker].visible = false;
  }
  simulation_.scene().show(still, renderer_, shown_);
  Frame without = frame;
  without.image = renderer_.render(frame.intrinsics, exposed->second.T_world_camera);
  return without;
}

void StillScene::add(const LockstepFrame& frame) {
  if (const auto& exposed = simulation_.lastExposure()) exposures_[exposed->seq] = *exposed;
  while (exposures_.size() > kExposures) exposures_.erase(exposures_.begin());
  const std::vector<ModelStatus> models = simulation_.scene().status();
  for (std::size_t i = 0; i < models.size(); ++i) {
    if (models[i].walking) walkers_.insert(i);
  }
  const MemoryUpdate& update = frame.memory.update;
  const Frame& with = frame.observation.frame;
  if (!update.snapshot || !update.analysis || update.analysis->stamp_us != with.stamp_us) return;
  const auto without = withoutWalkers(with);
  if (!without) return;
  FloorEvidence::Params params;
  params.side_px = kBeside_px;
  const FloorEvidence shown(with.image, with.intrinsics, params);
  const FloorEvidence still(without->image, with.intrinsics, params);
  edges_.add(*update.snapshot, *update.analysis,
             [&](const Segment2& px) { return ownerOf(shown.sides(px), still.sides(px)); });
}

}  // namespace vismem
