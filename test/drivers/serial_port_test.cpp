// The serial port on a pseudo terminal: bytes both ways, waits, and the message of each failure.
#include "common/serial/serial_port.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <thread>

#include "support/file_permissions.h"
#include "support/pty_line.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;
using Kind = SerialPort::Input::Kind;
using testing::ElementsAre;
using Clock = SerialPort::Clock;

class SerialPortTest : public testing::Test {
 protected:
  PtyLine line;
  SerialPort port;
};

TEST_F(SerialPortTest, CarriesEveryByteBothWays) {
  ASSERT_EQ(port.open(line.path(), 38400), "");
  EXPECT_EQ(line.baud_bps(), 38400);
  std::vector<std::uint8_t> all(256);
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::uint8_t>(i);
  ASSERT_EQ(port.write(all, Clock::now() + 5s), "");
  std::vector<std::uint8_t> came;
  while (came.size() < all.size()) {
    const auto more = line.read(5000);
    ASSERT_FALSE(more.empty());
    came.insert(came.end(), more.begin(), more.end());
  }
  EXPECT_EQ(came, all);
  line.write(all);
  came.clear();
  while (came.size() < all.size()) {
    const auto input = port.read(Clock::now() + 5s);
    ASSERT_EQ(input.kind, Kind::kBytes);
    came.insert(came.end(), input.bytes.begin(), input.bytes.end());
  }
  EXPECT_EQ(came, all);
  EXPECT_EQ(port.setBaud(57600), "");
  EXPECT_EQ(line.baud_bps(), 57600);
}

TEST_F(SerialPortTest, WaitsUntilTheDeadlineOrItIsWoken) {
  ASSERT_EQ(port.open(line.path(), 9600), "");
  const auto began = Clock::now();
  EXPECT_EQ(port.read(began + 60ms).kind, Kind::kNothing);
  EXPECT_GE(Clock::now() - began, 60ms);
  std::jthread waker([&] { port.wake(); });
  EXPECT_EQ(port.read(Clock::now() + 20s).kind, Kind::kWoken);
  waker.join();
  EXPECT_LT(Clock::now() - began, 10s);
  EXPECT_EQ(port.read(Clock::now()).kind, Kind::kNothing) << "woken once";
  // The line goes on after a wake.
  line.write(std::vector<std::uint8_t>{4});
  EXPECT_THAT(port.read(Clock::now() + 5s).bytes, ElementsAre(4));
}

TEST_F(SerialPortTest, SaysWhenTheLineIsPulledOut) {
  ASSERT_EQ(port.open(line.path(), 9600), "");
  std::jthread puller([&] { line.unplug(); });
  const auto input = port.read(Clock::now() + 20s);
  EXPECT_EQ(input.kind, Kind::kGone);
  EXPECT_EQ(input.why, line.path() + ": hung up (unplugged?)");
  EXPECT_EQ(port.write(std::vector<std::uint8_t>{1}, Clock::now() + 1s),
            line.path() + ": hung up (unplugged?)");
  puller.join();
  EXPECT_EQ(port.open(line.path(), 9600), line.path() + ": no such device");
  line.plugIn();
  EXPECT_EQ(port.open(line.path(), 9600), "");
}

TEST_F(SerialPortTest, SaysWhenTheDeviceTakesNoBytes) {
  ASSERT_EQ(port.open(line.path(), 9600), "");
  // Without a reader at the other end, its buffer fills up.
  const std::vector<std::uint8_t> much(1 << 20, 'x');
  EXPECT_EQ(port.write(much, Clock::now() + 50ms), line.path() + ": takes no bytes");
}

TEST_F(SerialPortTest, BelongsToOneProgramAtATime) {
  ASSERT_EQ(port.open(line.path(), 9600), "");
  SerialPort other;
  EXPECT_EQ(other.open(line.path(), 9600), line.path() + ": another program uses it");
  port.close();
  EXPECT_EQ(other.open(line.path(), 9600), "");
}

TEST_F(SerialPortTest, NamesWhatKeepsItFromOpening) {
  TemporaryFolder folder;
  EXPECT_EQ(port.open("/dev/ttyNONE7", 9600), "/dev/ttyNONE7: no such device");
  const std::string file = folder / "file";
  std::ofstream(file) << "text";
  EXPECT_EQ(port.open(file, 9600), file + ": not a serial port");
  EXPECT_EQ(port.open(folder.path(), 9600), folder.path().string() + ": not a serial port");
  EXPECT_EQ(port.open("/dev/null", 9600), "/dev/null: not a serial port");
  EXPECT_EQ(port.open(line.path(), 12345), line.path() + ": a rate of 12345 bit/s is not possible");
  EXPECT_FALSE(port.isOpen());
  EXPECT_EQ(port.read(Clock::now()).kind, Kind::kGone);
  EXPECT_TRUE(isBaudRate(9600));
  EXPECT_FALSE(isBaudRate(9601));
}

TEST_F(SerialPortTest, NamesAMissingPermission) {
  TemporaryFolder folder;
  const std::string closed = folder / "closed";
  std::ofstream(closed) << "text";
  ASSERT_EQ(chmod(closed.c_str(), 0), 0);
  const FilePermissionsCount permissions_count;
  EXPECT_EQ(port.open(closed, 9600), closed + ": no permission (serial ports belong to the group dialout)");
}

}  // namespace
}  // namespace vismem
