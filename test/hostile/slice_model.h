/// @file The interfaces as their Slice files declare them, so that tests can call every operation of every
/// interface without naming any: what is added there is attacked here.
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

/// Reads every *.ice below a folder. Knows as much of Slice as our files use.
/// @throw std::runtime_error with file and what was not understood.
SliceModel readSlice(const std::filesystem::path& folder);

}  // namespace vismem::test
