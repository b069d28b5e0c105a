#include "server/web_gateway.h"

#include <absl/cleanup/cleanup.h>
#include <absl/strings/str_cat.h>
#include <spdlog/logger.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/read.hpp>
#include <boost/beast/http/string_body.hpp>
#include <boost/beast/http/write.hpp>
#include <cstdint>
#include <limits>
#include <optional>
#include <thread>
#include <utility>

#include "server/address.h"

namespace curvecast::server {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
using asio::ip::tcp;
using boost::system::error_code;

constexpr std::uint32_t kMaxHeader = 8 * 1024;                 // bytes
constexpr std::size_t kMaxBuffered = 2 * kMaxHeader;           // requests that come before the answer to the one before
constexpr auto kAcceptPause = std::chrono::milliseconds(100);  // when there are no descriptors left, say

using Response = http::response<http::string_body>;

Response plain(http::status status, std::string body) {
  Response response(status, 11);
  response.set(http::field::content_type, "text/plain; charset=utf-8");
  response.body() = std::move(body);
  return response;
}

/// Without the header that depends on the connection.
Response answer(const WebRoutes& routes, const http::request<http::empty_body>& request, bool has_body) {
  const std::string_view target(request.target().data(), request.target().size());
  const auto route = routes.find(target.substr(0, target.find('?')));
  if (route == routes.end()) return plain(http::status::not_found, "there is nothing of this name\n");
  if (request.method() != http::verb::get && request.method() != http::verb::head) {
    Response response = plain(http::status::method_not_allowed, "only GET and HEAD are answered\n");
    response.set(http::field::allow, "GET, HEAD");
    return response;
  }
  if (has_body) return plain(http::status::payload_too_large, "no body is taken\n");
  WebAnswer made = route->second();
  Response response(static_cast<http::status>(made.status), 11);
  response.set(http::field::content_type, made.type);
  response.body() = std::move(made.body);
  return response;
}

/// One connection; lives as long as an operation of it is under way. All of it on the gateway's thread.
class Connection : public std::enable_shared_from_this<Connection> {
 public:
  Connection(tcp::socket socket, const WebRoutes& routes, const WebGatewayOptions& options, spdlog::logger& log,
             std::function<void()> on_gone)
      : stream_(std::move(socket)), routes_(routes), options_(options), log_(log), on_gone_(std::move(on_gone)) {}
  ~Connection() { on_gone_(); }

  void read() {
    parser_.emplace();
    parser_->header_limit(kMaxHeader);
    parser_->body_limit(std::numeric_limits<std::uint64_t>::max());  // none is read
    stream_.expires_after(options_.time_out);                        // however slowly it comes
    http::async_read_header(stream_, buffer_, *parser_,
                            [self = shared_from_this()](error_code error, std::size_t /*bytes*/) { self->take(error); });
  }

 private:
  void take(error_code error) {
    if (error == http::error::header_limit || error == http::error::buffer_overflow) {
      return refuse(http::status::request_header_fields_too_large, "the header is too long\n");
    }
    const bool is_malformed = error.category() == http::make_error_code(http::error::bad_method).category();
    if (error == http::error::end_of_stream || error == http::error::partial_message || (error && !is_malformed)) return close();
    if (error) return refuse(http::status::bad_request, "this is not HTTP/1.1\n");
    const bool has_body = !parser_->is_done();
    const http::request<http::empty_body>& request = parser_->get();
    Response response = make_response(request, has_body);
    response.version(request.version());
    response.keep_alive(request.keep_alive() && !has_body);  // a body is not read, so that nothing can follow it
    write(std::move(response), request.method() == http::verb::head);
  }

  Response make_response(const http::request<http::empty_body>& request, bool has_body) {
    try {
      return answer(routes_, request, has_body);
    } catch (const std::exception& error) {  // of the standard library, such as bad_alloc
      log_.error("http: {}", error.what());
      return plain(http::status::internal_server_error, "the server failed\n");
    }
  }

  void refuse(http::status status, std::string reason) {
    Response response = plain(status, std::move(reason));
    response.keep_alive(false);
    write(std::move(response), false);
  }

  void write(Response response, bool is_head) {
    response.set(http::field::cache_control, "no-store");
    response.set("X-Content-Type-Options", "nosniff");
    response.content_length(response.body().size());
    if (is_head) response.body().clear();
    response_ = std::move(response);
    stream_.expires_after(options_.time_out);
    http::async_write(stream_, response_, [self = shared_from_this()](error_code error, std::size_t /*bytes*/) {
      if (error || self->response_.need_eof()) return self->close();
      self->read();
    });
  }

  void close() {
    error_code ignored;
    stream_.socket().shutdown(tcp::socket::shutdown_send, ignored);
  }

  beast::tcp_stream stream_;
  const WebRoutes& routes_;
  const WebGatewayOptions& options_;
  spdlog::logger& log_;
  const std::function<void()> on_gone_;
  beast::flat_buffer buffer_{kMaxBuffered};
  std::optional<http::request_parser<http::empty_body>> parser_;  // of the request that comes or is being answered
  Response response_;                                             // being written
};

class BeastGateway final : public WebGateway {
 public:
  BeastGateway(const WebGatewayOptions& options, WebRoutes routes, std::shared_ptr<spdlog::logger> log)
      : options_(options), routes_(std::move(routes)), log_(std::move(log)) {}

  ~BeastGateway() override {
    io_.stop();
    if (thread_.joinable()) thread_.join();
    stopped_ = true;  // connections go with io_
  }

  absl::Status listen() {
    const absl::StatusOr<Address> address = parse_address(options_.listen);
    if (!address.ok()) return address.status();
    error_code error;
    const auto found = tcp::resolver(io_).resolve(address->host, std::to_string(address->port),
                                                  tcp::resolver::passive | tcp::resolver::numeric_service, error);
    if (!error) {
      const tcp::endpoint endpoint = found.begin()->endpoint();
      acceptor_.open(endpoint.protocol(), error);
      if (!error) acceptor_.set_option(tcp::acceptor::reuse_address(true), error);  // of connections that have just gone
      if (!error) acceptor_.bind(endpoint, error);
      if (!error) acceptor_.listen(asio::socket_base::max_listen_connections, error);
      if (!error) port_ = acceptor_.local_endpoint(error).port();
    }
    if (error) return absl::UnavailableError(absl::StrCat("cannot listen on ", options_.listen, ": ", error.message()));
    accept();
    thread_ = std::thread([this] { run(); });
    return absl::OkStatus();
  }

  int port() const override { return port_; }

 private:
  void run() {
    while (!io_.stopped()) {
      try {
        io_.run();
      } catch (const std::exception& error) {  // the connection whose turn it was is gone
        log_->error("http: {}", error.what());
      }
    }
  }

  void accept() {
    accepting_ = true;
    acceptor_.async_accept([this](error_code error, tcp::socket socket) {
      accepting_ = false;
      if (error) return pause();
      const absl::Cleanup next = [this] { accept_more(); };  // even where there is no memory for this one
      const auto connection = std::make_shared<Connection>(std::move(socket), routes_, options_, *log_, [this] { note_gone(); });
      ++connections_;
      connection->read();
    });
  }

  void pause() {
    accepting_ = true;
    timer_.expires_after(kAcceptPause);
    timer_.async_wait([this](error_code /*ignored*/) { accept(); });
  }

  void accept_more() {
    if (!stopped_ && !accepting_ && connections_ < options_.max_connections) accept();
  }

  void note_gone() {
    --connections_;
    accept_more();
  }

  const WebGatewayOptions options_;
  const WebRoutes routes_;
  const std::shared_ptr<spdlog::logger> log_;
  int port_ = 0;
  // What follows belongs to the gateway's thread.
  std::size_t connections_ = 0;
  bool accepting_ = false;  // or about to
  bool stopped_ = false;
  asio::io_context io_{1};
  tcp::acceptor acceptor_{io_};
  asio::steady_timer timer_{io_};
  std::thread thread_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<WebGateway>> WebGateway::start(const WebGatewayOptions& options, WebRoutes routes,
                                                              std::shared_ptr<spdlog::logger> log) {
  auto gateway = std::make_unique<BeastGateway>(options, std::move(routes), std::move(log));
  if (absl::Status status = gateway->listen(); !status.ok()) return status;
  return gateway;
}

}  // namespace curvecast::server
