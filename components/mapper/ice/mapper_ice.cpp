#include "mapper/ice/mapper_ice.h"

#include "common/config/file_name.h"
#include "common/robot_ice/conversions.h"

namespace vismem {

avm::MapReport toIce(const BuiltMap& map) {
  avm::MapReport report;
  report.file = map.file.string();
  report.edges = map.edges;
  report.seenAgain = map.seen_again;
  report.wayM = map.way_m;
  report.seconds = map.seconds;
  report.notes = map.notes;
  report.problems = map.problems;
  return report;
}

avm::MapperStatus toIce(const DriveProgress& drive, const MapBuilderStatus& builder) {
  avm::MapperStatus status;
  status.message = drive.message;
  status.keyframes = drive.keyframes;
  status.wayM = drive.way_m;
  status.beginUs = drive.begin_us;
  status.endUs = drive.end_us;
  status.building = builder.building;
  status.progress = builder.progress;
  status.built = builder.built;
  status.last = toIce(builder.last);
  return status;
}

avm::CommandReply MapperServant::build(std::string name, const Ice::Current&) {
  if (!name.empty()) {
    if (const std::string wrong = checkFileName(name); !wrong.empty()) throw avm::InvalidArgument(wrong);
  }
  return toIce(control_.build(name));
}

avm::CommandReply MapperServant::restart(const Ice::Current&) {
  return toIce(control_.restart());
}

}  // namespace vismem
