// A WebSocket on Boost.Beast.
#pragma once

#include <boost/asio/executor_work_guard.hpp>
#include <boost/asio/io_context.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/websocket/stream.hpp>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "server/base/admission.h"
#include "server/web/web_socket.h"
#include "server/web/web_stream_beast.h"

namespace curvecast::server {

/// The subprotocol that is spoken, and what a token begins with that comes as another one.
inline constexpr char kSubprotocol[] = "curvecast.v1";
inline constexpr char kBearerSubprotocol[] = "curvecast.bearer.";

/// Keeps the gateway's thread going until it is destroyed. Private functions run on that thread.
class BeastWebSocket final : public WebSocket, public std::enable_shared_from_this<BeastWebSocket> {
 public:
  using Request = boost::beast::http::request<boost::beast::http::empty_body>;

  /// Calls `on_over` once, on the gateway's thread, when the connection is over; others may still hold the socket then.
  BeastWebSocket(std::shared_ptr<boost::asio::io_context> io, WebStream stream, Admission::Ticket ticket,
                 std::function<void(BeastWebSocket&)> on_over);

  /// Answers a request to upgrade. On the gateway's thread.
  void accept(const Request& request, const WebVisitor& visitor, const WebConversationMaker& maker);
  /// Ends the connection, whatever is under way. On the gateway's thread.
  void abort();

  void send(std::string message, std::function<void(bool)> on_sent) override;
  void read_on() override;
  void close(WebSocketClose code, std::string reason) override;
  void drop() override;

 private:
  using Error = boost::system::error_code;
  struct Message {
    std::string bytes;
    std::function<void(bool)> on_sent;
  };

  void begin(const WebVisitor& visitor, const WebConversationMaker& maker);
  /// Runs work; an exception ends the connection, and is thrown on.
  template <typename Work>
  void abort_on_exception(Work&& work);
  void read();
  void receive(Error error);
  void write();
  void finish_write(Error error);
  void close_now();

  const std::shared_ptr<boost::asio::io_context> io_;  // first: it outlives all that uses it
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work_;
  const Admission::Ticket ticket_;
  const std::function<void(BeastWebSocket&)> on_over_;
  boost::beast::websocket::stream<WebStream> stream_;
  boost::beast::flat_buffer received_;
  std::unique_ptr<WebConversation> conversation_;  // null: before it begins and once the socket is over
  std::deque<Message> queue_;                      // the first is being written
  std::optional<boost::beast::websocket::close_reason> closing_;
  bool is_open_ = false;  // accepted; stays so
  bool is_over_ = false;
};

}  // namespace curvecast::server
