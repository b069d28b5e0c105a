#include "server/base/admission.h"

#include <gtest/gtest.h>

#include <optional>
#include <thread>
#include <vector>

namespace curvecast::server {
namespace {

TEST(Admission, CountsInAllAndByClient) {
  const auto admission = std::make_shared<Admission>("streams", 3, 2);
  std::optional a = *admission->admit("a");
  const auto b = admission->admit("a");
  EXPECT_TRUE(b.ok());
  const auto third = admission->admit("a");
  EXPECT_TRUE(absl::IsResourceExhausted(third.status())) << third.status();
  const auto other = admission->admit("b");
  EXPECT_TRUE(other.ok());
  EXPECT_TRUE(absl::IsResourceExhausted(admission->admit("c").status()));
  EXPECT_EQ(admission->count(), 3u);
  a.reset();
  EXPECT_TRUE(admission->admit("a").ok());
  EXPECT_EQ(admission->count(), 2u);
}

TEST(Admission, IsBackAtNothingWhateverThreadsDo) {
  auto admission = std::make_shared<Admission>("streams", 5, 3);
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t) {
      threads.emplace_back([&, t] {
        for (int i = 0; i < 2000; ++i) {
          const auto first = admission->admit(t % 2 == 0 ? "even" : "odd"), second = admission->admit("both");
          EXPECT_LE(admission->count(), 5u);
        }
      });
    }
  }
  EXPECT_EQ(admission->count(), 0u);
}

TEST(Admission, ConnectionsOfAMachineAreOneClient) {
  EXPECT_EQ(client_of_peer("ipv4:10.0.0.1:4711"), client_of_peer("ipv4:10.0.0.1:815"));
  EXPECT_NE(client_of_peer("ipv6:%5B::1%5D:1"), client_of_peer("ipv6:%5B::2%5D:1"));
  EXPECT_EQ(client_of_peer(""), "");
}

}  // namespace
}  // namespace curvecast::server
