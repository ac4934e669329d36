/// @file Configuration as text: Ice property files with the file and line of every key. Pure but for
/// Properties::load, which reads one file.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace vismem {

/// File and line that set a key, for messages and their order.
struct Origin {
  /// Path of the file as it was named, or "command line".
  std::string file;
  /// From 1; 0 on the command line.
  int line = 0;

  /// "cfg/sim/localization.cfg:14" or "command line".
  std::string text() const;
};

/// One thing wrong with the configuration.
struct Problem {
  Origin origin;
  std::string message;

  /// "cfg/sim/localization.cfg:14: Localization.Races.Maximum = 0 (must be 1..64)".
  std::string text() const;
};

/// Keys and values in the syntax of Ice, read strictly: lines that are not KEY = VALUE and keys set twice are
/// problems. They are kept until ConfigReader::finish or throwIfBad reports them together with all others.
/// Syntax: `KEY = VALUE`, the rest of a line after '#' is a comment, blanks around key and value do not
/// count; `\#`, `\=`, `\\` and `\ ` stand for the character itself, any other backslash for itself. Unlike
/// Ice's reader it keeps blanks that follow an escaped one. A value may be empty. Value type.
class Properties {
 public:
  struct Entry {
    std::string value;
    Origin origin;
  };

  /// @param file  the name used in messages and as the folder of relative paths.
  static Properties parse(std::string_view text, const std::string& file);
  /// Reads a file. An unreadable file gives no keys and one problem with the reason.
  static Properties load(const std::filesystem::path& file);

  /// Adds `--Key=Value`. It replaces the key of a file; the last argument wins.
  void addArgument(const std::string& argument);
  /// Sets a key as an argument of the command line does.
  void set(const std::string& key, const std::string& value);

  /// @return nullptr if the key is not set.
  const Entry* find(const std::string& key) const;
  const std::map<std::string, Entry>& entries() const { return entries_; }
  const std::vector<Problem>& problems() const { return problems_; }
  void addProblem(Problem problem) { problems_.push_back(std::move(problem)); }

  /// False after load() of an unreadable file: absent keys are then no problems of their own.
  bool readable() const { return readable_; }
  /// The file's name; "command line" without a file.
  const std::string& source() const { return source_; }
  /// Folder of the file; empty without a file.
  std::filesystem::path folder() const;

  /// @throw ConfigError with all problems so far.
  void throwIfBad() const;

 private:
  void parseLine(std::string_view line, const Origin& origin);

  std::map<std::string, Entry> entries_;
  std::vector<Problem> problems_;
  std::string source_ = "command line";
  bool readable_ = true;
};

/// Problems as one ConfigError's lines: those of files in order of their lines, then those of the command
/// line.
std::vector<std::string> problemLines(std::vector<Problem> problems);

}  // namespace vismem
