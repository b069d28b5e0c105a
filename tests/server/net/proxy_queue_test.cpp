#include "server/net/proxy_queue.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <memory>
#include <string>
#include <vector>

#include "tests/server/eventually.h"

namespace curvecast::server {
namespace {

/// Both ends of a connection, of which a queue has one.
struct Connection {
  Connection() { EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection() { ::close(ends[1]); }
  ProxyQueue::Connection served() const { return {.listener = 7, .descriptor = ends[0], .peer = "ipv4:10.0.0.2:1"}; }
  void send(const std::string& bytes) const {
    EXPECT_EQ(::send(ends[1], bytes.data(), bytes.size(), 0), static_cast<ssize_t>(bytes.size()));
  }
  bool has_ended() const {
    char byte = 0;
    const ssize_t count = ::recv(ends[1], &byte, 1, MSG_DONTWAIT);
    return count == 0 || (count < 0 && errno == ECONNRESET);
  }
  std::array<int, 2> ends = {-1, -1};
};

class ProxyQueueTest : public ::testing::Test {
 protected:
  ProxyQueue::Give give_ = [this](const ProxyQueue::Connection& connection, const std::string& client) {
    EXPECT_EQ(connection.listener, 7);
    EXPECT_EQ(connection.peer, "ipv4:10.0.0.2:1");
    given_.push_back(client);
    ::close(connection.descriptor);
  };
  std::vector<std::string> given_;
  ProxyQueue queue_;
};

constexpr char kHeader[] = "PROXY TCP4 198.51.100.1 10.0.0.2 4711 443\r\n";

TEST_F(ProxyQueueTest, GivesAtOnceWhatHasItsHeader) {
  Connection with, without;
  with.send(kHeader);
  without.send("PRI * HTTP/2.0\r\n");
  queue_.add(with.served(), give_);
  queue_.add(without.served(), give_);
  EXPECT_EQ(given_, (std::vector<std::string>{"ipv4:198.51.100.1:4711", ""}));
  EXPECT_TRUE(queue_.is_empty());
}

TEST_F(ProxyQueueTest, WaitsForTheRest) {
  Connection slow, silent;
  slow.send("PROXY TC");
  queue_.add(slow.served(), give_);
  queue_.add(silent.served(), give_);
  queue_.serve(give_);
  EXPECT_TRUE(given_.empty());
  EXPECT_FALSE(queue_.is_empty());
  slow.send(std::string(kHeader).substr(8));
  queue_.serve(give_);
  EXPECT_EQ(given_.size(), 1u);
  EXPECT_TRUE(eventually([&] {
    queue_.serve(give_);
    return queue_.is_empty();
  })) << "whoever says nothing is taken as it is";
  EXPECT_EQ(given_, (std::vector<std::string>{"ipv4:198.51.100.1:4711", ""}));
}

TEST_F(ProxyQueueTest, ClosesWhatIsBrokenOrNeverComes) {
  Connection broken, cut;
  broken.send("PROXY nonsense\r\n");
  cut.send("PROXY TCP4");
  queue_.add(broken.served(), give_);
  EXPECT_TRUE(broken.has_ended());
  queue_.add(cut.served(), give_);
  EXPECT_TRUE(eventually([&] {
    queue_.serve(give_);
    return cut.has_ended();
  }));
  EXPECT_TRUE(given_.empty());
}

TEST_F(ProxyQueueTest, OfTooManyTheOldestGoes) {
  std::vector<std::unique_ptr<Connection>> all;
  while (all.size() < 65) {
    all.push_back(std::make_unique<Connection>());
    queue_.add(all.back()->served(), give_);
  }
  EXPECT_TRUE(all[0]->has_ended());
  EXPECT_FALSE(all[1]->has_ended());
  EXPECT_TRUE(given_.empty());
}

TEST(ProxyQueue, ClosesWhatItHasWhenItGoes) {
  Connection one;
  {
    ProxyQueue queue;
    queue.add(one.served(), {});
  }
  EXPECT_TRUE(one.has_ended());
}

}  // namespace
}  // namespace curvecast::server
