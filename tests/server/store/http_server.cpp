#include "tests/server/store/http_server.h"

#include <absl/strings/ascii.h>
#include <absl/strings/numbers.h>
#include <absl/strings/str_cat.h>
#include <absl/strings/str_split.h>
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>

namespace curvecast::server {
namespace {

/// Bytes of one connection.
class Stream {
 public:
  explicit Stream(int socket) : socket_(socket) {}

  bool send(std::string_view bytes) const {
    while (!bytes.empty()) {
      const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (sent <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
  }

  std::optional<HttpServer::Request> receive() {
    std::size_t end = 0;
    while ((end = received_.find("\r\n\r\n")) == std::string::npos) {
      if (!fill()) return std::nullopt;
    }
    HttpServer::Request request;
    const std::vector<std::string> lines = absl::StrSplit(received_.substr(0, end), "\r\n");
    received_.erase(0, end + 4);
    const std::vector<std::string> words = absl::StrSplit(lines.front(), ' ');
    request.method = words.at(0);
    const std::pair<std::string, std::string> target = absl::StrSplit(words.at(1), absl::MaxSplits('?', 1));
    request.path = target.first;
    request.query = target.second;
    for (std::size_t i = 1; i < lines.size(); ++i) {
      const std::pair<std::string, std::string> header = absl::StrSplit(lines[i], absl::MaxSplits(':', 1));
      request.headers[absl::AsciiStrToLower(header.first)] = std::string(absl::StripAsciiWhitespace(header.second));
    }
    if (!request.header("expect").empty() && !send("HTTP/1.1 100 Continue\r\n\r\n")) return std::nullopt;
    std::size_t length = 0;
    if (!absl::SimpleAtoi(request.header("content-length"), &length)) length = 0;
    while (received_.size() < length) {
      if (!fill()) return std::nullopt;
    }
    request.body = received_.substr(0, length);
    received_.erase(0, length);
    return request;
  }

  /// Until the other side goes.
  void wait() {
    while (fill()) received_.clear();
  }

 private:
  bool fill() {
    std::array<char, 65536> bytes;
    const ssize_t count = ::recv(socket_, bytes.data(), bytes.size(), 0);
    if (count > 0) received_.append(bytes.data(), static_cast<std::size_t>(count));
    return count > 0;
  }

  const int socket_;
  std::string received_;
};

}  // namespace

std::string HttpServer::Request::header(const std::string& name) const {
  const auto it = headers.find(name);
  return it == headers.end() ? std::string() : it->second;
}

HttpServer::HttpServer(Handler handler) : handler_(std::move(handler)), listener_(::socket(AF_INET, SOCK_STREAM, 0)) {
  sockaddr_in address = {};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof(address);
  EXPECT_EQ(::bind(listener_, reinterpret_cast<sockaddr*>(&address), length), 0);
  EXPECT_EQ(::listen(listener_, SOMAXCONN), 0);
  EXPECT_EQ(::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &length), 0);
  port_ = ntohs(address.sin_port);
  accepting_ = std::thread([this] { accept_all(); });
}

HttpServer::~HttpServer() {
  {
    const std::lock_guard lock(mutex_);
    is_ending_ = true;
    ::shutdown(listener_, SHUT_RDWR);
    for (const int connection : open_) ::shutdown(connection, SHUT_RDWR);
  }
  accepting_.join();
  for (std::thread& thread : threads_) thread.join();
  ::close(listener_);
}

std::string HttpServer::url() const { return absl::StrCat("http://127.0.0.1:", port_); }

void HttpServer::accept_all() {
  for (;;) {
    const int connection = ::accept(listener_, nullptr, nullptr);
    const std::lock_guard lock(mutex_);
    if (is_ending_) {
      ::close(connection);
      return;
    }
    if (connection < 0) continue;
    ++connections_;
    open_.push_back(connection);
    threads_.emplace_back([this, connection] { serve(connection); });
  }
}

void HttpServer::serve(int connection) {
  Stream stream(connection);
  for (bool is_open = true; is_open;) {
    const std::optional<Request> request = stream.receive();
    if (!request) break;
    const Reply reply = handler_(*request);
    is_open = reply.end == End::kKeep;
    if (reply.end == End::kReset) {
      const linger at_once = {.l_onoff = 1, .l_linger = 0};
      ::setsockopt(connection, SOL_SOCKET, SO_LINGER, &at_once, sizeof(at_once));
      break;
    }
    if (reply.end == End::kHang) {
      stream.wait();
      break;
    }
    std::string head = absl::StrCat("HTTP/1.1 ", reply.status, " As said\r\nContent-Length: ", reply.body.size(), "\r\n");
    for (const auto& [name, value] : reply.headers) absl::StrAppend(&head, name, ": ", value, "\r\n");
    const std::string body = request->method == "HEAD" ? "" : reply.body;
    if (!stream.send(absl::StrCat(head, "\r\n", is_open ? body : body.substr(0, body.size() / 2)))) break;
    if (reply.end == End::kStall) stream.wait();
  }
  const std::lock_guard lock(mutex_);
  std::erase(open_, connection);
  ::close(connection);
}

}  // namespace curvecast::server
