/// @file The visual memory over Ice: conversions, broadcaster, servant, and the client, a VisualMemorySource.
/// See C3, C4.
#pragma once

#include <avm/visual_memory.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "common/robot_ice/conversions.h"
#include "common/robot_ice/latest_value.h"
#include "common/robot_ice/remote.h"
#include "common/visual_memory/memory_snapshot.h"

namespace vismem {

avm::PrimitiveKind toIce(PrimitiveKind kind);
PrimitiveKind fromIce(avm::PrimitiveKind kind);
avm::MemorySnapshot toIce(const MemorySnapshot& snapshot);
avm::ImageAnalysis toIce(const ImageAnalysis& analysis);
MemorySnapshot fromIce(const avm::MemorySnapshot& snapshot);
/// The camera's pose must be rigid (checkUpdate says).
ImageAnalysis fromIce(const avm::ImageAnalysis& analysis);
/// @return empty if usable, otherwise what is wrong: numbers that are not finite, matches that name no
/// segment.
std::string checkUpdate(const avm::MemoryUpdate& update);

/// A published update with its form on the wire, made at the first request and kept for all. *Thread-safe.*
class PublishedMemory {
 public:
  explicit PublishedMemory(MemoryUpdate update) : update_(std::move(update)) {}
  const MemoryUpdate& update() const { return update_; }
  const avm::MemoryResult& result() const;

 private:
  MemoryUpdate update_;
  mutable std::once_flag made_;
  mutable avm::MemoryResult result_;
};

/// Gives the newest update to any number of local and remote readers. The component's loop publishes.
/// Revisions begin at 1. *Thread-safe.*
class MemoryBroadcaster : public VisualMemorySource {
 public:
  using Latest = LatestValue<PublishedMemory>;

  /// Both pointers must be set.
  void publish(MemoryUpdate update);
  /// Nothing comes for now: `message` says what is waited for. kFinished: the log is at its end.
  void setState(SourceState state, std::string message) { latest_.setState(state, std::move(message)); }
  /// The newest update whose revision differs from `after_revision` (0: any); a lower one means a restart.
  MemoryResult next(std::uint64_t after_revision, std::chrono::milliseconds timeout) override;
  /// Answers all who wait, now and from now on.
  void stop() { latest_.stop(); }

  Latest& latest() { return latest_; }

 private:
  Latest latest_{"the memory has seen no image yet"};
};

/// *Thread-safe*; the broadcaster must outlive the adapter.
class VisualMemoryServant : public avm::VisualMemory {
 public:
  /// @param reset  forgets everything; may be called from any thread.
  VisualMemoryServant(MemoryBroadcaster& memory, std::function<PortReply()> reset)
      : memory_(memory), reset_(std::move(reset)) {}

  void nextAsync(Ice::Long after_revision, std::function<void(const avm::MemoryResult&)> response,
                 std::function<void(std::exception_ptr)> exception, const Ice::Current&) override;
  avm::MemoryUpdate latest(const Ice::Current&) override;
  avm::CommandReply reset(const Ice::Current&) override { return toIce(reset_()); }

 private:
  MemoryBroadcaster& memory_;
  const std::function<PortReply()> reset_;
};

/// A remote memory as a port. A server that is away gives kWaiting with the reason; after its restart an
/// update with a lower revision comes. One consumer.
class VisualMemoryClient : public VisualMemorySource {
 public:
  explicit VisualMemoryClient(const std::shared_ptr<avm::VisualMemoryPrx>& proxy, LinkReport report = {});
  MemoryResult next(std::uint64_t after_revision, std::chrono::milliseconds timeout) override;

 private:
  std::shared_ptr<avm::VisualMemoryPrx> proxy_;
  PendingCall<avm::MemoryResult> updates_;
  std::string nothing_yet_ = "no update yet";  ///< as the server explained it last
};

}  // namespace vismem
