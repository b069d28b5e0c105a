#include "server/base/address.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace curvecast::server {
namespace {

TEST(Address, SplitsHostAndPort) {
  const auto plain = parse_address("localhost:0");
  ASSERT_TRUE(plain.ok()) << plain.status();
  EXPECT_EQ(plain->host, "localhost");
  EXPECT_EQ(plain->port, 0);
  const auto six = parse_address("[::1]:65535");
  ASSERT_TRUE(six.ok()) << six.status();
  EXPECT_EQ(six->host, "::1");
  EXPECT_EQ(six->port, 65'535);
}

TEST(Address, RefusesWhatIsNone) {
  for (const char* text : {"", "nonsense", ":1", "a:", "a:http", "a:65536", "a:-1", "a:+1", "a: 1", "a:99999999999"}) {
    const auto address = parse_address(text);
    EXPECT_EQ(address.status().code(), absl::StatusCode::kInvalidArgument) << text;
    EXPECT_THAT(address.status().message(), ::testing::HasSubstr("HOST:PORT"));
  }
}

}  // namespace
}  // namespace curvecast::server
