/// @file Recordings in memory, on a disk that can be slow, full or dead.
#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "recorder/core/recorder_core.h"

namespace vismem {

/// Bytes of every part of every recording. What is written goes through `before_write`, which may wait or
/// throw.
class MemoryStore : public RecordingStore {
 public:
  using BeforeWrite = std::function<void(std::size_t bytes)>;

  std::unique_ptr<PartStore> create(const std::string& name) override {
    if (recordings.contains(name)) throw RecordingError(name + ": exists already");
    recordings[name];
    return std::make_unique<Parts>(*this, name);
  }
  std::string pathOf(const std::string& name) const override { return "memory/" + name; }

  struct Part {
    Bytes bytes;
    bool finished = false;
  };
  std::map<std::string, std::vector<std::shared_ptr<Part>>> recordings;
  BeforeWrite before_write;

 private:
  class Sink : public ByteSink {
   public:
    Sink(MemoryStore& store, std::shared_ptr<Part> part) : store_(store), part_(std::move(part)) {}
    void write(ByteView bytes) override {
      if (store_.before_write) store_.before_write(bytes.size());
      part_->bytes.insert(part_->bytes.end(), bytes.begin(), bytes.end());
    }
    void overwrite(std::uint64_t offset, ByteView bytes) override {
      if (store_.before_write) store_.before_write(0);
      std::copy(bytes.begin(), bytes.end(), part_->bytes.begin() + static_cast<std::ptrdiff_t>(offset));
    }
    void truncate(std::uint64_t size) override { part_->bytes.resize(size); }
    void sync() override {}

   private:
    MemoryStore& store_;
    std::shared_ptr<Part> part_;
  };

  class Parts : public PartStore {
   public:
    Parts(MemoryStore& store, std::string name) : store_(store), name_(std::move(name)) {}
    std::unique_ptr<ByteSink> open(int) override {
      auto& parts = store_.recordings[name_];
      parts.push_back(std::make_shared<Part>());
      return std::make_unique<Sink>(store_, parts.back());
    }
    void closed(int number, bool finished) override {
      store_.recordings[name_].at(static_cast<std::size_t>(number))->finished = finished;
    }

   private:
    MemoryStore& store_;
    const std::string name_;
  };
};

}  // namespace vismem
