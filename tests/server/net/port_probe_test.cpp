#include "server/net/port_probe.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>

#include "server/net/port_listener.h"
#include "tests/server/eventually.h"

namespace curvecast::server {
namespace {

constexpr PortProbe::Options kQuick = {.interval = std::chrono::milliseconds(5), .patience = std::chrono::milliseconds(100)};

TEST(PortProbe, SeesThatSomebodyAnswersAndThatNobodyDoesAnyMore) {
  const auto listener = PortListener::bind("0.0.0.0:0");
  ASSERT_TRUE(listener.ok()) << listener.status();
  std::atomic<int> asked = 0;
  (*listener)->accept([&](int, int descriptor, const std::string&, const std::string&) {
    ++asked;
    ::close(descriptor);
  });
  const PortProbe probe((*listener)->descriptor(), kQuick);
  EXPECT_TRUE(probe.answers());
  EXPECT_TRUE(eventually([&] { return asked >= 3; }));
  EXPECT_TRUE(eventually([&] { return probe.answers(); }));
  (*listener)->close();
  EXPECT_TRUE(eventually([&] { return !probe.answers(); }));
}

TEST(PortProbe, ToBeLetInIsNoAnswer) {
  const auto listener = PortListener::bind("127.0.0.1:0");
  ASSERT_TRUE(listener.ok()) << listener.status();
  // The system accepts connections as long as some may wait.
  const PortProbe probe((*listener)->descriptor(), kQuick);
  EXPECT_TRUE(eventually([&] { return !probe.answers(); }));
}

TEST(PortProbe, EndsAtOnceWhileItWaits) {
  const auto listener = PortListener::bind("127.0.0.1:0");
  ASSERT_TRUE(listener.ok()) << listener.status();
  const PortProbe probe((*listener)->descriptor(), {.patience = std::chrono::hours(1)});
  EXPECT_TRUE(probe.answers());
}

}  // namespace
}  // namespace curvecast::server
