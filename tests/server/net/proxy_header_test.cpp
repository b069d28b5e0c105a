#include "server/net/proxy_header.h"

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <string>
#include <string_view>
#include <vector>

namespace curvecast::server {
namespace {

using State = ProxyHeader::State;

ProxyHeader read(std::string_view bytes) {
  return read_proxy_header({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

/// Of version 2, with addresses and what a proxy adds.
std::string binary(unsigned char command, unsigned char family, std::string_view rest) {
  std::string header("\r\n\r\n\0\r\nQUIT\n", 12);
  header += {static_cast<char>(command), static_cast<char>(family), static_cast<char>(rest.size() >> 8),
             static_cast<char>(rest.size() & 0xff)};
  return header.append(rest);
}

const std::string kFour("\xc6\x33\x64\x01\x0a\x00\x00\x02\x12\x67\x01\xbb", 12);  // 198.51.100.1:4711 to 10.0.0.2:443

TEST(ProxyHeader, OfBothVersionsNamesTheClient) {
  const std::string six = std::string("\x20\x01\x0d\xb8", 4) + std::string(11, '\0') + "\x07" + std::string(16, '\0') +
                          std::string("\x12\x67\x01\xbb", 4);
  const std::vector<std::pair<std::string, std::string>> headers = {
      {"PROXY TCP4 198.51.100.1 10.0.0.2 4711 443\r\n", "ipv4:198.51.100.1:4711"},
      {"PROXY TCP6 2001:db8::7 ::1 4711 443\r\n", "ipv6:%5B2001:db8::7%5D:4711"},
      {"PROXY UNKNOWN\r\n", ""},
      {"PROXY UNKNOWN ffff::1 ffff::2 1 2\r\n", ""},
      {binary(0x21, 0x11, kFour), "ipv4:198.51.100.1:4711"},
      {binary(0x21, 0x11, kFour + "\x04" + std::string("\0\x03more", 6)), "ipv4:198.51.100.1:4711"},
      {binary(0x21, 0x21, six), "ipv6:%5B2001:db8::7%5D:4711"},
      {binary(0x20, 0x00, ""), ""},                      // the proxy's own, to see whether we are there
      {binary(0x20, 0x11, kFour), ""},                   // as well
      {binary(0x21, 0x31, std::string(216, 'u')), ""}};  // of a local socket
  for (const auto& [header, client] : headers) {
    SCOPED_TRACE(header);
    for (const std::string& after : {std::string(), std::string("GET / HTTP/1.1\r\n"), std::string(10'000, 'x')}) {
      const ProxyHeader whole = read(header + after);
      EXPECT_EQ(whole.state, State::kWhole);
      EXPECT_EQ(whole.size, header.size());
      EXPECT_EQ(whole.client, client);
    }
    for (std::size_t size = 0; size < header.size(); ++size) {
      EXPECT_EQ(read(header.substr(0, size)).state, State::kPart) << size;
      EXPECT_EQ(read(header.substr(0, size)).size, size);
    }
  }
}

TEST(ProxyHeader, IsNotWhatOthersBeginWith) {
  for (const char* bytes : {"PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n", "GET / HTTP/1.1\r\n", "POST / HTTP/1.1\r\n", "PROXY\r\n",
                            "\x16\x03\x01", "\r\n\r\nGET", "proxy TCP4"}) {
    EXPECT_EQ(read(bytes).state, State::kNone) << bytes;
  }
}

TEST(ProxyHeader, ThatIsBrokenIsToldApart) {
  const std::vector<std::string> broken = {"PROXY \r\n",
                                           "PROXY TCP4\r\n",
                                           "PROXY TCP4 198.51.100.1 10.0.0.2 4711\r\n",
                                           "PROXY TCP4 198.51.100.1 10.0.0.2 4711 443 1\r\n",
                                           "PROXY TCP4 198.51.100.256 10.0.0.2 4711 443\r\n",
                                           "PROXY TCP4 2001:db8::7 ::1 4711 443\r\n",
                                           "PROXY TCP4 198.51.100.1 10.0.0.2 65536 443\r\n",
                                           "PROXY TCP4 198.51.100.1 10.0.0.2 -1 443\r\n",
                                           "PROXY TCP4 198.51.100.1 10.0.0.2 +4711 443\r\n",
                                           "PROXY TCP4 198.51.100.1 10.0.0.2 4711\t 443\r\n",
                                           std::string("PROXY TCP4 198.51.100.1\0.7 10.0.0.2 4711 443\r\n", 46),
                                           "PROXY UDP4 198.51.100.1 10.0.0.2 4711 443\r\n",
                                           "PROXY UNKNOWN" + std::string(200, 'x') + "\r\n",
                                           binary(0x11, 0x11, kFour),                // version 1
                                           binary(0x22, 0x11, kFour),                // no such command
                                           binary(0x21, 0x11, kFour.substr(0, 11)),  // too few bytes
                                           binary(0x21, 0x21, kFour),                // as well
                                           binary(0x21, 0x11, std::string(kMostProxyHeader, 'x'))};
  for (const std::string& header : broken) EXPECT_EQ(read(header).state, State::kBroken) << header.substr(0, 60);
}

TEST(ProxyHeader, IsTakenFromTheSocketAndNothingElse) {
  std::array<int, 2> ends = {};
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0);
  const std::string header = "PROXY TCP4 198.51.100.1 10.0.0.2 4711 443\r\n";
  const auto send = [&](std::string_view bytes) { ASSERT_EQ(::send(ends[1], bytes.data(), bytes.size(), 0), bytes.size()); };
  EXPECT_EQ(take_proxy_header(ends[0]).state, State::kPart) << "nothing yet";
  EXPECT_EQ(take_proxy_header(ends[0]).size, 0u);
  send(header.substr(0, 20));
  EXPECT_EQ(take_proxy_header(ends[0]).size, 20u);
  send(header.substr(20) + "hello");
  EXPECT_EQ(take_proxy_header(ends[0]).client, "ipv4:198.51.100.1:4711");
  EXPECT_EQ(take_proxy_header(ends[0]).state, State::kNone);
  std::array<char, 100> rest = {};
  EXPECT_EQ(::recv(ends[0], rest.data(), rest.size(), MSG_DONTWAIT), 5);
  EXPECT_STREQ(rest.data(), "hello");
  ::close(ends[1]);
  EXPECT_EQ(take_proxy_header(ends[0]).state, State::kNone) << "it has ended";
  ::close(ends[0]);
}

}  // namespace
}  // namespace curvecast::server
