/// @file Repair of a world file's elements before libsdformat reads them, and removal of rejected ones. Pure,
/// except the functions of the caller.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace vismem {

/// An `<include>` that libsdformat rejects.
struct LostInclude {
  std::string uri;
  std::string name;         ///< empty: the model's own
  std::string pose;         ///< as text; empty: the model's own
  std::string description;  ///< "line 12: <include> of model://x"
};

/// A file in SDF as a tree of elements. *Single-threaded.*
class WorldDocument {
 public:
  /// Reason why libsdformat rejects a text; empty if it accepts it.
  using Refusal = std::function<std::string(const std::string& xml)>;

  /// @throws ConfigError "FILE:LINE: not XML: ..." or with the first element of the text instead of <sdf>.
  WorldDocument(const std::string& xml, const std::string& file);
  ~WorldDocument();
  WorldDocument(const WorldDocument&) = delete;
  WorldDocument& operator=(const WorldDocument&) = delete;

  /// Removes what is not simulated (removeUnsimulated) and repairs frequent errors of third-party files for
  /// which libsdformat rejects whole worlds: colours outside 0..1, missing and repeated names, a missing
  /// version, `nan` and `inf`. The last two become numbers out of any range, so that only the elements that
  /// need them are left out. An element whose pose cannot be read is removed.
  /// @return the repairs and what was removed with its pose, one line each.
  std::vector<std::string> repair();

  /// Tests the elements of the world one by one: rejected elements lose their invalid parts, or are removed
  /// when they would stand elsewhere or have another shape without them.
  /// @param lost receives the includes that were removed, tested or not, to be read each by itself.
  /// @return the removed parts with their reasons, one line each.
  std::vector<std::string> takeOutRefused(const Refusal& refusal, int tries, std::vector<LostInclude>& lost);

  /// The visuals of all that was removed; 1 for an include.
  int visualsLost() const;

  /// Puts the file's first model, else its light, into a world of its own, for included models; no effect
  /// without either.
  void wrapModel();

  std::string text() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace vismem
