/// @file avm::Component over a StatusBoard.
#pragma once

#include <avm/component.h>

#include "common/process/status.h"

namespace vismem {

avm::ComponentStatus toSlice(const StatusReport& report);
/// As it was told; a peer that is away counts as lost, whether it was ever there or not.
StatusReport fromSlice(const avm::ComponentStatus& status);

/// Serves the status of this process. Thread-safe. The board must outlive it.
class ComponentServant : public avm::Component {
 public:
  explicit ComponentServant(const StatusBoard& status) : status_(status) {}

  avm::ComponentStatus getStatus(const Ice::Current& current) override;
  avm::SettingSeq getConfiguration(const Ice::Current& current) override;

 private:
  const StatusBoard& status_;
};

}  // namespace vismem
