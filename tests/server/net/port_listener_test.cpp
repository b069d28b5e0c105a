#include "server/net/port_listener.h"

#include <absl/strings/str_cat.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>

#include <atomic>
#include <mutex>
#include <stdexcept>
#include <vector>

#include "tests/server/eventually.h"
#include "tests/server/web/http_client.h"

namespace curvecast::server {
namespace {

using ::testing::HasSubstr;

TEST(PortListener, GivesItsConnectionsAway) {
  auto listener = PortListener::bind("127.0.0.1:0");
  ASSERT_TRUE(listener.ok()) << listener.status();
  HttpClient early((*listener)->port());  // waits
  std::atomic<int> taken = 0;
  (*listener)->accept([&](int, int descriptor, const std::string& peer, const std::string& client) {
    EXPECT_THAT(peer, ::testing::StartsWith("ipv4:127.0.0.1:"));
    EXPECT_EQ(client, "");
    const bool is_second = ++taken == 2;
    ::close(descriptor);
    if (is_second) throw std::runtime_error("on purpose");
  });
  EXPECT_TRUE(early.is_closed());
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(HttpClient((*listener)->port()).is_closed());
  EXPECT_EQ(taken, 6);
  (*listener)->close();
  (*listener)->close();  // harmless
}

TEST(PortListener, AsksProxiesWhoseTheirConnectionsAre) {
  auto listener = PortListener::bind("127.0.0.1:0");
  ASSERT_TRUE(listener.ok()) << listener.status();
  std::mutex mutex;
  std::vector<std::string> clients;
  (*listener)->accept(
      [&](int, int descriptor, const std::string& peer, const std::string& client) {
        EXPECT_THAT(peer, ::testing::StartsWith("ipv4:127.0.0.1:"));
        const std::lock_guard lock(mutex);
        clients.push_back(client);
        ::close(descriptor);
      },
      [](const std::string& peer) { return peer.starts_with("ipv4:127."); });
  HttpClient slow((*listener)->port()), quick((*listener)->port()), plain((*listener)->port());
  ASSERT_TRUE(slow.send("PROXY TCP4 198.51.100.1"));
  ASSERT_TRUE(quick.send("PROXY TCP6 2001:db8::7 ::1 4711 443\r\n"));
  EXPECT_TRUE(quick.is_closed()) << "it does not wait for the slow one";
  ASSERT_TRUE(slow.send(" 10.0.0.2 4711 443\r\n"));
  EXPECT_TRUE(slow.is_closed());
  ASSERT_TRUE(plain.send("GET /"));
  EXPECT_TRUE(plain.is_closed());
  (*listener)->close();
  EXPECT_EQ(clients, (std::vector<std::string>{"ipv6:%5B2001:db8::7%5D:4711", "ipv4:198.51.100.1:4711", ""}));
}

TEST(PortListener, SaysWhyItCannotListen) {
  const auto first = PortListener::bind("127.0.0.1:0");
  ASSERT_TRUE(first.ok());
  const std::string taken = absl::StrCat("127.0.0.1:", (*first)->port());
  EXPECT_EQ(PortListener::bind(taken).status().code(), absl::StatusCode::kUnavailable);
  EXPECT_THAT(PortListener::bind(taken).status().message(), HasSubstr(taken));
  EXPECT_EQ(PortListener::bind("192.0.2.1:0").status().code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(PortListener::bind("no.such.host.invalid:0").status().code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(PortListener::bind("nonsense").status().code(), absl::StatusCode::kInvalidArgument);
}

TEST(PortListener, OutlivesTheLackOfDescriptors) {
  auto listener = PortListener::bind("localhost:0");  // more than one address, where there is IPv6
  ASSERT_TRUE(listener.ok()) << listener.status();
  (*listener)->accept([](int, int descriptor, const std::string&, const std::string&) { ::close(descriptor); });
  const HttpClient first((*listener)->port()), second((*listener)->port());
  std::vector<int> taken;
  rlimit before = {};
  ASSERT_EQ(::getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit low = {.rlim_cur = 100, .rlim_max = before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_NOFILE, &low), 0);
  // One is left for the client, none for the listener: it sees the lack before anybody gives something back.
  const int spare = ::open("/dev/null", O_RDONLY);
  for (int descriptor; (descriptor = ::open("/dev/null", O_RDONLY)) >= 0;) taken.push_back(descriptor);
  ::close(spare);
  HttpClient client((*listener)->port());
  for (const int descriptor : taken) ::close(descriptor);
  EXPECT_TRUE(client.is_closed());
  EXPECT_TRUE(HttpClient((*listener)->port()).is_closed());
  ::setrlimit(RLIMIT_NOFILE, &before);
}

}  // namespace
}  // namespace curvecast::server
