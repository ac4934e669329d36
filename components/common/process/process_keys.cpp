#include "common/process/process_keys.h"

namespace vismem {

void knowProcessKeys(ConfigReader& root, const std::string& prefix) {
  root.known("Robot.*");
  for (const char* key : {"Endpoints", "WebEndpoints", "PlainRemote", "LogLevel", "EndWithParent"})
    root.known(prefix + "." + key);
}

}  // namespace vismem
