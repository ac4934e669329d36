#include "common/process/faces.h"

#include <utility>

#include "common/process/operation_table.h"

namespace vismem {

void FaceObjects::add(const std::string& name, std::shared_ptr<Ice::Object> servant) {
  Object object{servant, readingOperations(servant->ice_ids(Ice::Current()))};
  const std::scoped_lock lock(mutex_);
  objects_[name] = std::move(object);
}

FaceObjects::Object FaceObjects::find(const std::string& name) const {
  const std::scoped_lock lock(mutex_);
  const auto found = objects_.find(name);
  return found == objects_.end() ? Object{} : found->second;
}

bool Face::dispatch(Ice::Request& request) {
  const Ice::Current& current = request.getCurrent();
  const auto object = objects_->find(current.id.name);
  if (object.servant == nullptr || !current.facet.empty())
    throw Ice::ObjectNotExistException(__FILE__, __LINE__, current.id, current.facet, current.operation);
  if (rights_ == Rights::kRead && !object.reading.contains(current.operation))
    throw Ice::OperationNotExistException(__FILE__, __LINE__, current.id, current.facet, current.operation);
  return object.servant->ice_dispatch(request);
}

void addViewFace(Ice::ObjectAdapter& adapter, const RobotKeys& robot,
                 std::shared_ptr<const FaceObjects> objects) {
  adapter.addDefaultServant(std::make_shared<Face>(std::move(objects), Face::Rights::kRead),
                            robot.viewCategory());
}

void addWebFaces(Ice::ObjectAdapter& adapter, const RobotKeys& robot,
                 std::shared_ptr<const FaceObjects> objects) {
  // An empty category would make a default servant for all identities.
  if (const auto category = robot.tokenCategory(); !category.empty())
    adapter.addDefaultServant(std::make_shared<Face>(objects, Face::Rights::kAll), category);
  if (const auto category = robot.viewTokenCategory(); !category.empty())
    adapter.addDefaultServant(std::make_shared<Face>(std::move(objects), Face::Rights::kRead), category);
}

}  // namespace vismem
