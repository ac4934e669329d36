/// @file Declaration of parameters: key, value, range and meaning in one place. Pure. See C2.
#pragma once

#include <cstddef>
#include <initializer_list>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace vismem {

/// A key as the parameters declare it. The texts are literals.
struct Key {
  std::string_view name;     ///< without the groups around it: "MinimumLength_px"
  std::string_view meaning;  ///< for the component's README
  bool is_basic = false;     ///< shown with its value in cfg/sim; the others are for experts
};

constexpr Key basic(std::string_view name, std::string_view meaning) {
  return {name, meaning, true};
}
constexpr Key expert(std::string_view name, std::string_view meaning) {
  return {name, meaning, false};
}

/// Goes through the parameters of a struct, which declares each of them once in its `visit(visitor)`. One
/// visitor reads them from a configuration, which then knows names, ranges and meanings of all keys.
class ParameterVisitor {
 public:
  virtual ~ParameterVisitor() = default;

  virtual void real(const Key& key, double& value, double minimum, double maximum) = 0;
  /// An angle in radians whose key is in degrees and ends in _deg, _degps, _degps2 or _degpm.
  virtual void angle(const Key& key, double& value_rad, double minimum_deg, double maximum_deg) = 0;
  virtual void integer(const Key& key, int& value, int minimum, int maximum) = 0;
  virtual void flag(const Key& key, bool& value) = 0;
  /// Words between blanks.
  virtual void words(const Key& key, std::vector<std::string>& value) = 0;
  /// One of several words: choice(basic("Mode", "..."), mode, {{"attend", GazeMode::kAttend}, ...}).
  template <typename T>
  void choice(const Key& key, T& value,
              std::initializer_list<std::pair<std::string_view, std::type_identity_t<T>>> choices) {
    std::vector<std::string> names;
    std::size_t index = 0;
    for (const auto& [name, choice] : choices) {
      if (choice == value) index = names.size();
      names.emplace_back(name);
    }
    oneOf(key, index, names);
    value = (choices.begin() + index)->second;
  }
  /// A rule between two keys of the group.
  /// @param relation of the first to the second: "must be less than".
  virtual void require(std::string_view name, bool holds, std::string_view relation,
                       std::string_view other_name) = 0;
  /// An old name of a key; to be called before the key (ConfigReader::alias).
  virtual void alias(std::string_view old_name, std::string_view new_name) = 0;

  /// The parameters of a part, whose keys begin with NAME and a dot.
  template <typename Params>
  void group(std::string_view name, Params& params) {
    enter(name);
    params.visit(*this);
    leave();
  }

 protected:
  virtual void oneOf(const Key& key, std::size_t& index, const std::vector<std::string>& names) = 0;
  virtual void enter(std::string_view name) = 0;
  virtual void leave() = 0;
};

}  // namespace vismem
