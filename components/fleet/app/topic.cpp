#include "fleet/app/topic.h"

#include <IceStorm/IceStorm.h>

#include <utility>

namespace vismem {

RobotTopic::RobotTopic(ComponentHost& host, const std::string& manager, std::string name)
    : manager_(host.peer<IceStorm::TopicManagerPrx>("TopicManager", manager)), name_(std::move(name)) {}

RobotTopic::~RobotTopic() = default;

bool RobotTopic::publish(const avm::RobotReport& report) {
  const auto done = manager_->call([&](IceStorm::TopicManagerPrx& manager) {
    if (!publisher_) {
      std::shared_ptr<IceStorm::TopicPrx> topic;
      try {
        topic = manager.retrieve(name_);
      } catch (const IceStorm::NoSuchTopic&) {
        try {
          topic = manager.create(name_);
        } catch (const IceStorm::TopicExists&) {
          topic = manager.retrieve(name_);  // another robot was faster
        }
      }
      publisher_ = Ice::uncheckedCast<avm::FleetListenerPrx>(topic->getPublisher());
    }
    // Twoway: IceStorm has the report when this returns, or a failure shows.
    publisher_->report(report);
  });
  if (!done) publisher_ = nullptr;
  return done;
}

}  // namespace vismem
