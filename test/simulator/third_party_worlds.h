/// @file Worlds and models as third parties write them, for tests.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "simulator/core/world.h"

namespace vismem {

inline const std::string kVisual =
    "<visual name='v'><geometry><box><size>1 1 1</size></box></geometry></visual>";
inline const std::string kBox = "<link name='l'>" + kVisual + "</link>";

class ThirdPartyWorlds : public testing::Test {
 protected:
  ThirdPartyWorlds()
      : folder_(std::filesystem::path(testing::TempDir()) / ("third_party_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(folder_);
  }
  ~ThirdPartyWorlds() override { std::filesystem::remove_all(folder_); }

  static std::string sdf(const std::string& content, const std::string& version = "version='1.6'") {
    return "<sdf " + version + ">\n<world name='w'>\n" + content + "</world></sdf>";
  }
  LoadedWorld load(const std::string& text) { return parseWorld(text, "w.world", {folder_}); }
  void put(const std::string& name, const std::string& bytes) {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
  }
  /// A model in a folder of its own; `sdf` is its file.
  void putModel(const std::string& name, const std::string& sdf) {
    put(name + "/model.config", "<model><name>" + name + "</name><sdf version='1.6'>model.sdf</sdf></model>");
    put(name + "/model.sdf", sdf);
  }
  static std::vector<std::string> names(const World& world) {
    std::vector<std::string> result;
    for (const auto& model : world.models) {
      for (const auto& body : model.bodies) result.push_back(model.name + "/" + body.name);
    }
    return result;
  }
  static Eigen::AlignedBox3f bounds(const World& world, const std::string& name) {
    Eigen::AlignedBox3f box;
    const auto index = world.modelNamed(name);
    if (!index) throw std::runtime_error("no model " + name);
    const WorldModel& model = world.models[*index];
    for (const auto& body : model.bodies) {
      for (const auto& v : body.vertices) box.extend(model.pose.cast<float>() * v);
    }
    return box;
  }
  static void expectBounds(const Eigen::AlignedBox3f& box, const Eigen::Vector3f& low,
                           const Eigen::Vector3f& high) {
    EXPECT_LT((box.min() - low).norm(), 1e-3F) << box.min().transpose();
    EXPECT_LT((box.max() - high).norm(), 1e-3F) << box.max().transpose();
  }

  std::filesystem::path folder_;
};

}  // namespace vismem
