// The strict reader agrees with Ice's own reader on every line that Ice accepts without a warning.
#include <Ice/Ice.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <random>

#include "common/config/properties.h"

namespace vismem {
namespace {

/// Ice only warns of junk; the warnings are not what this test is about.
class SilentLogger : public Ice::Logger, public std::enable_shared_from_this<SilentLogger> {
 public:
  void print(const std::string&) override {}
  void trace(const std::string&, const std::string&) override {}
  void warning(const std::string&) override {}
  void error(const std::string&) override {}
  std::string getPrefix() override { return ""; }
  std::shared_ptr<Ice::Logger> cloneWithPrefix(const std::string&) override { return shared_from_this(); }
};

TEST(IceSyntax, RandomLinesReadAsIceReadsThem) {
  Ice::setProcessLogger(std::make_shared<SilentLogger>());
  const auto file =
      std::filesystem::path(testing::TempDir()) / ("ice_syntax_" + std::to_string(getpid()) + ".cfg");
  std::mt19937_64 random(7);
  const std::string letters = "ab.=#\\ \t";
  std::string text;
  for (int i = 0; i < 5000; ++i) {
    // A name of its own for every line: the two differ in what they make of duplicates.
    std::string line = (random() % 2 == 0 ? "" : " \t") + std::string("K") + std::to_string(i);
    for (auto length = random() % 14; length > 0; --length) line += letters[random() % letters.size()];
    // Ice loses blanks between an escaped one and the text; we keep them.
    if (line.find("\\ ") == std::string::npos) text += line + "\n";
  }
  std::ofstream(file) << text;
  const auto reference = Ice::createProperties();
  reference->load(file.string());
  std::filesystem::remove(file);
  const auto theirs = reference->getPropertiesForPrefix("");
  // Ice takes an empty value for no property at all.
  std::map<std::string, std::string> ours;
  const auto properties = Properties::parse(text, "text");
  for (const auto& [key, entry] : properties.entries()) {
    if (!entry.value.empty()) ours[key] = entry.value;
  }
  EXPECT_EQ(ours, theirs);
  EXPECT_GT(theirs.size(), 500u) << "many random lines are junk, but not all";
}

}  // namespace
}  // namespace vismem
