#include "recorder/app/recorder_servant.h"

#include <utility>

#include "common/config/file_name.h"

namespace vismem {
namespace {

avm::RecorderState toIce(RecorderReport::State state) {
  switch (state) {
    case RecorderReport::State::kRecording:
      return avm::RecorderState::Recording;
    case RecorderReport::State::kFailed:
      return avm::RecorderState::Failed;
    case RecorderReport::State::kIdle:
      break;
  }
  return avm::RecorderState::Idle;
}

/// @throws avm::InvalidArgument.
std::string checkedName(const std::string& name) {
  if (const std::string wrong = checkFileName(name); !wrong.empty()) throw avm::InvalidArgument(wrong);
  return name;
}

}  // namespace

avm::RecorderStatus RecorderServant::status(const Ice::Current&) {
  const RecorderService::Status now = service_.status();
  avm::RecorderStatus status;
  status.state = toIce(now.report.state);
  status.message = now.report.message;
  status.path = now.report.path;
  status.parts = now.report.parts;
  status.bytes = static_cast<Ice::Long>(now.report.bytes);
  status.messages = static_cast<Ice::Long>(now.report.messages);
  status.beginUs = now.report.begin_us.value_or(0);
  status.endUs = now.report.end_us.value_or(0);
  status.queueBytes = static_cast<Ice::Long>(now.queue_bytes);
  status.queuePeakBytes = static_cast<Ice::Long>(now.queue_peak_bytes);
  status.queueLimitBytes = static_cast<Ice::Long>(now.queue_limit_bytes);
  status.ringS = toSeconds(now.report.ring_us);
  status.ringBytes = static_cast<Ice::Long>(now.report.ring_bytes);
  for (const auto& [topic, count] : now.counts) {
    status.topics.push_back({topic, count.type, static_cast<Ice::Long>(count.messages),
                             static_cast<Ice::Long>(count.bytes), static_cast<Ice::Long>(count.dropped),
                             static_cast<Ice::Long>(count.missed)});
  }
  return status;
}

void RecorderServant::run(RecorderService::Command command, Respond respond, Except except) {
  service_.execute(std::move(command),
                   [respond = std::move(respond), except = std::move(except)](const PortReply& reply) {
                     // A client that called oneway cannot be answered: that is its failure, not this
                     // thread's.
                     try {
                       if (!reply.ok()) throw avm::Refused(reply.message);
                       respond(reply.message);
                     } catch (...) {
                       except(std::current_exception());
                     }
                   });
}

void RecorderServant::startAsync(std::string name, Respond response, Except exception, const Ice::Current&) {
  run([name = name.empty() ? service_.unusedName()
                           : checkedName(name)](RecorderCore& core) { return core.start(name); },
      std::move(response), std::move(exception));
}

void RecorderServant::stopAsync(Respond response, Except exception, const Ice::Current&) {
  run([](RecorderCore& core) { return core.stop(); }, std::move(response), std::move(exception));
}

void RecorderServant::saveRingAsync(std::string name, Respond response, Except exception,
                                    const Ice::Current&) {
  run([name = name.empty() ? service_.unusedName("ring-")
                           : checkedName(name)](RecorderCore& core) { return core.saveRing(name); },
      std::move(response), std::move(exception));
}

void RecorderServant::markAsync(std::string text, std::function<void(Ice::Long)> response, Except exception,
                                const Ice::Current&) {
  if (text.empty() || text.size() > 10'000) {
    throw avm::InvalidArgument("text has " + std::to_string(text.size()) + " characters (must be 1..10000)");
  }
  const StampUs stamp_us = service_.newestStamp();
  run(
      [text = std::move(text), stamp_us](RecorderCore& core) {
        return core.mark(text, stamp_us,
                         std::chrono::duration_cast<std::chrono::microseconds>(
                             std::chrono::steady_clock::now().time_since_epoch())
                             .count());
      },
      [response = std::move(response), stamp_us](const std::string&) { response(stamp_us); },
      std::move(exception));
}

}  // namespace vismem
