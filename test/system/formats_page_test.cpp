// The examples of docs/formats.md and docs/map_sessions.md: the pages are the input, the readers of the
// programs are the judges.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>

#include "common/config/config_error.h"
#include "common/routes/route.h"
#include "common/segment_map/map_check.h"
#include "common/segment_map/segment_map.h"
#include "common/vision/palette.h"
#include "evaluation/core/surveyed_floor.h"
#include "evaluation/core/trajectory_io.h"
#include "evaluation/core/truth_file.h"
#include "mapper/core/change_list.h"
#include "recorder/app/session_folder.h"
#include "simulator/core/scenario.h"
#include "support/build_paths.h"
#include "support/temporary_folder.h"
#include "support/tum.h"

namespace vismem {
namespace {

struct Example {
  std::string kind;  ///< "map", "map error", "check warning" ...
  std::string file;
  std::string text;
  std::vector<std::string> messages;  ///< of errors and warnings
};

/// A fenced block from the line after its opening on; `line` moves behind its end.
std::string fencedBlock(const std::vector<std::string>& lines, std::size_t& line) {
  std::string text;
  for (; line < lines.size() && lines[line] != "```"; ++line) text += lines[line] + "\n";
  ++line;
  return text;
}

std::vector<std::string> linesOf(std::istream& in) {
  std::vector<std::string> lines;
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  return lines;
}

void addExamples(const std::string& name, std::vector<Example>& examples) {
  std::ifstream page(std::string(VISMEM_SOURCE_DIR) + "/docs/" + name);
  const std::vector<std::string> lines = linesOf(page);
  const std::regex marker("<!-- ([a-z ]+): (\\S+) -->");
  for (std::size_t i = 0; i < lines.size();) {
    std::smatch match;
    if (!std::regex_match(lines[i++], match, marker)) continue;
    Example example{match[1], match[2], {}, {}};
    ++i;  // the opening of the block
    example.text = fencedBlock(lines, i);
    if (i < lines.size() && lines[i] == "```text") {
      ++i;
      std::istringstream messages(fencedBlock(lines, i));
      example.messages = linesOf(messages);
    }
    examples.push_back(example);
  }
}

std::vector<Example> examplesOfPage() {
  std::vector<Example> examples;
  addExamples("formats.md", examples);
  addExamples("map_sessions.md", examples);
  return examples;
}

std::vector<std::string> problemsOf(const std::function<void()>& read) {
  try {
    read();
  } catch (const ConfigError& error) {
    return error.problems();
  }
  return {};
}

PaletteLabels labelsOfPage(const std::vector<Example>& examples) {
  for (const Example& example : examples) {
    if (example.kind != "palette") continue;
    const Palette palette = Palette::parse(example.text, example.file);
    const auto labels = palette.labels();
    return {{labels.begin(), labels.end()}, palette.stripes(), {}};
  }
  return {};
}

TEST(FormatsPage, ExamplesAreReadAndMistakesGiveTheirMessages) {
  const std::vector<Example> examples = examplesOfPage();
  const PaletteLabels labels = labelsOfPage(examples);
  const std::map<std::string, std::function<void(const Example&)>> readers{
      {"map", [](const Example& e) { parseSegmentMap(e.text, e.file); }},
      {"palette", [](const Example& e) { Palette::parse(e.text, e.file); }},
      {"route", [](const Example& e) { parseRoute(e.text, e.file); }},
      {"scenario", [](const Example& e) { parseScenario(e.text, e.file); }},
      {"truth", [](const Example& e) { parseTruth(e.text, e.file); }},
      {"changes", [](const Example& e) { parseChangeList(e.text, e.file); }},
      {"survey", [](const Example& e) { parseSurvey(e.text, e.file); }},
  };
  std::map<std::string, int> seen;
  for (const Example& example : examples) {
    SCOPED_TRACE(example.kind + ": " + example.file);
    ++seen[example.kind];
    // Written by programs, read by people: below.
    if (example.kind == "memory" || example.kind == "session" || example.kind == "tum") continue;
    if (example.kind == "check warning") {
      const auto map = parseSegmentMap(example.text, example.file);
      EXPECT_EQ(checkMap(map, example.file, labels, "kitchen.palette"), example.messages);
      continue;
    }
    const bool is_error = example.kind.ends_with(" error");
    const auto reader = readers.find(example.kind.substr(0, example.kind.find(' ')));
    ASSERT_NE(reader, readers.end()) << "no reader for this kind";
    EXPECT_EQ(problemsOf([&] { reader->second(example); }), example.messages);
    EXPECT_EQ(is_error, !example.messages.empty());
  }
  for (const auto& [kind, reader] : readers) {
    EXPECT_EQ(seen[kind], 1) << kind;
    EXPECT_EQ(seen[kind + " error"], 1) << kind;
  }
}

TEST(FormatsPage, MapAndPaletteOfThePageBelongTogether) {
  const std::vector<Example> examples = examplesOfPage();
  for (const Example& example : examples) {
    if (example.kind != "map") continue;
    EXPECT_THAT(checkMap(parseSegmentMap(example.text, example.file), example.file, labelsOfPage(examples),
                         "kitchen.palette"),
                testing::IsEmpty());
  }
}

const Example& exampleOf(const std::vector<Example>& examples, const std::string& kind) {
  return *std::find_if(examples.begin(), examples.end(), [&](const Example& e) { return e.kind == kind; });
}

TEST(FormatsPage, TheTrajectoryIsRead) {
  const auto examples = examplesOfPage();
  EXPECT_EQ(readTum(exampleOf(examples, "tum").text).size(), 2u);
}

MemorySegment segmentOf(std::istream& row) {
  MemorySegment s;
  std::string cell;
  const auto next = [&] {
    std::getline(row, cell, ',');
    return std::stod(cell);
  };
  s.id = static_cast<std::uint64_t>(next());
  for (Eigen::Vector3d* end : {&s.odom.a, &s.odom.b}) {
    for (int i = 0; i < 3; ++i) (*end)[i] = next();
  }
  std::getline(row, s.label, ',');
  s.life = next();
  next();  // follows from the covariances
  s.last_seen_us = toStampUs(next());
  s.confirmed = next() != 0.0;
  for (Eigen::Matrix3d* P : {&s.P_a, &s.P_b}) {
    (*P)(0, 0) = next();
    (*P)(0, 1) = (*P)(1, 0) = next();
    (*P)(1, 1) = next();
  }
  return s;
}

TEST(FormatsPage, TheMemoryIsWhatTheProgramsWrite) {
  const auto examples = examplesOfPage();
  const Example& example = exampleOf(examples, "memory");
  std::istringstream lines(example.text);
  std::string line;
  std::getline(lines, line);
  EXPECT_EQ(line + "\n", kMemoryHeader);
  MemorySnapshot memory;
  while (std::getline(lines, line)) {
    std::istringstream row(line);
    std::string seconds;
    std::getline(row, seconds, ',');
    memory.stamp_us = toStampUs(std::stod(seconds));
    memory.segments.push_back(segmentOf(row));
  }
  std::ostringstream written;
  written << kMemoryHeader;
  writeMemoryRows(memory, written);
  EXPECT_EQ(written.str(), example.text);
}

TEST(FormatsPage, TheSessionIsWhatTheRecorderWrites) {
  const TemporaryFolder folder;
  const auto examples = examplesOfPage();
  std::ofstream(folder.path() / "kitchen.csv") << exampleOf(examples, "map").text;
  std::ofstream(folder.path() / "kitchen.palette") << exampleOf(examples, "palette").text;
  const auto session = folder.path() / "monday";
  std::filesystem::create_directory(session);
  SessionFolder recorder(folder.path() / "kitchen.csv", "0.2.0");
  recorder.open(session);
  recorder.add("localization", "0.2.0", {{"Localization.Mode", "default"}});
  auto example = nlohmann::json::parse(exampleOf(examples, "session").text);
  auto written = nlohmann::json::parse(std::ifstream(session / "session.json"));
  EXPECT_EQ(written["started"].get<std::string>().size(), example["started"].get<std::string>().size());
  // Of this run.
  for (const char* key : {"started", "map_was"}) example[key] = written[key];
  EXPECT_EQ(written, example);
  for (const char* file : {"cfg/localization.cfg", "map.csv", "map.palette"})
    EXPECT_TRUE(std::filesystem::exists(session / file)) << file;
}

}  // namespace
}  // namespace vismem
