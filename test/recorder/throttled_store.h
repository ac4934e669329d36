/// @file Recordings on a slow disk.
#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <thread>
#include <utility>

#include "recorder/core/recorder_core.h"

namespace vismem {

/// Another store whose files take so many bytes a second.
class ThrottledStore : public RecordingStore {
 public:
  /// @param store must outlive it.
  ThrottledStore(RecordingStore& store, double bytes_per_s) : store_(store), bytes_per_s_(bytes_per_s) {}

  std::unique_ptr<PartStore> create(const std::string& name) override {
    return std::make_unique<Parts>(store_.create(name), bytes_per_s_);
  }
  std::string pathOf(const std::string& name) const override { return store_.pathOf(name); }

 private:
  class Sink : public ByteSink {
   public:
    Sink(std::unique_ptr<ByteSink> sink, double bytes_per_s)
        : sink_(std::move(sink)), bytes_per_s_(bytes_per_s) {}
    void write(ByteView bytes) override {
      std::this_thread::sleep_for(
          std::chrono::duration<double>(static_cast<double>(bytes.size()) / bytes_per_s_));
      sink_->write(bytes);
    }
    void overwrite(std::uint64_t offset, ByteView bytes) override { sink_->overwrite(offset, bytes); }
    void truncate(std::uint64_t size) override { sink_->truncate(size); }
    void sync() override { sink_->sync(); }

   private:
    const std::unique_ptr<ByteSink> sink_;
    const double bytes_per_s_;
  };

  class Parts : public PartStore {
   public:
    Parts(std::unique_ptr<PartStore> parts, double bytes_per_s)
        : parts_(std::move(parts)), bytes_per_s_(bytes_per_s) {}
    std::unique_ptr<ByteSink> open(int number) override {
      return std::make_unique<Sink>(parts_->open(number), bytes_per_s_);
    }
    void closed(int number, bool finished) override { parts_->closed(number, finished); }

   private:
    const std::unique_ptr<PartStore> parts_;
    const double bytes_per_s_;
  };

  RecordingStore& store_;
  const double bytes_per_s_;
};

}  // namespace vismem
