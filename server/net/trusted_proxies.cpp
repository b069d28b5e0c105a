#include "server/net/trusted_proxies.h"

#include <absl/strings/ascii.h>
#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/strip.h>
#include <arpa/inet.h>
#include <netinet/in.h>

#include <algorithm>
#include <cstring>

#include "server/net/peer_name.h"

namespace curvecast::server {
namespace {

using Bytes = std::array<std::uint8_t, 16>;

constexpr Bytes kMapped = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xff, 0xff};  // what IPv4 begins with in IPv6
constexpr int kMappedBits = 96;

absl::string_view to_absl(std::string_view text) { return {text.data(), text.size()}; }

/// "10.0.0.1" or "::1".
std::optional<Bytes> parse_address(absl::string_view text) {
  const std::string ended(text);
  Bytes bytes = kMapped;
  if (::inet_pton(AF_INET, ended.c_str(), &bytes[kMappedBits / 8]) == 1) return bytes;
  if (::inet_pton(AF_INET6, ended.c_str(), bytes.data()) == 1) return bytes;
  return std::nullopt;
}

/// "ipv4:10.0.0.1:4711" or "ipv6:%5B::1%5D:4711", of which zones ("%25eth0") say nothing about who it is.
std::optional<Bytes> parse_peer(absl::string_view peer) {
  if (absl::ConsumePrefix(&peer, "ipv4:")) return parse_address(peer.substr(0, peer.rfind(':')));
  if (!absl::ConsumePrefix(&peer, "ipv6:%5B")) return std::nullopt;
  return parse_address(peer.substr(0, peer.find('%')));
}

/// An address, maybe with a port, as some proxies write it.
std::optional<Bytes> parse_hop(absl::string_view text) {
  text = absl::StripAsciiWhitespace(text);
  if (const auto address = parse_address(text)) return address;
  const std::size_t colon = text.rfind(':');
  int port = 0;
  if (colon == absl::string_view::npos || !absl::SimpleAtoi(text.substr(colon + 1), &port)) {
    return absl::ConsumePrefix(&text, "[") && absl::ConsumeSuffix(&text, "]") ? parse_address(text) : std::nullopt;
  }
  text = text.substr(0, colon);
  const bool has_brackets = absl::ConsumePrefix(&text, "[") && absl::ConsumeSuffix(&text, "]");
  return has_brackets || text.find(':') == absl::string_view::npos ? parse_address(text) : std::nullopt;
}

std::string name_of(const Bytes& address, std::string_view port) {
  unsigned number = 0;
  if (!absl::SimpleAtoi(to_absl(port), &number)) number = 0;
  sockaddr_in6 six = {};
  six.sin6_family = AF_INET6;
  six.sin6_port = htons(static_cast<std::uint16_t>(number));
  std::memcpy(&six.sin6_addr, address.data(), address.size());
  return peer_name(reinterpret_cast<const sockaddr*>(&six));
}

/// The address with nothing but its first `bits`.
Bytes masked(Bytes address, int bits) {
  for (int i = 0; i < static_cast<int>(address.size()); ++i) {
    const int left = std::clamp(bits - 8 * i, 0, 8);
    address[i] = static_cast<std::uint8_t>(address[i] & (0xff00 >> left));
  }
  return address;
}

}  // namespace

absl::StatusOr<TrustedProxies> TrustedProxies::parse(const std::vector<std::string>& networks) {
  TrustedProxies proxies;
  for (const std::string& text : networks) {
    const auto fail = [&](absl::string_view why) {
      return absl::InvalidArgumentError(absl::StrCat("\"", text, "\" is no network of proxies: ", why));
    };
    const std::size_t slash = text.find('/');
    const std::optional<Bytes> address = parse_address(absl::string_view(text).substr(0, slash));
    if (!address) return fail("write ADDRESS or ADDRESS/BITS, such as 10.0.0.0/8 or fd00::/8");
    const bool is_four = text.find(':') == std::string::npos;
    const int most = is_four ? 32 : 128;
    int bits = most;
    if (slash != std::string::npos && (!absl::ascii_isdigit(static_cast<unsigned char>(text.back())) ||
                                       !absl::SimpleAtoi(text.substr(slash + 1), &bits) || bits < 0 || bits > most)) {
      return fail(absl::StrCat("after the slash belongs a number of bits, 0 to ", most));
    }
    if (is_four) bits += kMappedBits;
    if (masked(*address, bits) != *address) return fail("the address has more bits than the network");
    proxies.networks_.push_back({*address, bits});
  }
  return proxies;
}

bool TrustedProxies::contain(const Bytes& address) const {
  return std::any_of(networks_.begin(), networks_.end(),
                     [&](const Network& network) { return masked(address, network.bits) == network.address; });
}

bool TrustedProxies::trusts(std::string_view peer) const {
  if (networks_.empty()) return false;
  const std::optional<Bytes> address = parse_peer(to_absl(peer));
  return address && contain(*address);
}

std::optional<std::string> TrustedProxies::client_of(std::string_view peer,
                                                     const std::vector<std::string_view>& forwarded_for) const {
  if (forwarded_for.empty() || !trusts(peer)) return std::nullopt;
  std::string hops;
  for (const std::string_view header : forwarded_for) absl::StrAppend(&hops, hops.empty() ? "" : ",", to_absl(header));
  std::optional<Bytes> client;
  absl::string_view rest = hops;
  do {
    const std::size_t comma = rest.rfind(',');
    const std::optional<Bytes> hop = parse_hop(rest.substr(comma == absl::string_view::npos ? 0 : comma + 1));
    if (!hop) break;
    client = hop;
    rest = rest.substr(0, comma == absl::string_view::npos ? 0 : comma);
  } while (!rest.empty() && contain(*client));
  if (!client) return std::nullopt;
  return name_of(*client, peer.substr(peer.rfind(':') + 1));
}

}  // namespace curvecast::server
