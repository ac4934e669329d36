#include "common/recording/transform_tree.h"

#include <algorithm>
#include <set>

namespace vismem {

void TransformTree::add(const std::string& parent, const std::string& child, StampUs stamp_us,
                        const Pose3& T_parent_child) {
  Edge& edge = edges_[child];
  if (edge.is_static || edge.parent != parent) edge = Edge{parent, false, {}};
  edge.poses.insert_or_assign(stamp_us, T_parent_child);
}

void TransformTree::addStatic(const std::string& parent, const std::string& child,
                              const Pose3& T_parent_child) {
  edges_[child] = Edge{parent, true, {{0, T_parent_child}}};
}

bool TransformTree::contains(const std::string& frame) const {
  return edges_.contains(frame) || std::any_of(edges_.begin(), edges_.end(),
                                               [&](const auto& item) { return item.second.parent == frame; });
}

std::vector<std::string> TransformTree::frames() const {
  std::set<std::string> names;
  for (const auto& [child, edge] : edges_) {
    names.insert(child);
    names.insert(edge.parent);
  }
  return {names.begin(), names.end()};
}

std::vector<std::string> TransformTree::pathToRoot(const std::string& frame) const {
  std::vector<std::string> path{frame};
  for (auto edge = edges_.find(frame); edge != edges_.end(); edge = edges_.find(path.back())) {
    // A defective log may contain a loop.
    if (std::find(path.begin(), path.end(), edge->second.parent) != path.end()) break;
    path.push_back(edge->second.parent);
  }
  return path;
}

bool TransformTree::connected(const std::string& a, const std::string& b) const {
  return contains(a) && contains(b) && pathToRoot(a).back() == pathToRoot(b).back();
}

std::optional<Pose3> TransformTree::edgeAt(const Edge& edge, StampUs stamp_us) const {
  if (edge.is_static) return edge.poses.begin()->second;
  const auto after = edge.poses.lower_bound(stamp_us);
  if (after == edge.poses.end()) return std::nullopt;
  if (after->first == stamp_us) return after->second;
  if (after == edge.poses.begin()) return std::nullopt;
  const auto before = std::prev(after);
  const StampUs gap = after->first - before->first;
  if (gap > max_gap_us_) return std::nullopt;
  return interpolate(before->second, after->second,
                     static_cast<double>(stamp_us - before->first) / static_cast<double>(gap));
}

std::optional<Pose3> TransformTree::lookup(const std::string& a, const std::string& b,
                                           StampUs stamp_us) const {
  if (!connected(a, b)) return std::nullopt;
  auto from_a = pathToRoot(a);
  auto from_b = pathToRoot(b);
  // The common part of both paths, such as the robot's pose in odom, is not needed.
  while (from_a.size() > 1 && from_b.size() > 1 && from_a[from_a.size() - 2] == from_b[from_b.size() - 2]) {
    from_a.pop_back();
    from_b.pop_back();
  }
  const auto poseInCommon = [&](const std::vector<std::string>& path) -> std::optional<Pose3> {
    Pose3 pose = Pose3::Identity();
    for (std::size_t i = 0; i + 1 < path.size(); ++i) {
      const auto step = edgeAt(edges_.at(path[i]), stamp_us);
      if (!step) return std::nullopt;
      pose = *step * pose;
    }
    return pose;
  };
  const auto T_common_a = poseInCommon(from_a);
  const auto T_common_b = poseInCommon(from_b);
  if (!T_common_a || !T_common_b) return std::nullopt;
  return Pose3(T_common_a->inverse() * *T_common_b);
}

}  // namespace vismem
