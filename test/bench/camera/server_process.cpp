#include "bench/camera/server_process.h"

#include <chrono>
#include <stdexcept>

#include "common/process/ice_setup.h"
#include "common/process/ready_line.h"
#include "support/ready_port.h"

namespace vismem {

ServerProcess::ServerProcess()
    : log_("bench", LogLevel::kWarning),
      process_({"/proc/self/exe", "--serve"}),
      communicator_(makeCommunicator(Properties{}, log_)) {
  const auto line = process_.waitForLine("ready: ", std::chrono::seconds(20));
  if (!line) throw std::runtime_error("the server does not start: " + process_.error());
  endpoint_ = *readyEndpoints(*line);
  port_ = *readyPort(*line, "tcp");
}

}  // namespace vismem
