#include "common/process/certificate.h"

#include <IceSSL/OpenSSL.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>
#include <sys/stat.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <mutex>
#include <stdexcept>

#include "common/config/config_error.h"
#include "common/process/status.h"

namespace vismem {
namespace {

using Certificate = std::unique_ptr<X509, decltype(&X509_free)>;
using PrivateKey = std::unique_ptr<EVP_PKEY, decltype(&EVP_PKEY_free)>;
using File = std::unique_ptr<std::FILE, decltype(&std::fclose)>;

constexpr double kDay_s = 86'400;

File openFile(const std::filesystem::path& path) {
  File file(std::fopen(path.c_str(), "r"), &std::fclose);
  if (file == nullptr) throw std::runtime_error(path.string() + ": cannot be read");
  return file;
}

Certificate loadCertificate(const std::filesystem::path& path) {
  const File file = openFile(path);
  Certificate certificate(PEM_read_X509(file.get(), nullptr, nullptr, nullptr), &X509_free);
  ERR_clear_error();
  if (certificate == nullptr) throw std::runtime_error(path.string() + ": has no certificate in PEM");
  return certificate;
}

PrivateKey loadKey(const std::filesystem::path& path) {
  const File file = openFile(path);
  // A key with a password would be asked for on the terminal.
  const auto no_password = [](char*, int, int, void*) { return 0; };
  PrivateKey key(PEM_read_PrivateKey(file.get(), nullptr, no_password, nullptr), &EVP_PKEY_free);
  ERR_clear_error();
  if (key == nullptr) throw std::runtime_error(path.string() + ": has no key in PEM without a password");
  return key;
}

std::chrono::system_clock::time_point timeOf(const ASN1_TIME* time) {
  std::tm parts{};
  if (ASN1_TIME_to_tm(time, &parts) != 1) throw std::runtime_error("a time that is none");
  return std::chrono::system_clock::from_time_t(timegm(&parts));
}

CertificateLife lifeOf(const X509& certificate) {
  const std::unique_ptr<BIO, decltype(&BIO_free)> text(BIO_new(BIO_s_mem()), &BIO_free);
  X509_NAME_print_ex(text.get(), X509_get_subject_name(&certificate), 0, XN_FLAG_RFC2253);
  char* begin = nullptr;
  const long size = BIO_get_mem_data(text.get(), &begin);
  return {timeOf(X509_get0_notBefore(&certificate)), timeOf(X509_get0_notAfter(&certificate)),
          std::string(begin, static_cast<std::size_t>(size))};
}

/// Which file it is and when it was written: "INODE.SECONDS.NANOSECONDS". Empty without one.
std::string stampOf(const std::filesystem::path& path) {
  struct stat found {};
  if (stat(path.c_str(), &found) != 0) return "";
  return std::to_string(found.st_ino) + "." + std::to_string(found.st_mtim.tv_sec) + "." +
         std::to_string(found.st_mtim.tv_nsec);
}

std::string dateOf(std::chrono::system_clock::time_point time) {
  const auto seconds = std::chrono::system_clock::to_time_t(time);
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  std::array<char, 20> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%d", &parts);
  return text.data();
}

}  // namespace

double CertificateLife::daysLeft(std::chrono::system_clock::time_point now) const {
  return std::chrono::duration<double>(end - now).count() / kDay_s;
}

CertificateLife readCertificate(const std::filesystem::path& file) {
  return lifeOf(*loadCertificate(file));
}

/// What handshakes show. OpenSSL asks for it in the threads of Ice.
struct OwnCertificate::Pair {
  std::mutex mutex;
  Certificate certificate{nullptr, &X509_free};
  PrivateKey key{nullptr, &EVP_PKEY_free};

  /// @throw std::runtime_error if the two do not belong together.
  void replace(Certificate new_certificate, PrivateKey new_key) {
    const bool belongs = X509_check_private_key(new_certificate.get(), new_key.get()) == 1;
    ERR_clear_error();
    if (!belongs) throw std::runtime_error("certificate and key do not belong together");
    const std::scoped_lock lock(mutex);
    certificate = std::move(new_certificate);
    key = std::move(new_key);
  }

  static int show(SSL* connection, void* pair) {
    auto& self = *static_cast<Pair*>(pair);
    const std::scoped_lock lock(self.mutex);
    // Until files have changed IceSSL's own choice stands.
    if (self.certificate == nullptr) return 1;
    return SSL_use_certificate(connection, self.certificate.get()) == 1 &&
                   SSL_use_PrivateKey(connection, self.key.get()) == 1
               ? 1
               : 0;
  }
};

OwnCertificate::OwnCertificate(std::filesystem::path certificate, std::filesystem::path key)
    : certificate_file_(std::move(certificate)),
      key_file_(std::move(key)),
      life_(readCertificate(certificate_file_)),
      stamp_(stampOf(certificate_file_) + " " + stampOf(key_file_)),
      pair_(std::make_unique<Pair>()) {}

OwnCertificate::~OwnCertificate() = default;

std::unique_ptr<OwnCertificate> OwnCertificate::of(Ice::Communicator& communicator) {
  const auto properties = communicator.getProperties();
  const std::string certificate = properties->getProperty("IceSSL.CertFile");
  if (properties->getProperty("Ice.Plugin.IceSSL").empty() || certificate.empty()) return nullptr;
  const auto plugin = std::dynamic_pointer_cast<IceSSL::OpenSSL::Plugin>(
      communicator.getPluginManager()->getPlugin("IceSSL"));
  if (plugin == nullptr) return nullptr;
  const std::filesystem::path folder = properties->getProperty("IceSSL.DefaultDir");
  const std::string key = properties->getPropertyWithDefault("IceSSL.KeyFile", certificate);
  std::unique_ptr<OwnCertificate> own;
  try {
    own.reset(new OwnCertificate(folder / certificate, folder / key));
  } catch (const std::runtime_error& failure) {
    throw ConfigError({std::string(failure.what()) + " (IceSSL.CertFile must name one)"});
  }
  SSL_CTX_set_cert_cb(plugin->getContext(), &Pair::show, own->pair_.get());
  return own;
}

void OwnCertificate::look(StatusBoard& status, std::chrono::system_clock::time_point now) {
  const std::string stamp = stampOf(certificate_file_) + " " + stampOf(key_file_);
  if (stamp != stamp_ && stamp != tried_stamp_) {
    tried_stamp_ = stamp;
    renew(status);
  }
  report(status, now);
}

void OwnCertificate::renew(StatusBoard& status) {
  // Of a pair that is half written the old one stays in use; the other half's arrival is a change again.
  try {
    Certificate certificate = loadCertificate(certificate_file_);
    const CertificateLife life = lifeOf(*certificate);
    pair_->replace(std::move(certificate), loadKey(key_file_));
    life_ = life;
    stamp_ = tried_stamp_;
    status.healthy("certificate");
    status.note("the certificate was renewed: " + life_.subject + ", valid until " + dateOf(life_.end));
  } catch (const std::runtime_error& failure) {
    status.error("the new certificate cannot be used, the old one stays: " + std::string(failure.what()));
  }
}

void OwnCertificate::report(StatusBoard& status, std::chrono::system_clock::time_point now) {
  const double left_days = life_.daysLeft(now);
  status.gauge({"certificate days left", left_days, 0.0, "d"});
  if (left_days < 0) {
    status.fault("certificate", "has ended on " + dateOf(life_.end) + ": no new connection is accepted");
  } else if (left_days < kCertificateWarning_days) {
    const std::string text = "the certificate ends in " +
                             std::to_string(static_cast<int>(std::floor(left_days))) + " days, on " +
                             dateOf(life_.end) + ": renew it (deploy/pki/certificates renew)";
    if (text != reported_) status.error(text);
    reported_ = text;
  }
}

}  // namespace vismem
