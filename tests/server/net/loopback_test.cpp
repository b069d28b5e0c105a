#include "server/net/loopback.h"

#include <gtest/gtest.h>

namespace curvecast::server {
namespace {

TEST(Loopback, IsNotForOtherMachines) {
  for (const char* address : {"127.0.0.1:0", "127.3.2.1:80", "localhost:1", "[::1]:1", "nonsense", "no.such.host.invalid:1"}) {
    EXPECT_TRUE(is_loopback(address)) << address;
  }
  for (const char* address : {"0.0.0.0:0", "[::]:0", "192.0.2.1:80", "128.0.0.1:1", "[2001:db8::1]:1"}) {
    EXPECT_FALSE(is_loopback(address)) << address;
  }
}

}  // namespace
}  // namespace curvecast::server
