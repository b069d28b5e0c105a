#include "server/net/descriptors.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

namespace curvecast::server {
namespace {

TEST(Descriptors, TheSoftLimitIsRaisedToTheHardOne) {
  rlimit before = {};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit low = {.rlim_cur = 100, .rlim_max = before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &low), 0);
  const std::size_t limit = raise_descriptor_limit();
  rlimit after = {};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &after), 0);
  EXPECT_EQ(limit, after.rlim_cur);
  EXPECT_GT(limit, 100u);
  EXPECT_EQ(raise_descriptor_limit(), limit);
  ::setrlimit(RLIMIT_NOFILE, &before);
}

TEST(Descriptors, SomeAreLeft) {
  for (const std::size_t limit : {64u, 256u, 1024u, 1u << 20}) {
    const DescriptorShares shares = share_descriptors(limit);
    EXPECT_GE(limit - shares.connections - shares.sockets - shares.pages, limit / 4) << limit;
    EXPECT_GT(shares.reserve_from, limit / 2) << limit;
    EXPECT_LT(shares.reserve_from, limit) << limit;
    EXPECT_GT(shares.pages, 0u) << limit;
  }
}

}  // namespace
}  // namespace curvecast::server
