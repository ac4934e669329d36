#include "simulator/core/world_reading.h"

#include <console_bridge/console.h>

#include <sdf/sdf.hh>

namespace vismem {

std::unique_ptr<Reading> readSdf(const std::string& xml,
                                 const std::function<std::string(const std::string& uri)>& find_include) {
  // Its complaints come back as values; on the console they would stand there twice.
  sdf::Console::Instance()->SetQuiet(true);
  console_bridge::noOutputHandler();  // of the URDF parser, which it asks about what it cannot read
  // A copy of the description of the format is made in a third of the time that reading it takes.
  static const sdf::SDFPtr kFormat = [] {
    auto format = std::make_shared<sdf::SDF>();
    sdf::init(format);
    return format;
  }();
  auto reading = std::make_unique<Reading>();
  sdf::ParserConfig config;
  config.SetFindCallback(find_include);
  try {
    auto tree = std::make_shared<sdf::SDF>();
    tree->Root(kFormat->Root()->Clone());
    sdf::Errors errors;
    if (sdf::readString(xml, config, tree, errors)) {
      const auto more = reading->root.Load(tree, config);
      errors.insert(errors.end(), more.begin(), more.end());
    }
    for (const auto& error : errors) reading->complaints.push_back(error.Message());
  } catch (const sdf::Exception& error) {  // not a std::exception
    reading->complaints.push_back("libsdformat fails: " + error.GetErrorStr());
  } catch (const std::exception& error) {
    reading->complaints.push_back("libsdformat fails: " + std::string(error.what()));
  }
  return reading;
}

}  // namespace vismem
