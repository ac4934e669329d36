#include "simulator/core/world_resolver.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <system_error>

#include "common/config/config_error.h"
#include "simulator/core/world_includes.h"

namespace vismem {
namespace fs = std::filesystem;
namespace {

constexpr int kFoldersUp = 3;
/// Maximum depth of models that include models.
constexpr std::size_t kMaxIncludes = 20;
constexpr std::size_t kMaxModelConfig_bytes = 1 << 20;

/// NAME/REST of an address such as https://fuel.../models/NAME/2/files/REST.
std::string fuelName(const std::string& uri) {
  std::string tail = uri.substr(uri.find("/models/") + 8);
  if (const auto files = tail.find("/files/"); files != std::string::npos) {
    tail = tail.substr(0, tail.find('/')) + "/" + tail.substr(files + 7);
  }
  for (auto at = tail.find("%20"); at != std::string::npos; at = tail.find("%20")) tail.replace(at, 3, " ");
  return tail;
}

std::string pathOf(const std::string& uri) {
  const auto scheme = uri.find("://");
  if (scheme == std::string::npos) return uri;
  if (uri.compare(0, 4, "http") == 0 && uri.find("/models/") != std::string::npos) return fuelName(uri);
  return uri.substr(scheme + 3);
}

}  // namespace

bool pathExists(const fs::path& path) {
  std::error_code error;
  return fs::exists(path, error) && !error;
}

std::optional<std::string> readFile(const fs::path& file, std::size_t max_bytes) {
  std::error_code error;
  if (!fs::is_regular_file(file, error) || error) return std::nullopt;
  std::ifstream stream(file, std::ios::binary);
  if (!stream) return std::nullopt;
  const auto size = fs::file_size(file, error);
  if (error || size > max_bytes) return std::nullopt;
  std::string bytes(size, '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(size));
  bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(stream.gcount(), 0)));
  return bytes;
}

std::optional<fs::path> UriResolver::folderOfModelCalled(const std::string& name) const {
  if (!names_) {
    names_.emplace();
    for (const auto& folder : search_) {
      std::error_code error;
      for (fs::directory_iterator it(folder, fs::directory_options::skip_permission_denied, error), end;
           !error && it != end; it.increment(error)) {
        const auto text = readFile(it->path() / "model.config", kMaxModelConfig_bytes);
        if (!text) continue;
        const auto begin = text->find("<name>");
        const auto close = text->find("</name>");
        if (begin == std::string::npos || close == std::string::npos || close < begin) continue;
        names_->emplace(text->substr(begin + 6, close - begin - 6), it->path());
      }
    }
  }
  const auto known = names_->find(name);
  if (known == names_->end()) return std::nullopt;
  return known->second;
}

UriResolver::Found UriResolver::find(const std::string& uri, const fs::path& named_in) const {
  const fs::path name = pathOf(uri);
  if (name.empty()) return {};
  if (name.is_absolute()) return {pathExists(name) ? name : fs::path(), ""};
  for (const auto& folder : search_) {
    if (pathExists(folder / name)) return {folder / name, ""};
  }
  // The part of the path inside the named model.
  fs::path rest;
  for (auto it = std::next(name.begin()); it != name.end(); ++it) rest /= *it;
  const bool of_a_model = uri.compare(0, 8, "model://") == 0;
  fs::path folder = named_in.parent_path();
  for (int up = 0; up < kFoldersUp && !folder.empty(); ++up, folder = folder.parent_path()) {
    if (pathExists(folder / name)) return {folder / name, ""};
    if (of_a_model && !rest.empty() && pathExists(folder / rest)) {
      return {folder / rest, uri + " taken from " + (folder / rest).string()};
    }
  }
  if (const auto model = folderOfModelCalled(name.begin()->string())) {
    const fs::path path = rest.empty() ? *model : *model / rest;
    if (pathExists(path)) return {path, uri + " taken from " + path.string() + ", whose model has that name"};
  }
  return {};
}

void UriResolver::checkIncludes(const std::string& xml, const std::string& file) const {
  IncludeChain chain;
  checkIncludes(xml, {}, file, chain);
}

void UriResolver::checkIncludes(const std::string& xml, const fs::path& folder, const std::string& file,
                                IncludeChain& chain) const {
  for (const std::string& uri : includedUris(xml)) {
    std::error_code error;
    const fs::path path = fs::weakly_canonical(find(uri).path, error);
    if (path.empty() || error) continue;
    const auto& models = chain.models;
    const bool circle = std::find(models.begin(), models.end(), path) != models.end() || path == folder;
    if (circle || models.size() >= kMaxIncludes) {
      throw ConfigError({file + ": " + uri + (circle ? " includes itself" : " is included too deep")});
    }
    if (!chain.checked.insert(path.string()).second) continue;
    chain.models.push_back(path);
    std::vector<fs::path> files{path};
    if (fs::is_directory(path, error)) {
      files.clear();
      for (fs::directory_iterator it(path, error), end; !error && it != end; it.increment(error)) {
        if (it->path().extension() == ".sdf") files.push_back(it->path());
      }
    }
    for (const auto& inner : files) {
      if (const auto text = readFile(inner, kMaxWorld_bytes)) checkIncludes(*text, path, file, chain);
    }
    chain.models.pop_back();
  }
}

}  // namespace vismem
