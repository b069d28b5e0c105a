// One connection of the HTTP port, until it becomes a WebSocket.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>

#include "server/base/admission.h"
#include "server/web/web_body_beast.h"
#include "server/web/web_gateway.h"
#include "server/web/web_stream_beast.h"

namespace curvecast::server {

class BeastWebSocket;

/// What all connections of a gateway share. Used on the gateway's thread only.
struct WebHub {
  std::shared_ptr<boost::asio::io_context> io;
  const WebGatewayOptions options;
  const WebRoutes routes;
  const std::shared_ptr<spdlog::logger> log;
  std::shared_ptr<boost::asio::ssl::context> tls = {};  // of connections to come; null: not encrypted
  std::shared_ptr<Admission> admission = {};            // of WebSockets
  std::set<BeastWebSocket*> sockets = {};
  bool takes_sockets = true;
  std::function<void()> on_no_sockets = {};  // called once, when the last one has gone; null: nobody waits for that

  void forget(BeastWebSocket& socket);
};

/// Lives as long as one of its operations is under way. Used on the gateway's thread only.
class WebConnection : public std::enable_shared_from_this<WebConnection> {
 public:
  using Clock = std::chrono::steady_clock;

  /// Calls `on_gone` when the connection has ended or become a WebSocket.
  WebConnection(WebHub& hub, boost::asio::ip::tcp::socket socket, std::function<void(WebConnection*)> on_gone);
  ~WebConnection();

  void begin();
  /// Ends the connection, whatever is under way.
  void abort();
  /// What a BeastExchange asks for; does nothing for one that is not the open question. watch() returns whether it is that one:
  /// `gone` is called when its client goes before it has an answer.
  void read_body(std::uint64_t number, WebExchange::Take take);
  void answer_exchange(std::uint64_t number, WebAnswer answer);
  bool watch(std::uint64_t number, std::function<void()> gone);
  /// When the connection began to wait for its other side: for its next request, or a handshake; null while it answers one.
  std::optional<Clock::time_point> waiting_since() const { return waiting_since_; }

 private:
  using Error = boost::system::error_code;
  using Request = boost::beast::http::request<boost::beast::http::empty_body>;
  using Response = boost::beast::http::response<boost::beast::http::string_body>;

  /// Waits, until `end` at most, for the header of a proxy: see server/net/proxy_header.h.
  void meet_proxy(Clock::time_point end);
  void shake_hands();
  void read();
  void receive(Error error);
  /// Null: the answer comes later.
  std::optional<Response> answer(const Request& request, bool has_body);
  std::optional<Response> answer_later(const Request& request, const WebLateRoutes::mapped_type& answer);
  /// Has a resource answer; null but for a client whose certificate is wanted.
  std::optional<Response> begin_exchange(const Request& request);
  /// Looks now and then whether the client of the open question is still there.
  void keep_watch();
  /// The open question's client has gone.
  void lose_client();
  void answer_now(Response response);
  bool is_upgrade(const Request& request) const;
  /// The client that asks for a WebSocket, or a late answer: its address and its certificate; Unauthenticated without one that is
  /// wanted.
  absl::StatusOr<Peer> peer_of(const Request& request);
  /// Makes a WebSocket of the connection, and then returns null; else the answer that refuses it.
  std::optional<Response> upgrade(const Request& request);
  void refuse(boost::beast::http::status status, std::string reason);
  void write(Response response, bool is_head);
  void close();
  /// Reads what a client goes on sending, for a while, so that it gets to read its answer.
  void linger();

  /// What the answer needs to know of the request, whose parser may have gone.
  struct Asked {
    unsigned version = 11;
    bool keeps_alive = false, is_head = false;
  };

  WebHub& hub_;
  WebStream stream_;
  std::string address_;  // of the other end, as gRPC writes it, or of the client for whom it says that it is
  const std::function<void(WebConnection*)> on_gone_;
  boost::beast::flat_buffer buffer_;
  boost::asio::steady_timer timer_;
  std::uint64_t last_question_ = 0, open_question_ = 0;  // numbers of late answers; none is waited for: 0
  std::optional<Clock::time_point> waiting_since_;
  std::optional<boost::beast::http::request_parser<boost::beast::http::empty_body>> parser_;  // of the request that comes or is
                                                                                              // being answered
  Asked asked_;
  std::unique_ptr<WebBody> body_;  // of the request that is being answered; null: it has none, or nobody wants it
  bool has_unread_body_ = false;
  std::size_t lingered_ = 0;       // bytes that were read for nobody
  std::function<void()> on_lost_;  // called when the client of the open question goes; may be null
  Response response_;              // being written
  std::shared_ptr<void> held_;     // WebAnswer::held of it
};

}  // namespace curvecast::server
