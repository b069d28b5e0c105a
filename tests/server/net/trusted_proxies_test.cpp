#include "server/net/trusted_proxies.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;

constexpr char kProxy[] = "ipv4:10.1.2.3:4711";

/// With two networks and an address of proxies. Empty: the peer itself is the client.
std::string client_of(const std::string& peer, const std::vector<std::string_view>& forwarded_for) {
  const auto proxies = TrustedProxies::parse({"10.0.0.0/8", "192.168.7.1", "fd00::/8"});
  EXPECT_TRUE(proxies.ok()) << proxies.status();
  return proxies.ok() ? proxies->client_of(peer, forwarded_for).value_or("") : "";
}

TEST(TrustedProxies, AreBelieved) {
  EXPECT_EQ(client_of(kProxy, {"198.51.100.1"}), "ipv4:198.51.100.1:4711");
  EXPECT_EQ(client_of("ipv4:192.168.7.1:1", {"198.51.100.1"}), "ipv4:198.51.100.1:1");
  EXPECT_EQ(client_of("ipv6:%5Bfd12::1%5D:1", {"2001:db8::1"}), "ipv6:%5B2001:db8::1%5D:1");
  EXPECT_EQ(client_of("ipv6:%5Bfd12::1%252%5D:1", {"::ffff:198.51.100.1"}), "ipv4:198.51.100.1:1");
  for (const char* port : {"198.51.100.1:80", " 198.51.100.1 ", "[::ffff:198.51.100.1]:80", "[::ffff:198.51.100.1]"}) {
    EXPECT_EQ(client_of(kProxy, {port}), "ipv4:198.51.100.1:4711") << port;
  }
}

TEST(TrustedProxies, OthersAreNot) {
  for (const char* peer : {"ipv4:11.0.0.1:4711", "ipv4:192.168.7.2:1", "ipv6:%5Bfe80::1%5D:1", "unknown:0", "inproc", ""}) {
    EXPECT_EQ(client_of(peer, {"198.51.100.1"}), "") << peer;
  }
  EXPECT_EQ(TrustedProxies().client_of(kProxy, {"198.51.100.1"}), std::nullopt);
  EXPECT_EQ(client_of(kProxy, {}), "");
}

// Whoever calls may write what he wants into the header: the proxies add what they see at its end.
TEST(TrustedProxies, TheLastAddressThatIsNoProxyIsTheClient) {
  const char* const client = "ipv4:198.51.100.1:4711";
  EXPECT_EQ(client_of(kProxy, {"203.0.113.9, 198.51.100.1"}), client);
  EXPECT_EQ(client_of(kProxy, {"203.0.113.9", "198.51.100.1"}), client);
  EXPECT_EQ(client_of(kProxy, {"203.0.113.9,198.51.100.1, 10.9.9.9", "192.168.7.1"}), client);
  EXPECT_EQ(client_of(kProxy, {"10.4.4.4, 10.5.5.5"}), "ipv4:10.4.4.4:4711") << "a client within the network";
}

TEST(TrustedProxies, WhatIsNoAddressEndsTheSearch) {
  for (const char* nonsense : {"", " ", "unknown", "nonsense", "198.51.100", "198.51.100.1.1", "[198.51.100.1", "::1:x", ",",
                               "198.51.100.1:port", "_hidden", "203.0.113.9,", "203.0.113.9, unknown"}) {
    EXPECT_EQ(client_of(kProxy, {nonsense}), "") << nonsense;
    const std::string hops = std::string("203.0.113.9, ") + nonsense + ", 10.4.4.4";
    EXPECT_EQ(client_of(kProxy, {hops}), "ipv4:10.4.4.4:4711") << nonsense;
  }
}

TEST(TrustedProxies, SayWhatIsWrongWithANetwork) {
  const std::vector<std::pair<std::string, std::string>> wrong = {
      {"proxy", "10.0.0.0/8"},  {"", "10.0.0.0/8"},         {"10.0.0.0/33", "0 to 32"},  {"fd00::/129", "0 to 128"},
      {"10.0.0.0/", "0 to 32"}, {"10.0.0.0/-1", "0 to 32"}, {"10.0.0.1/8", "more bits"}, {"fd00::1/8", "more bits"},
  };
  for (const auto& [network, why] : wrong) {
    const absl::Status status = TrustedProxies::parse({"127.0.0.1", network}).status();
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << network;
    EXPECT_THAT(std::string(status.message()), HasSubstr("\"" + network + "\"")) << network;
    EXPECT_THAT(std::string(status.message()), HasSubstr(why)) << network;
  }
  for (const char* all : {"0.0.0.0/0", "::/0"}) EXPECT_TRUE(TrustedProxies::parse({all}).ok()) << all;
}

}  // namespace
}  // namespace curvecast::server
