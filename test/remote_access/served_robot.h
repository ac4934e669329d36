/// @file A whole simulated robot with a replayed log beside it, served over tcp and WebSocket with tokens.
#pragma once

#include <Ice/Ice.h>

#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "support/component_process.h"
#include "support/temporary_folder.h"
#include "untrusted_clients/slice_model.h"

namespace vismem::test {

inline constexpr const char* kToken = "OperatorTokenOfThisTest";
inline constexpr const char* kViewToken = "ViewerTokenOfThisTest";

/// One object of a component.
struct ServedObject {
  const ComponentProcess* process = nullptr;
  std::string component;
  std::string identity;  ///< without a robot's name: "cameraA", "localization/component"
  std::string face_name;
  const SliceInterface* interface = nullptr;  ///< the widest of its interfaces
};

/// What became of a call.
enum class Answer { kPassed, kNoObject, kNoOperation };

class ServedRobot {
 public:
  ServedRobot();
  ~ServedRobot();

  const SliceModel& model() const { return model_; }
  const std::vector<ServedObject>& objects() const { return objects_; }
  std::vector<std::unique_ptr<ComponentProcess>>& processes() { return processes_; }
  Ice::Communicator& communicator() { return *communicator_.communicator(); }

  /// @param web over WebSocket, else over tcp.
  std::string endpoints(const ComponentProcess& process, bool web) const;
  std::shared_ptr<Ice::ObjectPrx> proxy(const ServedObject& object, const Ice::Identity& identity,
                                        bool web) const;
  /// Calls an operation with no parameters at all: one that has some answers that they are missing, and does
  /// nothing.
  Answer call(const ServedObject& object, const Ice::Identity& identity, bool web,
              const SliceOperation& operation) const;

 private:
  ComponentProcess& start(const std::string& name, const std::string& prefix,
                          std::vector<std::string> arguments);
  void list(const ComponentProcess& process, const std::string& component,
            std::vector<std::string> identities);

  const SliceModel model_;
  Ice::CommunicatorHolder communicator_;
  std::filesystem::path bag_;
  TemporaryFolder recordings_;
  std::vector<std::unique_ptr<ComponentProcess>> processes_;
  std::vector<ServedObject> objects_;
};

}  // namespace vismem::test
