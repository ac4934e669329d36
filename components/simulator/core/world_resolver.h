/// @file Resolution of a world's uris: folders of models, meshes, textures.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace vismem {

constexpr std::size_t kMaxWorld_bytes = 64u << 20;

/// *Single-threaded*: it caches the names of models that it read.
class UriResolver {
 public:
  /// @param search folders in their order: those of models first, the world's own last.
  explicit UriResolver(std::vector<std::filesystem::path> search) : search_(std::move(search)) {}

  struct Found {
    std::filesystem::path path;  ///< empty: not found
    std::string note;  ///< the place of a file that was found elsewhere than the uri says; else empty
  };
  /// `model://NAME/REST`, `file://...`, addresses of Fuel (their last part), and bare paths. In this order:
  /// below the search folders; beside the file that names it and above that, up to its model's folder; below
  /// the folder of the model with NAME in its model.config.
  /// @param named_in the file with the uri; may be empty.
  Found find(const std::string& uri, const std::filesystem::path& named_in = {}) const;
  /// libsdformat follows includes without end.
  /// @param file of the text, for the message.
  /// @throws ConfigError for a model that includes itself.
  void checkIncludes(const std::string& xml, const std::string& file) const;

 private:
  /// The models from the world to the text that is checked, and all that were checked.
  struct IncludeChain {
    std::vector<std::filesystem::path> models;
    std::set<std::string> checked;
  };
  void checkIncludes(const std::string& xml, const std::filesystem::path& folder, const std::string& file,
                     IncludeChain& chain) const;
  std::optional<std::filesystem::path> folderOfModelCalled(const std::string& name) const;

  std::vector<std::filesystem::path> search_;
  mutable std::optional<std::map<std::string, std::filesystem::path>> names_;
};

/// The whole of a file.
/// @return empty if it cannot be read or has more than `max_bytes`.
std::optional<std::string> readFile(const std::filesystem::path& file, std::size_t max_bytes);
/// Whether a path exists; never throws, for any bytes of the path.
bool pathExists(const std::filesystem::path& path);

}  // namespace vismem
