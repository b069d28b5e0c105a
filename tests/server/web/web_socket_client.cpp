#include "tests/server/web/web_socket_client.h"

#include <boost/asio/connect.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/ssl/ssl_stream.hpp>
#include <boost/beast/websocket/ssl.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <optional>

namespace curvecast::server {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;
using asio::ip::tcp;
using boost::system::error_code;

using Plain = websocket::stream<beast::tcp_stream>;
using Encrypted = websocket::stream<beast::ssl_stream<beast::tcp_stream>>;

}  // namespace

struct WebSocketClient::Socket {
  asio::io_context io;
  asio::ssl::context tls{asio::ssl::context::tls_client};
  std::optional<Plain> plain;
  std::optional<Encrypted> encrypted;
  websocket::response_type response;
  bool is_open = false;

  template <class Work>
  auto with(Work&& work) {
    return encrypted ? work(*encrypted) : work(*plain);
  }

  template <class Stream>
  void shake_hands(Stream& stream, const std::string& host, const WebSocketClientOptions& options) {
    stream.set_option(websocket::stream_base::decorator([&options](websocket::request_type& request) {
      if (!options.origin.empty()) request.set(http::field::origin, options.origin);
      if (!options.forwarded_for.empty()) request.set("x-forwarded-for", options.forwarded_for);
      if (!options.subprotocols.empty()) request.set(http::field::sec_websocket_protocol, options.subprotocols);
    }));
    // Not handshake(), which forgets a response that declines.
    stream.async_handshake(response, host, options.path, [this](error_code error) { is_open = !error; });
    io.run();
    io.restart();
    stream.read_message_max(std::size_t{64} << 20);
    stream.binary(true);
  }
};

WebSocketClient::WebSocketClient(int port, const WebSocketClientOptions& options) : socket_(std::make_unique<Socket>()) {
  const tcp::endpoint server(asio::ip::address_v4::loopback(), static_cast<std::uint16_t>(port));
  const std::string host = options.host.empty() ? "127.0.0.1:" + std::to_string(port) : options.host;
  error_code error;
  if (options.ca.empty()) {
    socket_->plain.emplace(socket_->io);
    beast::get_lowest_layer(*socket_->plain).connect(server, error);
    if (!error) socket_->shake_hands(*socket_->plain, host, options);
    return;
  }
  socket_->tls.load_verify_file(options.ca);
  socket_->tls.set_verify_mode(asio::ssl::verify_peer);
  if (!options.cert.empty()) {
    socket_->tls.use_certificate_chain_file(options.cert);
    socket_->tls.use_private_key_file(options.key, asio::ssl::context::pem);
  }
  socket_->encrypted.emplace(socket_->io, socket_->tls);
  beast::get_lowest_layer(*socket_->encrypted).connect(server, error);
  if (!error) socket_->encrypted->next_layer().handshake(asio::ssl::stream_base::client, error);
  if (!error) socket_->shake_hands(*socket_->encrypted, host, options);
}

WebSocketClient::~WebSocketClient() = default;

bool WebSocketClient::is_open() const { return socket_->is_open; }

int WebSocketClient::http_status() const {
  return socket_->response.begin() == socket_->response.end() ? 0 : static_cast<int>(socket_->response.result_int());
}

std::string WebSocketClient::subprotocol() const {
  const auto name = socket_->response[http::field::sec_websocket_protocol];
  return {name.data(), name.size()};
}

bool WebSocketClient::send(std::string_view bytes, bool is_binary) {
  return socket_->with([&](auto& stream) {
    error_code error;
    stream.binary(is_binary);
    stream.write(asio::buffer(bytes.data(), bytes.size()), error);
    return !error;
  });
}

bool WebSocketClient::send(const v1::CallRequest& request) { return send(request.SerializeAsString()); }

bool WebSocketClient::receive(v1::CallResponse& response) {
  return socket_->with([&](auto& stream) {
    beast::flat_buffer buffer;
    error_code error;
    stream.read(buffer, error);
    return !error && response.ParseFromArray(buffer.data().data(), static_cast<int>(buffer.size()));
  });
}

int WebSocketClient::close_code() const {
  return socket_->with([](auto& stream) { return static_cast<int>(stream.reason().code); });
}

std::string WebSocketClient::close_reason() const {
  return socket_->with([](auto& stream) { return std::string(stream.reason().reason.c_str()); });
}

WebSocketClient::Answer WebSocketClient::call(const std::string& method, const std::vector<std::string>& requests) {
  Answer answer;
  v1::CallRequest request;
  request.set_call(next_call());
  request.set_method(method);
  if (!send(request)) return answer;
  request.clear_method();
  for (const std::string& message : requests) {
    request.set_message(message);
    if (!send(request)) return answer;
  }
  request.clear_message();
  request.set_half_close(true);
  if (!send(request)) return answer;
  v1::CallResponse response;
  while (receive(response)) {
    if (response.call() != request.call()) continue;
    if (response.has_message()) answer.messages.push_back(response.message());
    if (!response.has_status()) continue;
    answer.status = response.status();
    answer.code = response.status().code();
    answer.error = response.status().message();
    return answer;
  }
  return answer;
}

WebSocketClient::Answer WebSocketClient::call(const std::string& method, const google::protobuf::MessageLite& request) {
  return call(method, std::vector<std::string>{request.SerializeAsString()});
}

}  // namespace curvecast::server
