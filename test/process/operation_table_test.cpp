// Every operation of every Slice file reads or changes, and the build knows which.
#include "common/process/operation_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>

#include "common/process/child_process.h"
#include "support/build_paths.h"
#include "support/temporary_folder.h"
#include "untrusted_clients/slice_model.h"

namespace vismem {
namespace {

using testing::HasSubstr;
using testing::Not;

const std::string kSource = VISMEM_SOURCE_DIR;

TEST(OperationTable, HasEveryOperationOfEverySliceFileOnce) {
  std::map<std::string, int> rows;
  for (const auto& row : interfaceOperations()) ++rows[std::string(row.operation)];
  // By another reader of Slice, whose interfaces include what they inherit.
  const auto model = test::readSlice(kSource + "/interfaces");
  ASSERT_GT(model.interfaces.size(), 20u);
  for (const auto& [id, interface] : model.interfaces) {
    for (const auto& operation : interface.operations)
      EXPECT_TRUE(rows.contains(operation.name)) << id << " " << operation.name;
  }
  EXPECT_GT(interfaceOperations().size(), 80u);
}

TEST(OperationTable, NoCommandCountsAsReading) {
  constexpr const char* kVerbs[] = {
      "set",  "add",   "remove", "place",   "move",   "walk",    "stand",    "go",        "start",
      "stop", "reset", "seek",   "acquire", "renew",  "release", "kidnap",   "slip",      "step",
      "play", "pause", "resume", "fixate",  "report", "request", "withdraw", "relocalize"};
  const auto model = test::readSlice(kSource + "/interfaces");
  for (const auto& row : interfaceOperations()) {
    if (!row.reading) continue;
    for (const char* verb : kVerbs) {
      EXPECT_FALSE(row.operation.starts_with(verb)) << row.interface << " " << row.operation;
    }
    // What may not be repeated without harm changes something; JdeRobot's getters are the exception.
    for (const auto& operation : model.interfaces.at(std::string(row.interface)).operations) {
      if (operation.name != row.operation) continue;
      EXPECT_TRUE(operation.idempotent || row.operation.starts_with("get"))
          << row.interface << " " << row.operation;
    }
  }
}

TEST(OperationTable, AnObjectMayBeReadThroughAllItsInterfaces) {
  const auto reading =
      readingOperations({"::Ice::Object", "::avm::Base", "::avm::Leasable", "::jderobot::Motors"});
  EXPECT_TRUE(reading.contains("ice_ping"));
  EXPECT_TRUE(reading.contains("getLimits"));
  EXPECT_TRUE(reading.contains("getV"));
  EXPECT_TRUE(reading.contains("holder"));
  EXPECT_FALSE(reading.contains("setVelocity"));
  EXPECT_FALSE(reading.contains("setV"));
  EXPECT_FALSE(reading.contains("latest")) << "of another interface";
  EXPECT_EQ(readingOperations({"::unknown::Interface"}).size(), 4u) << "what every object answers";
}

class OperationTableScript : public testing::Test {
 protected:
  OperationTableScript() { std::filesystem::create_directories(folder_.path() / "slices"); }

  void write(const std::string& file, const std::string& text) {
    std::ofstream(folder_.path() / file, std::ios::binary) << text;
  }
  /// @return what the build would print; empty when it goes on.
  std::string run(const std::string& table) {
    write("operations.txt", table);
    ChildProcess script({VISMEM_CMAKE, "-D", "ROOT=" + (folder_.path() / "slices").string(), "-D",
                         "TABLE=" + (folder_.path() / "operations.txt").string(), "-D",
                         "OUTPUT=" + (folder_.path() / "operations.inc").string(), "-P",
                         kSource + "/cmake/OperationTable.cmake"});
    const auto code = script.waitForExit(std::chrono::seconds(30));
    if (code == 0) return "";
    return script.error().empty() ? "failed without a word" : script.error();
  }
  std::string rows() const {
    std::ifstream in(folder_.path() / "operations.inc");
    return {std::istreambuf_iterator<char>(in), {}};
  }

  TemporaryFolder folder_;
};

TEST_F(OperationTableScript, AnOperationInNoRowFailsTheBuild) {
  write("slices/arm.ice",
        "module avm { interface Arm { idempotent double angle(); void bend(double angle); } }");
  EXPECT_EQ(run("avm::Arm reading angle # comment\navm::Arm changing bend\n"), "");
  EXPECT_THAT(rows(), HasSubstr("{\"::avm::Arm\", \"angle\", true},\n{\"::avm::Arm\", \"bend\", false},\n"));
  EXPECT_THAT(run("avm::Arm reading angle\n"),
              HasSubstr("operations.txt: avm::Arm.bend is in no row (list it as reading or changing)"));
}

TEST_F(OperationTableScript, NamesEverythingThatIsWrong) {
  write("slices/arm.ice", "module avm { interface Arm { idempotent double angle(); } }");
  const std::string problems =
      run("avm::Arm reading angle\navm::Arm changing angle wave\navm::Arm sometimes angle\n");
  EXPECT_THAT(problems, HasSubstr("avm::Arm.angle is listed twice"));
  EXPECT_THAT(problems, HasSubstr("avm::Arm.wave is no operation of the Slice files"));
  EXPECT_THAT(problems,
              HasSubstr("\"avm::Arm sometimes angle\" (must be INTERFACE reading|changing OPERATION...)"));
}

TEST_F(OperationTableScript, ReadsSliceAsItIsWritten) {
  write("slices/arm.ice",
        "// interface Not { void here(); }\n#pragma once\n#include <avm/common.ice>\nmodule avm\n{\n"
        "  interface Arm;\n  struct Pose { double x; }\n  exception Broken { string why; }\n"
        "  /// Moves; really (it does).\n  interface Arm extends jderobot::Motors,\n      Leasable\n  {\n"
        "    [\"amd\"] idempotent PoseSeq\n        next(long after,\n             bool all) throws Broken, "
        "Failure;\n  }\n}\n");
  EXPECT_EQ(run("avm::Arm reading next\n"), "");
  EXPECT_THAT(run(""), HasSubstr("avm::Arm.next is in no row"));
  EXPECT_THAT(run(""), Not(HasSubstr("here")));
}

}  // namespace
}  // namespace vismem
