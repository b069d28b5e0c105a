#include "server/net/peer_name.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>

namespace curvecast::server {
namespace {

std::string six(const char* host, unsigned scope = 0) {
  sockaddr_in6 address = {};
  address.sin6_family = AF_INET6;
  address.sin6_port = htons(4711);
  address.sin6_scope_id = scope;
  EXPECT_EQ(::inet_pton(AF_INET6, host, &address.sin6_addr), 1);
  return peer_name(reinterpret_cast<const sockaddr*>(&address));
}

TEST(PeerName, IsWhatGrpcWrites) {
  sockaddr_in four = {};
  four.sin_family = AF_INET;
  four.sin_port = htons(50051);
  ASSERT_EQ(::inet_pton(AF_INET, "127.0.0.1", &four.sin_addr), 1);
  EXPECT_EQ(peer_name(reinterpret_cast<const sockaddr*>(&four)), "ipv4:127.0.0.1:50051");
  EXPECT_EQ(six("::1"), "ipv6:%5B::1%5D:4711");
  EXPECT_EQ(six("fe80::1", 2), "ipv6:%5Bfe80::1%252%5D:4711");
  EXPECT_EQ(six("::ffff:10.0.0.1"), "ipv4:10.0.0.1:4711");
  const sockaddr none = {};
  EXPECT_EQ(peer_name(&none), "unknown:0");
}

}  // namespace
}  // namespace curvecast::server
