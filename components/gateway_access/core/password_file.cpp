#include "gateway_access/core/password_file.h"

#include <crypt.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string_view>
#include <vector>

#include "common/config/config_error.h"
#include "common/config/text_fields.h"

namespace vismem {
namespace {

/// Of a random password that nobody has; made with `openssl passwd -6`.
constexpr const char* kNobody =
    "$6$vismemgateway000$feIMge9tLu4NNqWzcGnx89VzO.g4VC4LR2Vj9UgECc4w7MepOSb9b3h1NwoFcXfdbyRdUCzZVesm/"
    "wwSwzOcG.";
constexpr std::array<std::string_view, 4> kKinds{"$6$", "$5$", "$y$", "$2b$"};
constexpr std::size_t kLongestPassword = 200;

/// Comparison whose duration does not depend on where two texts differ.
bool isSame(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference |= static_cast<unsigned>(static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]));
  return difference == 0;
}

bool matches(const std::string& password, const std::string& hash) {
  const auto data = std::make_unique<crypt_data>();
  const char* result = crypt_r(password.c_str(), hash.c_str(), data.get());
  return result != nullptr && result[0] != '*' && isSame(result, hash);
}

/// @return what is wrong with a line; empty if nothing is.
std::string wrongLine(const std::vector<std::string_view>& fields,
                      const std::map<std::string, std::string>& known) {
  if (fields.size() != 2) return "must be USER HASH";
  if (known.contains(std::string(fields[0])))
    return "user " + std::string(fields[0]) + " stands above already";
  const bool is_hash =
      std::any_of(kKinds.begin(), kKinds.end(), [&](auto kind) { return fields[1].starts_with(kind); });
  if (!is_hash)
    return "user " + std::string(fields[0]) + " needs a hash of SHA-512, as `openssl passwd -6` makes it";
  return "";
}

}  // namespace

PasswordFile PasswordFile::parse(const std::string& text, const std::string& source) {
  PasswordFile file;
  std::vector<std::string> problems;
  int number = 0;
  for (const auto line : splitAt(text, '\n')) {
    ++number;
    const auto fields = words(line);
    if (fields.empty() || fields[0].starts_with('#')) continue;
    const auto wrong = wrongLine(fields, file.hashes_);
    if (wrong.empty())
      file.hashes_.emplace(fields[0], fields[1]);
    else
      problems.push_back(source + ":" + std::to_string(number) + ": " + wrong);
  }
  if (!problems.empty()) throw ConfigError(problems);
  return file;
}

bool PasswordFile::isRight(const std::string& user, const std::string& password) const {
  // A text with a zero byte would end early for crypt().
  if (password.empty() || password.size() > kLongestPassword || password.find('\0') != std::string::npos)
    return false;
  const auto found = hashes_.find(user);
  const bool right = matches(password, found == hashes_.end() ? kNobody : found->second);
  return right && found != hashes_.end();
}

}  // namespace vismem
