#include "server/net/connection_table.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace curvecast::server {
namespace {

/// Both ends of a connection.
struct Connection {
  Connection() { EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  ~Connection() {
    ::close(ends[0]);
    ::close(ends[1]);
  }
  int served() const { return ends[0]; }
  /// Whether the served end has been ended.
  bool has_ended() const {
    char byte = 0;
    return ::recv(ends[1], &byte, 1, MSG_DONTWAIT) == 0;
  }
  std::array<int, 2> ends = {-1, -1};
};

TEST(ConnectionTable, TheOldestThatHasMadeNoCallGivesWay) {
  ConnectionTable table(3);
  std::vector<std::unique_ptr<Connection>> all;
  const auto add = [&](const std::string& peer) {
    return table.add(all.emplace_back(std::make_unique<Connection>())->served(), peer);
  };
  EXPECT_TRUE(add("caller") && add("first") && add("second"));
  table.note_call("caller");
  table.note_call("nobody");
  EXPECT_TRUE(add("third"));
  EXPECT_FALSE(all[0]->has_ended());
  EXPECT_TRUE(all[1]->has_ended());
  EXPECT_FALSE(all[2]->has_ended());
  EXPECT_EQ(table.ended(), 1u);
  EXPECT_EQ(table.refused(), 0u);
}

TEST(ConnectionTable, KnowsForWhomAProxyConnects) {
  ConnectionTable table(1);
  Connection a, b;
  EXPECT_TRUE(table.add(a.served(), "proxy:1", "client:1"));
  EXPECT_EQ(table.client_of("proxy:1"), "client:1");
  EXPECT_EQ(table.client_of("proxy:2"), "proxy:2");
  table.note_call("proxy:1");
  EXPECT_EQ(table.client_of("proxy:1"), "client:1");
  EXPECT_FALSE(table.add(b.served(), "proxy:2", "client:2"));
  EXPECT_EQ(table.client_of("proxy:2"), "proxy:2");
}

TEST(ConnectionTable, RefusesOneMoreWhereAllHaveMadeCalls) {
  ConnectionTable table(2);
  Connection a, b, c;
  EXPECT_TRUE(table.add(a.served(), "a") && table.add(b.served(), "b"));
  for (const char* peer : {"a", "b", "a"}) table.note_call(peer);
  EXPECT_FALSE(table.add(c.served(), "c"));
  EXPECT_EQ(table.refused(), 1u);
  EXPECT_EQ(table.ended(), 0u);
  EXPECT_FALSE(a.has_ended() || b.has_ended() || c.has_ended());
}

TEST(ConnectionTable, WhatOthersHaveClosedCountsNoMore) {
  ConnectionTable table(10);
  {
    const Connection gone;
    EXPECT_TRUE(table.add(gone.served(), "gone"));
    EXPECT_EQ(table.count(), 1u);
  }
  EXPECT_EQ(table.count(), 0u);
  // A descriptor that comes again is another connection's, even before anybody has looked.
  int descriptor = -1;
  {
    const Connection gone;
    descriptor = gone.served();
    EXPECT_TRUE(table.add(descriptor, "gone"));
  }
  const Connection next;
  EXPECT_EQ(next.served(), descriptor);
  EXPECT_TRUE(table.add(descriptor, "next"));
  EXPECT_EQ(table.count(), 1u);
}

TEST(ConnectionTable, EndsNoSocketThatIsAnotherOnes) {
  ConnectionTable table(1);
  int descriptor = -1;
  {
    const Connection gone;
    descriptor = gone.served();
    EXPECT_TRUE(table.add(descriptor, "gone"));
  }
  const Connection others;  // not of this table
  EXPECT_EQ(others.served(), descriptor);
  const Connection next;
  EXPECT_TRUE(table.add(next.served(), "next"));
  EXPECT_FALSE(others.has_ended());
}

}  // namespace
}  // namespace curvecast::server
