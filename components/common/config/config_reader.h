/// @file Typed reading of a component's configuration. Pure, but for the paths that are looked up on disk.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "common/config/config_error.h"
#include "common/config/parameter_visitor.h"
#include "common/config/properties.h"

namespace vismem {

/// The release that no longer accepts the old names of keys (ConfigReader::alias).
inline constexpr std::string_view kAliasesEnd = "0.3.0";

/// One key of the effective configuration.
struct Setting {
  std::string key;
  std::string value;
  /// File and line that set it; empty for a default.
  std::string origin;
};

/// A key that a program reads.
struct KeyDescription {
  std::string key;
  std::string fallback;  ///< the default as text, numbers with at most six digits
  std::string range;     ///< "1..64", "one of: default, chapter"; empty: any text
  std::string meaning;   ///< empty: not described
  bool is_basic = false;
};

/// Reads typed values and collects what is wrong instead of stopping at the first. A bad value is
/// reported and the default returned, so that reading goes on; finish() then throws, so it is never used.
/// Every key that is read is a known key; finish() reports all others. Readers of groups share the problems
/// and known keys of their parent. Single-threaded. Lives no longer than the Properties.
///
///   Properties properties = Properties::load("cfg/sim/localization.cfg");
///   ConfigReader config(properties);
///   const auto races = config.group("Localization").integer("Races.Maximum", 10, 1, 64);
///   config.finish();
class ConfigReader {
 public:
  /// @param prefix  of all names, without the last dot: "Localization". Empty: names are whole keys.
  explicit ConfigReader(const Properties& properties, std::string prefix = "");

  /// A reader of the names under PREFIX.NAME with the same collection of problems and known keys.
  ConfigReader group(std::string_view name) const;
  /// The whole key of a name.
  std::string key(std::string_view name) const;
  bool isSet(std::string_view name) const;
  /// Distinct next parts of the keys under NAME, sorted: for A.1.X, A.1.Y and A.2.X, children("A") is 1, 2.
  std::vector<std::string> children(std::string_view name) const;

  /// A finite number in [minimum, maximum]; an infinite bound does not limit it.
  double real(std::string_view name, double fallback, double minimum, double maximum);
  std::optional<double> optionalReal(std::string_view name, double minimum, double maximum);
  /// An angle written in degrees, or its rate, with a name that ends in _deg, _degps or _degpm; all
  /// parameters in degrees.
  /// @return radians.
  double angleDeg(std::string_view name, double fallback_deg, double minimum_deg, double maximum_deg);
  /// As many numbers as `fallback` has, separated by blanks or commas, each in [minimum, maximum].
  std::vector<double> reals(std::string_view name, std::vector<double> fallback, double minimum,
                            double maximum);
  long integer(std::string_view name, long fallback, long minimum, long maximum);
  /// yes, true, on, 1 or no, false, off, 0.
  bool boolean(std::string_view name, bool fallback);
  std::string text(std::string_view name, std::string fallback);
  /// A required text.
  /// @param expected kind of text, for the message: "the proxy of a camera, such as cameraA:tcp -p 9999".
  std::string requiredText(std::string_view name, std::string_view expected);

  /// One of several words: choice("Mode", Mode::kDefault, {{"default", Mode::kDefault}, {"chapter", ...}}).
  template <typename T>
  T choice(std::string_view name, T fallback,
           const std::vector<std::pair<std::string, std::type_identity_t<T>>>& choices) {
    std::vector<std::string> words;
    std::string fallback_word;
    for (const auto& [word, value] : choices) {
      if (fallback_word.empty() && value == fallback) fallback_word = word;
      words.push_back(word);
    }
    const auto index = choiceIndex(name, fallback_word, words);
    return index ? choices[*index].second : fallback;
  }

  /// A path of an input, which need not exist. A relative one is looked for in the configuration's own
  /// folder, in the folders above it (configurations name files from the project's root), in the working
  /// directory, and above this program; on the command line first in the working directory. What is nowhere
  /// is returned as it is. Empty if not set and without a fallback.
  std::filesystem::path path(std::string_view name, const std::filesystem::path& fallback = {});
  /// The same for one of several paths in a key's value.
  std::filesystem::path locate(std::string_view name, const std::filesystem::path& value) const;
  /// A path of an output: a relative one counts from the working directory.
  std::filesystem::path outputPath(std::string_view name, const std::filesystem::path& fallback = {});
  /// A path that must exist. Empty if not set and without a fallback.
  std::filesystem::path existingPath(std::string_view name, const std::filesystem::path& fallback = {});
  /// A file that can be opened for reading. Empty if not set and without a fallback.
  /// @param expected kind of file, for the message: "a palette".
  std::filesystem::path existingFile(std::string_view name, std::string_view expected,
                                     const std::filesystem::path& fallback = {});
  /// As existingFile; the key is required.
  std::filesystem::path requireFile(std::string_view name, std::string_view expected);

  /// Adds a problem of a name's value: "KEY = VALUE (RULE)". For rules between keys, and for errors in files.
  /// @param rule  "must be more than Localization.Noise.Minimum_m".
  void problem(std::string_view name, std::string_view rule);
  bool good() const;
  /// Problems of files, with the line of the key that names such a file before the first one of each.
  std::vector<std::string> withKeysOf(const std::vector<std::string>& problems) const;
  /// load(), a ConfigError of which names the keys of the files, too.
  template <typename Load>
  auto loading(const Load& load) const {
    try {
      return load();
    } catch (const ConfigError& error) {
      throw ConfigError(withKeysOf(error.problems()));
    }
  }

  /// Accepts a renamed key under its old name too, until release kAliasesEnd. To be called before the new
  /// name is read. Both names set is a problem; the old one alone is listed in renamedKeys().
  void alias(std::string_view old_name, std::string_view new_name);
  /// Accepts keys without effect until release kAliasesEnd; one that is set is listed in renamedKeys().
  /// @param names  separated by blanks.
  /// @param why    what became of them: "the order is always right".
  void retired(std::string_view names, std::string_view why);
  /// One line for each key that is set under an old name, "KEY is now called NEW (...)", or has no effect.
  std::vector<Problem> renamedKeys() const;

  /// Says what a key is for; to be called before it is read. @return this reader.
  ConfigReader& describe(const Key& key);
  /// The same for several keys.
  void describe(std::initializer_list<Key> keys);
  /// Every key read so far, in that order, with what it is for.
  std::vector<KeyDescription> keys() const;

  /// Marks keys as known that other code reads: a name, or all names under it with ".*" at its end.
  void known(std::string_view name);

  /// @throw ConfigError with all problems, including those of the Properties and unknown keys: of keys under
  /// the prefix if this reader has one, else of all keys, also of unknown keys of Ice.
  void finish() const;
  /// The same, as data.
  std::vector<Problem> allProblems() const;

  /// Every key read so far, sorted, defaults included.
  std::vector<Setting> effective() const;

 private:
  struct State;
  ConfigReader(std::shared_ptr<State> state, std::string prefix);

  std::filesystem::path placeOf(std::string_view name, const std::filesystem::path& value) const;
  /// The entry of a whole key, under its old name where only that is set; nullptr if neither is.
  const Properties::Entry* find(const std::string& whole) const;
  /// The name that a whole key has in the file.
  std::string written(const std::string& whole) const;
  /// Registers the key as known with its default.
  /// @return nullptr if it is not set.
  const Properties::Entry* entry(std::string_view name, const std::string& fallback,
                                 const std::string& range = "");
  void reject(std::string_view name, const Properties::Entry& entry, std::string_view rule);
  void missing(std::string_view name, std::string_view expected);
  std::optional<std::size_t> choiceIndex(std::string_view name, const std::string& fallback,
                                         const std::vector<std::string>& words);
  std::optional<double> number(std::string_view name, const std::string& fallback, double minimum,
                               double maximum);
  std::shared_ptr<State> state_;
  std::string prefix_;
};

/// Problems of keys Ice.* that Ice 3.7 does not have, and of values that Ice would silently misread.
std::vector<Problem> checkIceKeys(const Properties& properties);
/// The same for the keys ADAPTER.* of an object adapter.
std::vector<Problem> checkAdapterKeys(const Properties& properties, const std::string& adapter);

/// @return whether the key belongs to Ice or a service of it, which read it themselves: Ice., IceSSL.,
/// IceGrid. ...
bool belongsToIce(std::string_view key);

}  // namespace vismem
