// Commands to a running simulation: checked here and executed on the simulation's thread.
#include <algorithm>
#include <memory>
#include <optional>

#include "common/config/config_error.h"
#include "simulator/app/real_time_simulation.h"

namespace vismem {
namespace {

constexpr int kMaxSteps = 1000;
constexpr int kMaxConsumers = 64;

}  // namespace

PortReply RealTimeSimulation::kidnap(const Pose2& T_world_robot) {
  return execute([=](Simulation& s) { return s.kidnap(T_world_robot); });
}

PortReply RealTimeSimulation::pause() {
  return execute([this](Simulation&) {
    const std::lock_guard lock(mutex_);
    status_.paused = true;
    return PortReply::accepted();
  });
}

PortReply RealTimeSimulation::resume() {
  return execute([this](Simulation&) {
    const std::lock_guard lock(mutex_);
    // A repeated command must not set the clock back each time: it would never reach the next step.
    clock_changed_ = clock_changed_ || status_.paused;
    status_.paused = false;
    return PortReply::accepted();
  });
}

PortReply RealTimeSimulation::setSpeed(double speed) {
  if (!(speed >= 0.01 && speed <= 1000.0)) {
    return PortReply::rejected("speed " + std::to_string(speed) + " (must be 0.01..1000)");
  }
  return execute([this, speed](Simulation&) {
    const std::lock_guard lock(mutex_);
    clock_changed_ = clock_changed_ || status_.speed != speed;
    status_.speed = speed;
    return PortReply::accepted();
  });
}

PortReply RealTimeSimulation::step(int steps) {
  if (steps < 1 || steps > kMaxSteps) {
    return PortReply::rejected("steps " + std::to_string(steps) + " (must be 1.." +
                               std::to_string(kMaxSteps) + ")");
  }
  return execute([this, steps](Simulation& s) {
    {
      const std::lock_guard lock(mutex_);
      if (!status_.paused) return PortReply::rejected("time goes by itself: pause it first");
    }
    for (int i = 0; i < steps; ++i) s.step();
    publishSamples();
    return PortReply::accepted();
  });
}

PortReply RealTimeSimulation::setLockStep(int consumers) {
  if (consumers < 0 || consumers > kMaxConsumers) {
    return PortReply::rejected("consumers " + std::to_string(consumers) + " (must be 0.." +
                               std::to_string(kMaxConsumers) + ")");
  }
  return execute([this, consumers](Simulation&) {
    clock_changed_ = true;
    const std::lock_guard lock(mutex_);
    status_.lock_step = consumers;
    return PortReply::accepted();
  });
}

PortReply RealTimeSimulation::reset(std::uint64_t seed) {
  return execute([this, seed](Simulation& s) {
    s.reset(seed);
    clock_changed_ = true;
    measured_wall_ = {};
    {
      const std::lock_guard lock(mutex_);
      status_.seed = seed;
      pan_tilt_samples_.clear();
      odometry_samples_.clear();
      truth_samples_.clear();
      std::fill(frames_.begin(), frames_.end(), std::nullopt);
    }
    publishSamples();
    return PortReply::accepted();
  });
}

std::vector<ModelStatus> RealTimeSimulation::models() {
  // Shared: the command may outlive a caller who gave up.
  const auto result = std::make_shared<std::vector<ModelStatus>>();
  const PortReply reply = execute([result](Simulation& s) {
    *result = s.scene().status();
    return PortReply::accepted();
  });
  return reply.ok() ? *result : std::vector<ModelStatus>{};
}

PortReply RealTimeSimulation::addModel(const std::string& name, const PropShape& shape,
                                       const Pose3& T_world_model) {
  return execute([=](Simulation& s) { return s.scene().add(name, shape, T_world_model); });
}

PortReply RealTimeSimulation::removeModel(const std::string& name) {
  return execute([=](Simulation& s) { return s.scene().remove(name); });
}

PortReply RealTimeSimulation::placeModel(const std::string& name, const Pose3& T_world_model) {
  return execute([=](Simulation& s) { return s.scene().place(name, T_world_model); });
}

PortReply RealTimeSimulation::walkModel(const std::string& name, const Way& way) {
  return execute([=](Simulation& s) { return s.scene().walk(name, way); });
}

PortReply RealTimeSimulation::standModel(const std::string& name) {
  return execute([=](Simulation& s) { return s.scene().stand(name); });
}

PortReply RealTimeSimulation::slip(double left_m, double right_m) {
  return execute([=](Simulation& s) { return s.slip({left_m, right_m}); });
}

PortReply RealTimeSimulation::playScenario(const std::string& text) {
  if (text.empty()) {
    return execute([](Simulation& s) {
      s.stopScenario();
      return PortReply::accepted();
    });
  }
  try {
    return execute([scenario = parseScenario(text, "scenario")](Simulation& s) { return s.play(scenario); });
  } catch (const ConfigError& error) {
    return PortReply::rejected(error.what());
  }
}

}  // namespace vismem
