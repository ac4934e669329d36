#include "recorder/app/file_store.h"

#include <cstdio>
#include <utility>

#include "common/recording/file_sink.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;

class FileParts : public PartStore {
 public:
  FileParts(fs::path folder, std::string name, bool durable)
      : folder_(std::move(folder)), name_(std::move(name)), durable_(durable) {}

  std::unique_ptr<ByteSink> open(int number) override {
    return std::make_unique<FileSink>(fileOf(number).string() + ".active", durable_);
  }

  void closed(int number, bool finished) override {
    // One without an index keeps its name: whoever opens it sees that it was cut off.
    if (!finished) return;
    std::error_code error;
    fs::rename(fileOf(number).string() + ".active", fileOf(number), error);
    if (error) throw RecordingError(fileOf(number).string() + ": cannot be renamed: " + error.message());
  }

 private:
  fs::path fileOf(int number) const {
    char suffix[32];
    std::snprintf(suffix, sizeof suffix, "_%04d.bag", number);
    return folder_ / (name_ + suffix);
  }

  const fs::path folder_;
  const std::string name_;
  const bool durable_;
};

}  // namespace

FileStore::FileStore(fs::path folder, bool durable, Made made)
    : folder_(std::move(folder)), durable_(durable), made_(std::move(made)) {}

std::string FileStore::pathOf(const std::string& name) const {
  return (folder_ / name).string();
}

std::unique_ptr<PartStore> FileStore::create(const std::string& name) {
  const fs::path folder = folder_ / name;
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error) throw RecordingError(folder_.string() + ": cannot be made: " + error.message());
  if (!fs::create_directory(folder, error)) {
    throw RecordingError(folder.string() + ": " +
                         (error ? "cannot be made: " + error.message() : "exists already"));
  }
  if (made_) made_(folder);
  return std::make_unique<FileParts>(folder, name, durable_);
}

}  // namespace vismem
