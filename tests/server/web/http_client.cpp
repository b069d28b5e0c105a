#include "tests/server/web/http_client.h"

#include <absl/strings/ascii.h>
#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>

namespace curvecast::server {

HttpClient::HttpClient(int port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_port = htons(static_cast<std::uint16_t>(port));
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const timeval patience = {.tv_sec = 120, .tv_usec = 0};  // nothing here takes that long unless it hangs
  ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
  if (::connect(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) != 0) {
    ::close(socket_);
    socket_ = -1;
  }
}

HttpClient::~HttpClient() { ::close(socket_); }

bool HttpClient::send(const std::string& bytes) const {
  for (std::size_t sent = 0; sent < bytes.size();) {
    const ssize_t count = ::send(socket_, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
    if (count <= 0) return false;
    sent += static_cast<std::size_t>(count);
  }
  return true;
}

bool HttpClient::fill() {
  std::array<char, 4096> bytes;
  const ssize_t count = ::recv(socket_, bytes.data(), bytes.size(), 0);
  if (count > 0) received_.append(bytes.data(), static_cast<std::size_t>(count));
  return count > 0;
}

HttpClient::Response HttpClient::receive(bool has_body) {
  Response out;
  std::size_t end = std::string::npos;
  while ((end = received_.find("\r\n\r\n")) == std::string::npos) {
    if (!fill()) return out;
  }
  out.header = received_.substr(0, end + 2);
  received_.erase(0, end + 4);
  const std::string key = "\r\ncontent-length: ";
  const std::size_t at = absl::AsciiStrToLower(out.header).find(key);
  std::size_t length = 0;
  if (has_body && at != std::string::npos) {
    const std::size_t begin = at + key.size();
    if (!absl::SimpleAtoi(out.header.substr(begin, out.header.find("\r\n", begin) - begin), &length)) return out;
  }
  while (received_.size() < length) {
    if (!fill()) return out;
  }
  out.body = received_.substr(0, length);
  received_.erase(0, length);
  if (!absl::SimpleAtoi(out.header.substr(out.header.find(' ') + 1, 3), &out.status)) out.status = 0;
  return out;
}

HttpClient::Response HttpClient::get(const std::string& path, const std::string& method) {
  send(absl::StrCat(method, " ", path, " HTTP/1.1\r\nHost: localhost\r\n\r\n"));
  return receive(method != "HEAD");
}

bool HttpClient::is_closed() { return received_.empty() && !fill(); }

}  // namespace curvecast::server
