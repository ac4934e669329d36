/// @file The certificate with which this process shows who it is (IceSSL): how long it is valid, and its
/// renewal without a restart.
#pragma once

#include <Ice/Ice.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>

namespace vismem {

class StatusBoard;

/// When a certificate is valid, and whose it is.
struct CertificateLife {
  std::chrono::system_clock::time_point begin;
  std::chrono::system_clock::time_point end;
  /// "CN=robot7,OU=robot,O=vismem".
  std::string subject;

  /// Days until its end; negative after it.
  double daysLeft(std::chrono::system_clock::time_point now) const;
};

/// Reads the first certificate of a PEM file.
/// @throw std::runtime_error that names the file.
CertificateLife readCertificate(const std::filesystem::path& file);

/// A certificate that ends within so many days is reported.
inline constexpr double kCertificateWarning_days = 30;

/// The certificate of a communicator with IceSSL. Watches its files: a new pair of certificate and key is
/// used for every connection from then on; connections that stand go on. Gauge "certificate days left"; a
/// certificate that ends soon is an error of the status once a day, one that has ended a fault. Main thread
/// only; must outlive the communicator.
class OwnCertificate {
 public:
  /// @return null if the communicator has no IceSSL, or no certificate (IceSSL.CertFile).
  /// @throw ConfigError for a file that cannot be read.
  static std::unique_ptr<OwnCertificate> of(Ice::Communicator& communicator);
  ~OwnCertificate();

  /// Reads files that have changed and reports. To be called periodically; cheap when nothing has changed.
  void look(StatusBoard& status, std::chrono::system_clock::time_point now);

 private:
  struct Pair;

  OwnCertificate(std::filesystem::path certificate, std::filesystem::path key);
  void renew(StatusBoard& status);
  void report(StatusBoard& status, std::chrono::system_clock::time_point now);

  const std::filesystem::path certificate_file_;
  const std::filesystem::path key_file_;
  CertificateLife life_;
  std::string stamp_;        ///< of the files as they were read
  std::string tried_stamp_;  ///< of files that could not be used
  std::string reported_;     ///< what was last said of the end
  std::unique_ptr<Pair> pair_;
};

}  // namespace vismem
