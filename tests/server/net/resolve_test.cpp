#include "server/net/resolve.h"

#include <gtest/gtest.h>
#include <netinet/in.h>

namespace curvecast::server {
namespace {

TEST(Resolve, GivesAddressesWithTheirPort) {
  const absl::StatusOr<AddressList> found = resolve({.host = "127.0.0.1", .port = 4711});
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_EQ((*found)->ai_next, nullptr);
  ASSERT_EQ((*found)->ai_family, AF_INET);
  EXPECT_EQ(ntohs(reinterpret_cast<const sockaddr_in*>((*found)->ai_addr)->sin_port), 4711);
  EXPECT_TRUE(resolve({.host = "localhost"}).ok());
}

TEST(Resolve, SaysWhyANameStandsForNothing) {
  const absl::Status status = resolve({.host = "no.such.host.invalid"}).status();
  EXPECT_TRUE(absl::IsUnavailable(status));
  EXPECT_FALSE(status.message().empty());
}

}  // namespace
}  // namespace curvecast::server
