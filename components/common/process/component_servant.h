/// @file avm::Component over what the process knows of itself.
#pragma once

#include <avm/component.h>

#include "common/process/log_ring.h"
#include "common/process/parameter_table.h"
#include "common/process/status.h"

namespace vismem {

avm::ComponentState toSlice(RunState state);
avm::ComponentStatus toSlice(const StatusReport& report);
/// The received status as a value; an absent peer counts as lost, even before its first connection.
StatusReport fromSlice(const avm::ComponentStatus& status);

/// Serves status, log and parameters of this process. Thread-safe. All three must outlive it.
class ComponentServant : public avm::Component {
 public:
  ComponentServant(const StatusBoard& status, const LogRing& log, ParameterTable& parameters)
      : status_(status), log_(log), parameters_(parameters) {}

  avm::ComponentStatus getStatus(const Ice::Current& current) override;
  avm::SettingSeq getConfiguration(const Ice::Current& current) override;
  avm::LogBatch getLog(Ice::Long after_sequence, avm::LogLevel lowest, int most,
                       const Ice::Current& current) override;
  avm::ParameterSeq parameters(const Ice::Current& current) override;
  avm::CommandReply setParameter(std::string name, double value, const Ice::Current& current) override;

 private:
  const StatusBoard& status_;
  const LogRing& log_;
  ParameterTable& parameters_;
};

}  // namespace vismem
