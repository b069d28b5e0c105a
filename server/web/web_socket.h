// What a WebSocket is to those who talk through it: messages, in order, and an end.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>

namespace curvecast::server {

/// Close codes of RFC 6455.
enum class WebSocketClose { kGoingAway = 1001, kBadMessage = 1007, kRefused = 1008 };

/// Thread-safe; held by shared_ptr. Functions that it is given are called on the gateway's thread.
class WebSocket {
 public:
  virtual ~WebSocket() = default;
  /// Queues a binary message. Then `on_sent(true)`, once it has left, or `on_sent(false)`: it never will. Never within the call.
  /// Whoever sends bounds the queue by waiting for that.
  virtual void send(std::string message, std::function<void(bool ok)> on_sent) = 0;
  /// The message received last has been taken: the next one may come.
  virtual void read_on() = 0;
  /// After the messages queued. `reason`: at most 123 bytes of it.
  virtual void close(WebSocketClose code, std::string reason) = 0;
};

/// What goes on over a socket. Called on the gateway's thread; let go of when the socket is closed, by either side.
class WebConversation {
 public:
  virtual ~WebConversation() = default;
  /// No other message comes before the socket's read_on().
  virtual void receive(std::string_view message) = 0;
};

/// Who opened a socket.
struct WebPeer {
  std::string address = {};        // as gRPC writes it: "ipv4:127.0.0.1:4711"
  std::string authorization = {};  // "Bearer TOKEN"; empty: none was sent
};

/// Begins a conversation, or closes the socket and returns null.
using WebConversationMaker = std::function<std::unique_ptr<WebConversation>(const std::shared_ptr<WebSocket>&, const WebPeer&)>;

}  // namespace curvecast::server
