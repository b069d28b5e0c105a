// What a connection begins with that comes by a proxy which does not look into it: the header of the PROXY protocol, in pieces.
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <span>

#include "server/net/proxy_header.h"
#include "server/net/trusted_proxies.h"
#include "tests/fuzz/fuzz_expect.h"
#include "tests/fuzz/fuzz_input.h"

namespace curvecast::fuzzing {
namespace {

using server::ProxyHeader;
using State = ProxyHeader::State;

/// Of the header so far; 0 where there is none, or none that counts.
std::size_t size_of(const ProxyHeader& header) {
  return header.state == State::kPart || header.state == State::kWhole ? header.size : 0;
}

void expect_address(const std::string& client) {
  static const auto all = server::TrustedProxies::parse({"0.0.0.0/0", "::/0"});
  expect(all.ok() && (client.empty() || all->trusts(client)), "a client that is no address: " + client);
}

/// Whoever has read a part has to wait for more of it, and for nothing else.
void expect_same_in_pieces(std::span<const std::uint8_t> bytes, const ProxyHeader& read) {
  const std::size_t end = read.state == State::kWhole ? read.size : bytes.size();
  bool is_known = false;
  for (std::size_t size = 0; size < std::min(end, server::kMostProxyHeader); size += 1 + size / 64) {
    const ProxyHeader part = server::read_proxy_header(bytes.first(size));
    is_known = is_known || part.state != State::kPart;
    expect(part.state == (is_known ? read.state : State::kPart) && (is_known || part.size == size), "another header in pieces");
  }
  expect(!is_known || read.state == State::kNone || read.state == State::kBroken, "whole before its end");
}

/// It is taken from the connection, and nothing else.
void expect_same_from_socket(std::span<const std::uint8_t> bytes, const ProxyHeader& read) {
  static const std::array<int, 2> ends = [] {
    std::array<int, 2> pair{};
    expect(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, pair.data()) == 0, "no sockets");
    return pair;
  }();
  expect(::send(ends[0], bytes.data(), bytes.size(), 0) == static_cast<ssize_t>(bytes.size()), "a socket that takes no bytes");
  const ProxyHeader taken = server::take_proxy_header(ends[1]);
  expect(taken.state == read.state && size_of(taken) == size_of(read) && taken.client == read.client,
         "another header from a socket");
  const std::size_t rest = bytes.size() - (taken.state == State::kWhole ? taken.size : 0);
  std::array<std::uint8_t, 2 * server::kMostProxyHeader> left;
  const ssize_t count = ::recv(ends[1], left.data(), left.size(), MSG_DONTWAIT);
  expect(count == (rest == 0 ? -1 : static_cast<ssize_t>(rest)) &&
             std::equal(left.begin(), left.begin() + static_cast<std::ptrdiff_t>(rest), bytes.last(rest).begin()),
         "what follows is not left there");
}

}  // namespace

void take_input(const std::uint8_t* data, std::size_t size) {
  const std::span bytes(data, size);
  const ProxyHeader read = server::read_proxy_header(bytes);
  expect(size_of(read) <= std::min(size, server::kMostProxyHeader), "longer than what there is, or than what is taken");
  expect(read.state == State::kWhole || read.client.empty(), "a client of no header");
  expect(read.state != State::kPart || size < server::kMostProxyHeader, "waits for what will not be read");
  expect_address(read.client);
  expect_same_in_pieces(bytes, read);
  expect_same_from_socket(bytes, read);
}

}  // namespace curvecast::fuzzing
