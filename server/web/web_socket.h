// The interface of a WebSocket: messages, in order, and an end.
#pragma once

#include <absl/status/statusor.h>

#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "server/engine/caller.h"

namespace curvecast::server {

/// Close codes of RFC 6455.
enum class WebSocketClose { kGoingAway = 1001, kBadMessage = 1007, kRefused = 1008 };

/// Thread-safe; held by shared_ptr. Calls the functions that it is given on the gateway's thread.
class WebSocket {
 public:
  virtual ~WebSocket() = default;
  /// Queues a binary message. Later, never within this call, calls `on_sent(true)` once the message has left, or `on_sent(false)`
  /// if it never will. The sender bounds the queue by waiting for that.
  virtual void send(std::string message, std::function<void(bool ok)> on_sent) = 0;
  /// Lets the next message come: the one received last has been taken.
  virtual void read_on() = 0;
  /// Closes the socket after the messages queued. At most 123 bytes of `reason` are sent.
  virtual void close(WebSocketClose code, std::string reason) = 0;
  /// Ends the connection at once: its client does not read.
  virtual void drop() = 0;
};

/// What receives a socket's messages. Called on the gateway's thread; destroyed when the socket is closed, by either side.
class WebConversation {
 public:
  virtual ~WebConversation() = default;
  /// Takes a message. No other one comes before the socket's read_on().
  virtual void receive(std::string_view message) = 0;
};

/// The client that opened a socket.
struct WebVisitor {
  Peer peer;
  absl::StatusOr<Caller> caller;  // an error: nobody knows him
};

/// Begins a conversation, or closes the socket and returns null.
using WebConversationMaker =
    std::function<std::unique_ptr<WebConversation>(const std::shared_ptr<WebSocket>&, const WebVisitor&)>;

}  // namespace curvecast::server
