/// @file The interfaces of the Slice files, so that tests call every operation of every interface, including
/// later additions.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace vismem::test {

/// A named type; built-in ones ("bool", "long", "string" ...) are not listed in the model.
struct SliceType {
  enum class Kind { kStruct, kClass, kEnum, kSequence };
  Kind kind = Kind::kStruct;
  std::string type_id;  ///< "::avm::Pose2"
  std::vector<std::string>
      members;  ///< types of a struct's or class's members, in order; a sequence's element
  int enumerators = 0;
};

struct SliceOperation {
  std::string name;
  bool idempotent = false;
  std::vector<std::string> parameters;  ///< types, in order
};

struct SliceInterface {
  std::string type_id;
  std::vector<SliceOperation> operations;  ///< inherited ones included
};

struct SliceModel {
  std::map<std::string, SliceType> types;            ///< by type id
  std::map<std::string, SliceInterface> interfaces;  ///< by type id
};

/// Reads every *.ice below a folder. Supports the part of Slice that these files use.
/// @throw std::runtime_error with the file and the unknown syntax.
SliceModel readSlice(const std::filesystem::path& folder);

}  // namespace vismem::test
