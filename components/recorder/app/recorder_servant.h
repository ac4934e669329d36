/// @file avm::Recorder over the service. See C1.
#pragma once

#include <avm/recorder.h>

#include "recorder/app/recorder_service.h"

namespace vismem {

/// *Thread-safe*; the service must outlive the adapter. Commands are answered by the writer's thread: no
/// dispatch waits for the disk.
class RecorderServant : public avm::Recorder {
 public:
  explicit RecorderServant(RecorderService& service) : service_(service) {}

  avm::RecorderStatus status(const Ice::Current&) override;
  void startAsync(std::string name, std::function<void(const std::string&)> response,
                  std::function<void(std::exception_ptr)> exception, const Ice::Current&) override;
  void stopAsync(std::function<void(const std::string&)> response,
                 std::function<void(std::exception_ptr)> exception, const Ice::Current&) override;
  void markAsync(std::string text, std::function<void(Ice::Long)> response,
                 std::function<void(std::exception_ptr)> exception, const Ice::Current&) override;
  void saveRingAsync(std::string name, std::function<void(const std::string&)> response,
                     std::function<void(std::exception_ptr)> exception, const Ice::Current&) override;

 private:
  using Respond = std::function<void(const std::string&)>;
  using Except = std::function<void(std::exception_ptr)>;
  void run(RecorderService::Command command, Respond respond, Except except);

  RecorderService& service_;
};

}  // namespace vismem
