/// @file Agreement of the shapes in memory with the true shapes on the floor. Pure. See M8, M9.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "common/geometry/camera.h"
#include "common/segment_map/segment_map.h"
#include "common/visual_memory/memory_snapshot.h"
#include "evaluation/core/floor_truth.h"

namespace vismem {

/// A shape as it is drawn on the floor, in world [m].
struct TrueShape {
  PrimitiveKind kind = PrimitiveKind::kParallelogram;
  std::string name;
  /// As Primitive::vertices of its kind; a circle has none.
  std::vector<Eigen::Vector2d> vertices;
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double outer_radius_m = 0.0;
  double inner_radius_m = 0.0;  ///< of a circle: 0 when it is filled
  double width_m = 0.0;         ///< of a stripe, or of the lines an arrow is drawn with
  bool painted = true;          ///< false: the foot of an object
};

/// Reads `kind,name,on,width_m,outer_radius_m,inner_radius_m,x1_m,y1_m,...,x4_m,y4_m` (that header first; `#`
/// begins a comment). A parallelogram on a `stripe` is a kStripe.
/// @throws ConfigError with every problem: FILE:LINE, what was found, what was expected.
std::vector<TrueShape> parseTrueShapes(std::string_view text, const std::string& file_name);

/// The lines that must have been seen of a shape: its outline, an arrow's strokes, a circle's outer edge.
std::vector<Segment2> outlineOf(const TrueShape& shape);

/// The parts of the shapes that images showed. *Single-threaded*.
class ShapeTruth {
 public:
  explicit ShapeTruth(std::vector<TrueShape> shapes);

  /// Adds the visible parts of one image, as FloorTruth::addView.
  void addView(const CameraIntrinsics& intrinsics, const Pose3& T_world_camera, const SeesFloor& sees);

  const std::vector<TrueShape>& shapes() const { return shapes_; }
  /// Share of the outline's length that the images showed.
  double seenShare(std::size_t shape) const;
  /// @return whether any image showed this corner.
  bool seenCorner(std::size_t shape, std::size_t corner) const;
  /// Resolution of a corner [m]: the floor that one pixel covers, in the nearest view of the seen part of the
  /// outline that is nearest to the corner.
  double footprint(std::size_t shape, const Eigen::Vector2d& corner, double focal_px) const;

 private:
  std::vector<TrueShape> shapes_;
  std::vector<FloorTruth> outlines_;
};

struct ShapeScoreParams {
  double corner_m = 0.10;  ///< tolerance of a corner or a circle's centre, beside a pixel's footprint
  double radius_m = 0.05;  ///< tolerance of a circle's radius, beside the width of its line
  double focal_px = 277.1;
};

/// A remembered shape and the true shape it was matched with.
struct JudgedShape {
  Primitive world;  ///< brought into world
  int true_shape = -1;
  double error_m = 0.0;  ///< mean over the corners; 0 without a true shape
};

/// Matches remembered shapes (in world) with true ones, one-to-one, the nearest first.
std::vector<JudgedShape> judgeShapes(const std::vector<Primitive>& world, const ShapeTruth& truth,
                                     const ShapeScoreParams& params = {});

/// The memory's shapes in world, placed by the true pose of the robot.
std::vector<Primitive> shapesIn(const MemorySnapshot& memory, const Pose2& T_world_robot);

/// "parallelogram", "triangle", "arrow", "circle", "stripe".
const char* nameOf(PrimitiveKind kind);

}  // namespace vismem
