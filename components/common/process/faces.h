/// @file The objects of a process under further categories, with all operations or only the reading ones.
#pragma once

#include <Ice/Ice.h>

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "common/process/robot_identity.h"

namespace vismem {

/// The objects that a process serves, by their name in a face. *Thread-safe.*
class FaceObjects {
 public:
  struct Object {
    std::shared_ptr<Ice::Object> servant;
    std::set<std::string, std::less<>> reading;  ///< names of its operations that only read
  };

  void add(const std::string& name, std::shared_ptr<Ice::Object> servant);
  /// @return an object without a servant if there is none of the name.
  Object find(const std::string& name) const;

 private:
  mutable std::mutex mutex_;
  std::map<std::string, Object> objects_;
};

/// Default servant of one category. Passes a call on to the object of that name, if the caller may make it.
/// Otherwise Ice::ObjectNotExistException, or Ice::OperationNotExistException for a changing operation of a
/// read-only face. *Thread-safe.*
class Face : public Ice::DispatchInterceptor {
 public:
  enum class Rights { kRead, kAll };

  Face(std::shared_ptr<const FaceObjects> objects, Rights rights)
      : objects_(std::move(objects)), rights_(rights) {}

  bool dispatch(Ice::Request& request) override;

 private:
  const std::shared_ptr<const FaceObjects> objects_;
  const Rights rights_;
};

/// Serves the read-only face on an adapter for plain endpoints: category ROBOT.view.
void addViewFace(Ice::ObjectAdapter& adapter, const RobotKeys& robot,
                 std::shared_ptr<const FaceObjects> objects);

/// Serves the faces for WebSocket on an adapter that has no other objects: ROBOT.TOKEN and
/// ROBOT.view.VIEWTOKEN. An Ice client in a web page sends whatever identity it likes, and Ice 3.7 does not
/// check the page's origin: what answers there is reached by secret identities alone.
void addWebFaces(Ice::ObjectAdapter& adapter, const RobotKeys& robot,
                 std::shared_ptr<const FaceObjects> objects);

}  // namespace vismem
