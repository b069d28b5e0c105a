#include "server/web/web_socket_beast.h"

#include <algorithm>
#include <boost/asio/post.hpp>
#include <boost/beast/http/field.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <chrono>
#include <utility>

#include "server/base/protocol.h"

namespace curvecast::server {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;
namespace websocket = boost::beast::websocket;

constexpr std::size_t kMaxIdleBuffer = std::size_t{64} << 10;  // kept from one message to the next
constexpr std::size_t kPiece = std::size_t{64} << 10;          // of a message sent
constexpr std::size_t kMaxReason = 123;                        // bytes, of RFC 6455
constexpr auto kHandshakeTime = std::chrono::seconds(10);
constexpr auto kIdleTime = std::chrono::seconds(60);  // halfway through, a ping is sent; without an answer it is over

}  // namespace

BeastWebSocket::BeastWebSocket(std::shared_ptr<asio::io_context> io, WebStream stream, Admission::Ticket ticket,
                               std::function<void(BeastWebSocket&)> on_over)
    : io_(std::move(io)),
      work_(io_->get_executor()),
      ticket_(std::move(ticket)),
      on_over_(std::move(on_over)),
      stream_(std::move(stream)) {}

void BeastWebSocket::accept(const Request& request, const WebVisitor& visitor, const WebConversationMaker& maker) {
  stream_.next_layer().next_layer().expires_never();  // the WebSocket has times of its own
  stream_.set_option(websocket::stream_base::timeout{kHandshakeTime, kIdleTime, true});
  stream_.set_option(websocket::stream_base::decorator(
      [](websocket::response_type& response) { response.set(http::field::sec_websocket_protocol, kSubprotocol); }));
  stream_.set_option(websocket::permessage_deflate());  // off: Draco's bytes do not get smaller
  stream_.read_message_max(kMaxSocketMessageBytes);
  // Pings, whose answers keep the connection alive, can go between the pieces of a message that takes long.
  stream_.auto_fragment(true);
  stream_.write_buffer_bytes(kPiece);
  stream_.binary(true);
  stream_.async_accept(request, [self = shared_from_this(), visitor, maker](Error error) {
    if (error) return self->abort();
    self->abort_on_exception([&] { self->begin(visitor, maker); });
  });
}

void BeastWebSocket::begin(const WebVisitor& visitor, const WebConversationMaker& maker) {
  if (is_over_) return;
  is_open_ = true;
  if (closing_) return close_now();
  conversation_ = maker(shared_from_this(), visitor);
  if (conversation_ != nullptr) read();
}

template <typename Work>
void BeastWebSocket::abort_on_exception(Work&& work) {
  try {
    work();
  } catch (...) {  // of the standard library, such as bad_alloc
    abort();
    throw;
  }
}

void BeastWebSocket::send(std::string message, std::function<void(bool)> on_sent) {
  asio::post(stream_.get_executor(),
             [self = shared_from_this(), message = std::move(message), on_sent = std::move(on_sent)]() mutable {
               if (self->is_over_ || self->closing_) return on_sent(false);
               self->queue_.push_back({std::move(message), std::move(on_sent)});
               if (self->queue_.size() == 1) self->write();
             });
}

void BeastWebSocket::read_on() {
  asio::post(stream_.get_executor(), [self = shared_from_this()] {
    if (self->conversation_ != nullptr) self->read();
  });
}

void BeastWebSocket::close(WebSocketClose code, std::string reason) {
  asio::post(stream_.get_executor(), [self = shared_from_this(), code, reason = std::move(reason)] {
    if (self->is_over_ || self->closing_) return;
    self->closing_.emplace(static_cast<websocket::close_code>(code),
                           beast::string_view(reason.data(), std::min(reason.size(), kMaxReason)));
    if (self->is_open_ && self->queue_.empty()) self->close_now();
  });
}

void BeastWebSocket::drop() {
  asio::post(stream_.get_executor(), [self = shared_from_this()] { self->abort(); });
}

void BeastWebSocket::read() {
  received_.consume(received_.size());
  if (received_.capacity() > kMaxIdleBuffer) received_.shrink_to_fit();
  stream_.async_read(received_, [self = shared_from_this()](Error error, std::size_t /*bytes*/) { self->receive(error); });
}

void BeastWebSocket::receive(Error error) {
  if (error) return abort();
  if (conversation_ == nullptr) return;  // it is being closed
  if (!stream_.got_binary()) return close(WebSocketClose::kBadMessage, "messages are binary");
  abort_on_exception([&] { conversation_->receive({static_cast<const char*>(received_.data().data()), received_.size()}); });
}

void BeastWebSocket::write() {
  stream_.async_write(asio::buffer(queue_.front().bytes),
                      [self = shared_from_this()](Error error, std::size_t /*bytes*/) { self->finish_write(error); });
}

void BeastWebSocket::finish_write(Error error) {
  const Message sent = std::move(queue_.front());
  queue_.pop_front();
  sent.on_sent(!error);
  if (error) return abort();
  if (!queue_.empty()) return write();
  if (closing_ && !is_over_) close_now();
}

void BeastWebSocket::close_now() {
  // What is being read, or was, is for nobody any more; the read itself ends with the connection.
  const std::unique_ptr<WebConversation> ended = std::move(conversation_);
  stream_.async_close(*closing_, [self = shared_from_this()](Error /*ignored*/) { self->abort(); });
}

void BeastWebSocket::abort() {
  if (std::exchange(is_over_, true)) return;
  on_over_(*this);
  const std::unique_ptr<WebConversation> ended = std::move(conversation_);
  beast::close_socket(beast::get_lowest_layer(stream_));
  // The first, if any, is with the stream, which gives it back.
  while (queue_.size() > 1) {
    const Message never = std::move(queue_.back());
    queue_.pop_back();
    never.on_sent(false);
  }
}

}  // namespace curvecast::server
