/// @file avm::Mapper over the component's recording and building of maps. See B6.
#pragma once

#include <avm/mapper.h>

#include <string>

#include "common/robot/ports.h"
#include "mapper/core/mapper_status.h"

namespace vismem {

avm::MapReport toIce(const BuiltMap& map);
avm::MapperStatus toIce(const DriveProgress& drive, const MapBuilderStatus& builder);

/// What the servant asks for. *Thread-safe.*
class MapperControl {
 public:
  virtual ~MapperControl() = default;
  virtual avm::MapperStatus status() const = 0;
  /// @param name  of the files; empty: as configured.
  virtual PortReply build(const std::string& name) = 0;
  virtual PortReply restart() = 0;
};

/// *Thread-safe*; the control must outlive the adapter.
class MapperServant : public avm::Mapper {
 public:
  explicit MapperServant(MapperControl& control) : control_(control) {}

  avm::MapperStatus status(const Ice::Current&) override { return control_.status(); }
  avm::CommandReply build(std::string name, const Ice::Current&) override;
  avm::CommandReply restart(const Ice::Current&) override;

 private:
  MapperControl& control_;
};

}  // namespace vismem
