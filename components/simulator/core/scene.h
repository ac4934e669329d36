/// @file The models of a running simulated world and their motion. Pure.
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

/// All models at one instant. Immutable once shared: frames hold it until they are rendered.
struct SceneState {
  struct Model {
    Pose3 pose = Pose3::Identity();
    bool visible = true;
  };
  std::vector<Model> models;  ///< by index
  std::uint64_t layout = 0;   ///< MovingWorld::layout() of these indices
};

/// @return the problem of a path; empty if it is valid.
std::string checkWay(const Way& way);

/// The models of a world, added models, and walking models. Names are unique; an index belongs to one model
/// while layout() stays. *Single-threaded*.
class MovingWorld {
 public:
  explicit MovingWorld(const World& world);

  std::optional<int> find(const std::string& name) const;
  std::vector<ModelStatus> status() const;
  /// Rejected for a name in use, an invalid shape or pose, and beyond 1000 added models. Where there are so
  /// many, removed ones are forgotten to make room: the indices change, and they cannot be placed again.
  PortReply add(const std::string& name, const PropShape& shape, const Pose3& T_world_model);
  PortReply remove(const std::string& name);
  /// Moves a model, also a removed one, which is then present again. A walking model stops.
  PortReply place(const std::string& name, const Pose3& T_world_model);
  /// Starts a walk at the path's nearest point; the model faces its direction of motion. A removed model is
  /// then present again.
  PortReply walk(const std::string& name, const Way& way);
  PortReply stand(const std::string& name);

  /// Moves the walking models. A model waits while the robot blocks its path.
  void step(double dt_s, const Pose2& T_world_robot, double robot_radius_m);

  const std::vector<WorldObstacle>& obstacles() const { return obstacles_; }
  /// Grows with every motion, addition or removal of a model.
  std::uint64_t revision() const { return revision_; }
  std::shared_ptr<const SceneState> state() const;
  /// Grows when indices change.
  std::uint64_t layout() const { return now_.layout; }
  /// Sets a renderer of the same world to a state of this scene; to the present one for a state of an earlier
  /// layout.
  /// @param renderer new since the last change of the layout.
  /// @param shown its previous state.
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
  /// @return whether a removed model made room.
  bool forgetRemoved();
  void stopWalking(int model);
  Pose3 poseOf(const Walker& walker) const;

  std::vector<WorldModel> models_;  ///< added models keep their bodies for renderers without them
  std::size_t of_world_;
  SceneState now_;
  mutable std::shared_ptr<const SceneState> shared_;
  std::vector<Walker> walkers_;
  std::vector<WorldObstacle> obstacles_;
  std::uint64_t revision_ = 0;
};

}  // namespace vismem
