/// @file The users of a gateway and the hashes of their passwords (crypt(5)). Pure.
#pragma once

#include <map>
#include <string>

namespace vismem {

/// Users and hashes, as made by `openssl passwd -6` or `mkpasswd -m sha-512`.
class PasswordFile {
 public:
  /// Reads lines "USER HASH"; empty lines and lines that begin with '#' are left out.
  /// @param source name of the file, for messages.
  /// @throw ConfigError with every wrong line: no hash, a user twice, a hash that is none or a weak one (only
  /// SHA-512, SHA-256, yescrypt and bcrypt are taken). No message shows a hash.
  static PasswordFile parse(const std::string& text, const std::string& source);

  std::size_t size() const { return hashes_.size(); }

  /// Whether this is the user's password. An unknown user takes as long as a wrong password, so that nobody
  /// learns who is one. Takes milliseconds, by design of the hashes.
  bool isRight(const std::string& user, const std::string& password) const;

 private:
  std::map<std::string, std::string> hashes_;
};

}  // namespace vismem
