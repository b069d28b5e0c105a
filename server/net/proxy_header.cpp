#include "server/net/proxy_header.h"

#include <absl/strings/ascii.h>
#include <absl/strings/numbers.h>
#include <absl/strings/str_split.h>
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>
#include <vector>

#include "server/net/peer_name.h"

namespace curvecast::server {
namespace {

using State = ProxyHeader::State;

constexpr std::string_view kTextBegin = "PROXY ";
constexpr std::size_t kMostText = 107;
constexpr std::string_view kBinaryBegin("\r\n\r\n\0\r\nQUIT\n", 12);
constexpr std::size_t kBinaryFixed = 16;  // bytes before the addresses
constexpr std::uint8_t kVersion2 = 0x20, kCommandLocal = 0, kCommandProxy = 1;
constexpr std::uint8_t kTcp4 = 0x11, kTcp6 = 0x21;  // others are of no use here

/// Whether one of them begins with the other.
bool may_begin(std::string_view text, std::string_view with) {
  const std::size_t size = std::min(text.size(), with.size());
  return text.substr(0, size) == with.substr(0, size);
}

/// `source`: an address of the family and a port, both in the byte order of the network.
std::string name_of(int family, const void* address, std::uint16_t port) {
  sockaddr_storage peer = {};
  peer.ss_family = static_cast<sa_family_t>(family);
  if (family == AF_INET) {
    auto& four = reinterpret_cast<sockaddr_in&>(peer);
    std::memcpy(&four.sin_addr, address, sizeof four.sin_addr);
    four.sin_port = port;
  } else {
    auto& six = reinterpret_cast<sockaddr_in6&>(peer);
    std::memcpy(&six.sin6_addr, address, sizeof six.sin6_addr);
    six.sin6_port = port;
  }
  return peer_name(reinterpret_cast<const sockaddr*>(&peer));
}

/// What the words of a line with addresses are made of. inet_pton() and SimpleAtoi() would take a NUL, signs and tabs.
bool is_plain(absl::string_view line) {
  return std::all_of(line.begin(), line.end(),
                     [](unsigned char c) { return absl::ascii_isalnum(c) || c == ' ' || c == '.' || c == ':'; });
}

/// Without its end of the line: "PROXY TCP4 192.0.2.1 192.0.2.9 56324 443".
ProxyHeader read_line(absl::string_view line, std::size_t size) {
  const std::vector<std::string> words = absl::StrSplit(line, ' ');
  if (words.size() >= 2 && words[1] == "UNKNOWN") return {State::kWhole, size};
  if (words.size() != 6 || !is_plain(line) || (words[1] != "TCP4" && words[1] != "TCP6")) return {State::kBroken};
  const int family = words[1] == "TCP4" ? AF_INET : AF_INET6;
  std::array<std::uint8_t, 16> address = {};
  std::uint32_t port = 0;
  if (::inet_pton(family, words[2].c_str(), address.data()) != 1 || !absl::SimpleAtoi(words[4], &port) || port > 65535) {
    return {State::kBroken};
  }
  return {State::kWhole, size, name_of(family, address.data(), htons(static_cast<std::uint16_t>(port)))};
}

ProxyHeader read_text(std::string_view text) {
  const std::size_t end = text.substr(0, kMostText).find("\r\n");
  if (end != std::string_view::npos) return read_line({text.data(), end}, end + 2);
  return {text.size() < kMostText ? State::kPart : State::kBroken, text.size()};
}

ProxyHeader read_binary(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < kBinaryFixed) return {State::kPart, bytes.size()};
  const std::uint8_t version = bytes[12] & 0xf0, command = bytes[12] & 0x0f, family = bytes[13];
  const std::size_t more = std::size_t{bytes[14]} << 8 | bytes[15], size = kBinaryFixed + more;
  if (version != kVersion2 || command > kCommandProxy || size > kMostProxyHeader) return {State::kBroken};
  if (bytes.size() < size) return {State::kPart, bytes.size()};
  const bool is_four = family == kTcp4;
  if (command == kCommandLocal || (!is_four && family != kTcp6)) return {State::kWhole, size};
  const std::size_t length = is_four ? 4 : 16;  // of an address: the client's, the proxy's, and their ports
  if (more < 2 * length + 4) return {State::kBroken};
  std::uint16_t port = 0;
  std::memcpy(&port, &bytes[kBinaryFixed + 2 * length], sizeof port);
  return {State::kWhole, size, name_of(is_four ? AF_INET : AF_INET6, &bytes[kBinaryFixed], port)};
}

}  // namespace

ProxyHeader read_proxy_header(std::span<const std::uint8_t> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  const bool is_text = may_begin(text, kTextBegin), is_binary = may_begin(text, kBinaryBegin);
  if (bytes.empty()) return {State::kPart};
  if (is_binary) return read_binary(bytes);
  return is_text ? read_text(text) : ProxyHeader{};
}

ProxyHeader take_proxy_header(int descriptor) {
  std::array<std::uint8_t, kMostProxyHeader> bytes;  // NOLINT(cppcoreguidelines-pro-type-member-init): what comes
  const ssize_t count = ::recv(descriptor, bytes.data(), bytes.size(), MSG_PEEK | MSG_DONTWAIT);
  if (count < 0 && (errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR)) return {State::kPart};
  if (count <= 0) return {};
  ProxyHeader header = read_proxy_header(std::span(bytes).first(static_cast<std::size_t>(count)));
  if (header.state == State::kWhole &&
      ::recv(descriptor, bytes.data(), header.size, MSG_DONTWAIT) != static_cast<ssize_t>(header.size)) {
    return {State::kBroken};
  }
  return header;
}

}  // namespace curvecast::server
