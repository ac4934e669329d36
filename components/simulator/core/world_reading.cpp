#include "simulator/core/world_reading.h"

#include <console_bridge/console.h>

#include <iostream>
#include <sdf/sdf.hh>

namespace vismem {
namespace {

/// An empty tree with the format's description. A copy takes a third of the time of reading the description.
sdf::SDFPtr emptyTree() {
  static const sdf::SDFPtr kFormat = [] {
    auto format = std::make_shared<sdf::SDF>();
    sdf::init(format);
    return format;
  }();
  auto tree = std::make_shared<sdf::SDF>();
  tree->Root(kFormat->Root()->Clone());
  return tree;
}

/// libsdformat prints the errors of included files, which it also returns.
class SilentErrorOutput {
 public:
  SilentErrorOutput() : buffer_(std::cerr.rdbuf(nullptr)) {}
  ~SilentErrorOutput() { std::cerr.rdbuf(buffer_); }
  SilentErrorOutput(const SilentErrorOutput&) = delete;
  SilentErrorOutput& operator=(const SilentErrorOutput&) = delete;

 private:
  std::streambuf* buffer_;
};

void readInto(Reading& reading, const sdf::SDFPtr& tree, const std::string& xml,
              const std::function<std::string(const std::string&)>& find_include) {
  sdf::ParserConfig config;
  config.SetFindCallback(find_include);
  const SilentErrorOutput silent;
  try {
    sdf::Errors errors;
    if (sdf::readString(xml, config, tree, errors)) {
      const auto more = reading.root.Load(tree, config);
      errors.insert(errors.end(), more.begin(), more.end());
    }
    for (const auto& error : errors) reading.complaints.push_back(error.Message());
  } catch (const sdf::Exception& error) {  // not a std::exception
    reading.complaints.push_back("libsdformat fails: " + error.GetErrorStr());
  } catch (const std::exception& error) {
    reading.complaints.push_back("libsdformat fails: " + std::string(error.what()));
  }
}

}  // namespace

SdfReader::SdfReader(std::function<std::string(const std::string& uri)> find_include)
    : find_include_(std::move(find_include)) {
  // Its errors are returned as values; on the console they would appear twice.
  sdf::Console::Instance()->SetQuiet(true);
  console_bridge::noOutputHandler();  // of the URDF parser, which it calls for unknown formats
}

std::unique_ptr<Reading> SdfReader::read(const std::string& xml) const {
  auto reading = std::make_unique<Reading>();
  readInto(*reading, emptyTree(), xml, find_include_);
  return reading;
}

std::string SdfReader::refusal(const std::string& xml) {
  if (!scratch_) scratch_ = emptyTree();
  scratch_->Root()->Clear();
  Reading reading;
  readInto(reading, scratch_, xml, find_include_);
  if (reading.hasWorld()) return "";
  return reading.complaints.empty() ? "no world" : reading.complaints.front();
}

}  // namespace vismem
