#include "gateway_access/core/password_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>

#include "common/config/config_error.h"

namespace vismem {
namespace {

// Made by other programs: `openssl passwd -6 -salt abcdefgh ana's`, `openssl passwd -5 -salt abcdefgh vera`.
constexpr const char* kAna =
    "$6$abcdefgh$sJRqMRfqjNgobW57OU/MzsGYw13B45XDClKOi042//n6cxxxUBJdQ8jaCtFCTSnE1bEmlcqV5VLJkdzIVMZ8M0";
constexpr const char* kVera = "$5$abcdefgh$cU1hdSp0d/ulqe7UzltWrneA9uA3Vmv8kq7wpP.QK7D";

double secondsFor(const PasswordFile& file, const std::string& user) {
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(file.isRight(user, "guess"));
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

TEST(PasswordFile, TakesTheRightPasswordOnly) {
  const auto file =
      PasswordFile::parse(std::string("# operators\n\nana ") + kAna + "\nvera\t" + kVera + "\n", "x");
  EXPECT_EQ(file.size(), 2u);
  EXPECT_TRUE(file.isRight("ana", "ana's"));
  EXPECT_TRUE(file.isRight("vera", "vera"));
  EXPECT_FALSE(file.isRight("ana", "vera"));
  EXPECT_FALSE(file.isRight("vera", "ana's"));
  EXPECT_FALSE(file.isRight("ana", ""));
  EXPECT_FALSE(file.isRight("ana", std::string("ana's\0x", 7)));
  EXPECT_FALSE(file.isRight("nobody", "ana's"));
  EXPECT_FALSE(file.isRight("", ""));
  EXPECT_FALSE(file.isRight("ana", std::string(100'000, 'a')));
}

TEST(PasswordFile, AnUnknownUserTakesAsLongAsAWrongPassword) {
  const auto file = PasswordFile::parse(std::string("ana ") + kAna + "\n", "x");
  const double known_s = secondsFor(file, "ana");
  const double unknown_s = secondsFor(file, "nobody");
  EXPECT_GT(unknown_s, 0.3 * known_s);
  EXPECT_LT(unknown_s, 3.0 * known_s);
}

TEST(PasswordFile, EveryWrongLineIsReportedWithoutItsSecret) {
  try {
    PasswordFile::parse(std::string("ana ") + kAna + "\nana " + kAna +
                            "\nbob\nkim secret\nold $1$abc$HqTKFXrZfGJSoUEeCF8Ma1\n",
                        "operators");
    FAIL() << "nothing was thrown";
  } catch (const ConfigError& error) {
    EXPECT_THAT(error.problems(),
                testing::ElementsAre(
                    "operators:2: user ana stands above already", "operators:3: must be USER HASH",
                    "operators:4: user kim needs a hash of SHA-512, as `openssl passwd -6` makes it",
                    "operators:5: user old needs a hash of SHA-512, as `openssl passwd -6` makes it"));
  }
}

}  // namespace
}  // namespace vismem
