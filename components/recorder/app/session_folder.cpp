#include "recorder/app/session_folder.h"

#include <fstream>
#include <nlohmann/json.hpp>

#include "common/process/name_by_date.h"
#include "common/recording/bag_format.h"

namespace vismem {
namespace {

namespace fs = std::filesystem;

void writeFile(const fs::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.flush();
  if (!stream) throw RecordingError(file.string() + ": cannot be written");
}

std::string escaped(const std::string& text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool outer_blank = c == ' ' && (i == 0 || i + 1 == text.size());
    if (c == '#' || c == '\\' || c == '=' || outer_blank) result += '\\';
    result += c;
  }
  return result;
}

}  // namespace

std::string configurationFile(const SessionFolder::Settings& settings) {
  std::string text = "# The effective configuration during the recording.\n";
  for (const auto& [key, value] : settings) {
    // Keys that may be left out are listed without a value.
    if (!value.empty()) text += escaped(key) + " = " + escaped(value) + "\n";
  }
  return text;
}

void SessionFolder::open(const fs::path& folder) {
  const std::lock_guard lock(mutex_);
  folder_ = folder;
  started_ = nameByDate();
  if (!map_.empty()) {
    std::error_code error;
    fs::copy_file(map_, folder / "map.csv", error);
    if (error)
      throw RecordingError(map_.string() + ": cannot be copied to " + folder.string() + ": " +
                           error.message());
    fs::path palette = map_;
    palette.replace_extension(".palette");
    if (fs::exists(palette)) fs::copy_file(palette, folder / "map.palette", error);
    if (error) throw RecordingError(palette.string() + ": cannot be copied: " + error.message());
  }
  writeLocked();
}

void SessionFolder::add(const std::string& component, const std::string& version, Settings settings) {
  const std::lock_guard lock(mutex_);
  auto& known = components_[component];
  if (known.first == version && known.second == settings) return;
  known = {version, std::move(settings)};
  if (!folder_.empty()) writeLocked();
}

void SessionFolder::writeLocked() const {
  nlohmann::json session;
  session["format"] = 1;
  session["recorder_version"] = version_;
  session["started"] = started_;
  session["map"] = map_.empty() ? "" : "map.csv";
  session["map_was"] = map_.string();
  session["components"] = nlohmann::json::object();
  std::error_code error;
  fs::create_directories(folder_ / "cfg", error);
  for (const auto& [name, component] : components_) {
    session["components"][name] = {{"version", component.first}, {"configuration", "cfg/" + name + ".cfg"}};
    writeFile(folder_ / "cfg" / (name + ".cfg"), configurationFile(component.second));
  }
  writeFile(folder_ / "session.json",
            session.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
}

}  // namespace vismem
