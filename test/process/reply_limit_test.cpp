// A server keeps a bounded number of unread replies for a client, then closes its connection.
#include "common/process/reply_limit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <future>
#include <mutex>
#include <thread>
#include <vector>

#include "untrusted_clients/ice_wire.h"
#include "untrusted_clients/raw_connection.h"

namespace vismem {
namespace {

using namespace std::chrono_literals;

/// Answers any call with a megabyte.
class Generous : public Ice::Blobject {
 public:
  bool ice_invoke(std::vector<Ice::Byte>, std::vector<Ice::Byte>& out, const Ice::Current& current) override {
    Ice::OutputStream stream(current.adapter->getCommunicator());
    stream.startEncapsulation();
    stream.write(std::vector<Ice::Byte>(1 << 20, 7));
    stream.endEncapsulation();
    stream.finished(out);
    return true;
  }
};

class ReplyLimitTest : public testing::Test {
 protected:
  ReplyLimitTest() {
    Ice::InitializationData data;
    data.properties = Ice::createProperties();
    data.properties->setProperty("Ice.Warn.Connections", "0");
    data.observer = std::make_shared<ReplyLimit>(16 << 20, [this](const std::string& peer) {
      const std::lock_guard lock(mutex_);
      closed_.push_back(peer);
    });
    server_ = Ice::CommunicatorHolder(data);
    adapter_ =
        server_->createObjectAdapterWithEndpoints("Generous", "tcp -h 127.0.0.1 -p 0:ws -h 127.0.0.1 -p 0");
    adapter_->add(std::make_shared<Generous>(), Ice::stringToIdentity("generous"));
    adapter_->activate();
  }
  int port() const {
    return std::dynamic_pointer_cast<Ice::IPEndpointInfo>(adapter_->getEndpoints().at(0)->getInfo())->port;
  }
  std::size_t closed() {
    const std::lock_guard lock(mutex_);
    return closed_.size();
  }

  std::mutex mutex_;
  std::vector<std::string> closed_;
  Ice::CommunicatorHolder server_;
  std::shared_ptr<Ice::ObjectAdapter> adapter_;
};

TEST_F(ReplyLimitTest, ClosesTheConnectionOfAClientThatNeverReads) {
  test::RawConnection greedy(port());
  ASSERT_TRUE(greedy.receive());
  const std::string request = test::request({1, "generous", "", "", "anything", true, ""});
  // A socket's buffers take a few megabytes; 64 answers are more than they and the limit.
  for (int i = 0; i < 64; ++i) greedy.send(request);
  const auto deadline = std::chrono::steady_clock::now() + 10s;
  while (closed() == 0 && std::chrono::steady_clock::now() < deadline) std::this_thread::yield();
  EXPECT_EQ(closed(), 1u);
  EXPECT_FALSE(greedy.drain(10s)) << "it is closed";
}

TEST_F(ReplyLimitTest, LeavesClientsThatReadAlone) {
  Ice::InitializationData data;
  data.properties = Ice::createProperties();
  data.properties->setProperty("Ice.MessageSizeMax", "16384");
  const Ice::CommunicatorHolder client(data);
  for (const auto& endpoint : adapter_->getEndpoints()) {
    const auto object = client->stringToProxy("generous:" + endpoint->toString());
    std::vector<std::future<Ice::Object::Ice_invokeResult>> calls;
    for (int round = 0; round < 20; ++round) {
      for (int i = 0; i < 4; ++i) {
        calls.push_back(
            object->ice_invokeAsync("anything", Ice::OperationMode::Normal, std::vector<Ice::Byte>()));
      }
      for (auto& call : calls) EXPECT_GT(call.get().outParams.size(), 1u << 20);
      calls.clear();
    }
  }
  EXPECT_EQ(closed(), 0u);
}

}  // namespace
}  // namespace vismem
