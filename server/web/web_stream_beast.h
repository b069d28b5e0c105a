// The bytes of a connection of the HTTP port, encrypted or not, as one type: HTTP and WebSocket are compiled once. Included by
// what speaks these only, because Boost.Beast takes long to compile.
#pragma once

#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/ssl/ssl_stream.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <boost/beast/websocket/teardown.hpp>
#include <memory>
#include <utility>

namespace curvecast::server {

/// Beast's AsyncStream. Movable while nothing is under way.
class WebStream {
 public:
  using Tcp = boost::beast::tcp_stream;
  using Tls = boost::beast::ssl_stream<Tcp>;
  using executor_type = Tcp::executor_type;  // NOLINT(readability-identifier-naming): as Beast asks for it
  using next_layer_type = Tcp;               // NOLINT(readability-identifier-naming)

  /// `tls` may be null: not encrypted.
  WebStream(boost::asio::ip::tcp::socket socket, boost::asio::ssl::context* tls) {
    if (tls == nullptr) {
      tcp_ = std::make_unique<Tcp>(std::move(socket));
    } else {
      tls_ = std::make_unique<Tls>(Tcp(std::move(socket)), *tls);
    }
  }

  /// False once it was moved from.
  bool is_there() const { return tcp_ != nullptr || tls_ != nullptr; }

  executor_type get_executor() { return next_layer().get_executor(); }
  Tcp& next_layer() { return tls_ != nullptr ? tls_->next_layer() : *tcp_; }
  const Tcp& next_layer() const { return tls_ != nullptr ? tls_->next_layer() : *tcp_; }
  Tls* tls() { return tls_.get(); }  // null: not encrypted

  template <class Buffers, class Handler>
  void async_read_some(const Buffers& buffers, Handler&& handler) {
    if (tls_ != nullptr) return tls_->async_read_some(buffers, std::forward<Handler>(handler));
    tcp_->async_read_some(buffers, std::forward<Handler>(handler));
  }
  template <class Buffers, class Handler>
  void async_write_some(const Buffers& buffers, Handler&& handler) {
    if (tls_ != nullptr) return tls_->async_write_some(buffers, std::forward<Handler>(handler));
    tcp_->async_write_some(buffers, std::forward<Handler>(handler));
  }

 private:
  std::unique_ptr<Tcp> tcp_;  // one of the two
  std::unique_ptr<Tls> tls_;
};

/// What Beast calls to end the connection below a WebSocket.
template <class Handler>
void async_teardown(boost::beast::role_type role, WebStream& stream, Handler&& handler) {
  if (WebStream::Tls* tls = stream.tls()) return boost::beast::async_teardown(role, *tls, std::forward<Handler>(handler));
  using boost::beast::websocket::async_teardown;
  async_teardown(role, stream.next_layer().socket(), std::forward<Handler>(handler));
}
inline void teardown(boost::beast::role_type role, WebStream& stream, boost::system::error_code& error) {
  using boost::beast::websocket::teardown;
  teardown(role, stream.next_layer().socket(), error);
}

}  // namespace curvecast::server
