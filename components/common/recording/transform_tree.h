/// @file Poses of named frames over time, composed of the single transforms of a log. Pure. See G1, G3.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "common/geometry/pose.h"
#include "common/robot/samples.h"

namespace vismem {

/// Immutable while it is read; *single-threaded* while it is filled.
class TransformTree {
 public:
  /// @param max_gap_us transforms further apart than this are not interpolated between.
  explicit TransformTree(StampUs max_gap_us) : max_gap_us_(max_gap_us) {}

  /// Adds a transform; stamps may come in any order. A frame with another parent before gets the new one.
  void add(const std::string& parent, const std::string& child, StampUs stamp_us,
           const Pose3& T_parent_child);
  /// Adds a transform that is valid at any time.
  void addStatic(const std::string& parent, const std::string& child, const Pose3& T_parent_child);

  bool contains(const std::string& frame) const;
  bool empty() const { return edges_.empty(); }
  /// All frames, sorted.
  std::vector<std::string> frames() const;
  /// Whether the tree connects the two frames at any time.
  bool connected(const std::string& a, const std::string& b) const;

  /// T_a_b at a stamp. Each transform on the path is the one with exactly that stamp, else interpolated.
  /// @return empty when the frames are not connected, or a transform on the path is unknown at the stamp.
  std::optional<Pose3> lookup(const std::string& a, const std::string& b, StampUs stamp_us) const;

 private:
  struct Edge {
    std::string parent;
    bool is_static = false;
    std::map<StampUs, Pose3> poses;
  };

  std::vector<std::string> pathToRoot(const std::string& frame) const;
  std::optional<Pose3> edgeAt(const Edge& edge, StampUs stamp_us) const;

  StampUs max_gap_us_;
  std::map<std::string, Edge> edges_;  // by child
};

}  // namespace vismem
