/// @file The elements of a world file before libsdformat reads them: repairs, and what is left where it gives
/// up. Pure but for what the caller's functions do.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace vismem {

/// An `<include>` that libsdformat cannot take in.
struct LostInclude {
  std::string uri;
  std::string name;         ///< empty: the model's own
  std::string pose;         ///< as text; empty: the model's own
  std::string description;  ///< "line 12: <include> of model://x"
};

/// A file in SDF as a tree of elements. *Single-threaded.*
class WorldDocument {
 public:
  /// Why libsdformat gives no world for a text; empty if it gives one.
  using Refusal = std::function<std::string(const std::string& xml)>;

  /// @throws ConfigError "FILE:LINE: not XML: ..." or what the text begins with instead of <sdf>.
  WorldDocument(const std::string& xml, const std::string& file);
  ~WorldDocument();
  WorldDocument(const WorldDocument&) = delete;
  WorldDocument& operator=(const WorldDocument&) = delete;

  /// Makes good what libsdformat refuses whole worlds for and real files have: `nan` and `inf` (they become
  /// numbers out of any range, so that only what needs them is left out), colours outside 0..1, names that
  /// are missing, no version. @return what was done, one line each.
  std::vector<std::string> repair();

  /// The elements of the world one by one: those that are refused alone lose the parts that are to blame, or
  /// are taken out. @param lost gets the includes among them. @return what was taken out and why, one line
  /// each.
  std::vector<std::string> takeOutRefused(const Refusal& refusal, int tries, std::vector<LostInclude>& lost);

  /// The file's first model in a world of its own, for a model that is included; does nothing without one.
  void wrapModel();

  std::string text() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vismem
