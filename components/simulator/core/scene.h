/// @file Where the models of a simulated world stand while it runs. Pure.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/robot/control_ports.h"
#include "common/routes/route.h"
#include "simulator/core/world.h"

namespace vismem {

class Renderer;

/// All models at one instant. Immutable once shared: frames keep it until they are rendered.
struct SceneState {
  struct Model {
    Pose3 pose = Pose3::Identity();
    bool visible = true;
  };
  std::vector<Model> models;  ///< by index
};

/// @return what is wrong with a way; empty if nothing is.
std::string checkWay(const Way& way);

/// The models of a world, those that were added, and which of them walk. Names are unique; an index stays
/// with its model. *Single-threaded*.
class MovingWorld {
 public:
  explicit MovingWorld(const World& world);

  std::optional<int> find(const std::string& name) const;
  std::vector<ModelStatus> status() const;
  /// Rejected for a name in use, a shape or pose that makes no sense, and beyond 1000 added models.
  PortReply add(const std::string& name, const PropShape& shape, const Pose3& T_world_model);
  PortReply remove(const std::string& name);
  /// Also brings a removed model back; it stands where it is put.
  PortReply place(const std::string& name, const Pose3& T_world_model);
  /// From its nearest place of the route on; it looks where it goes. Brings a removed model back.
  PortReply walk(const std::string& name, const Way& way);
  PortReply stand(const std::string& name);

  /// Walkers move. One that would run into the robot waits until the robot has gone.
  void step(double dt_s, const Pose2& T_world_robot, double robot_radius_m);

  const std::vector<WorldObstacle>& obstacles() const { return obstacles_; }
  /// Counts up whenever a model moved, came or went.
  std::uint64_t revision() const { return revision_; }
  std::shared_ptr<const SceneState> state() const;
  /// Brings a renderer, made for the same world, to a state of this scene. @param shown what it showed last.
  void show(const SceneState& state, Renderer& renderer, SceneState& shown) const;

 private:
  struct Walker {
    int model = 0;
    Route route;
    double speed_mps = 0.0;
    WayEnd at_end = WayEnd::kBack;
    double along_m = 0.0;
    double way = 1.0;  ///< -1 on the way back
  };

  std::optional<int> findOrSay(const std::string& name, PortReply& reply) const;
  void changed();
  void stopWalking(int model);
  Pose3 poseOf(const Walker& walker) const;

  std::vector<WorldModel>
      models_;  ///< those that were added keep their bodies, for renderers that do not know them
  std::size_t of_world_;
  SceneState now_;
  mutable std::shared_ptr<const SceneState> shared_;
  std::vector<Walker> walkers_;
  std::vector<WorldObstacle> obstacles_;
  std::uint64_t revision_ = 0;
};

}  // namespace vismem
