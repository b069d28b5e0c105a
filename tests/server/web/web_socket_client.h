// A WebSocket client that waits for each answer, and speaks CallRequest and CallResponse.
#pragma once

#include <google/protobuf/message_lite.h>

#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "curvecast/v1/web_socket.pb.h"

namespace curvecast::server {

struct WebSocketClientOptions {
  std::string path = "/v1/socket";
  std::string origin = {};                    // none is sent
  std::string host = {};                      // empty: 127.0.0.1 and the port
  std::string subprotocols = "curvecast.v1";  // as in the header
  std::string forwarded_for = {};             // as well
  std::string ca = {}, cert = {}, key = {};   // PEM files; with `ca`, encrypted
};

class WebSocketClient {
 public:
  /// Connects to a port of the loopback.
  explicit WebSocketClient(int port, const WebSocketClientOptions& options = {});
  WebSocketClient(const WebSocketClient&) = delete;
  WebSocketClient& operator=(const WebSocketClient&) = delete;
  ~WebSocketClient();

  bool is_open() const;
  int http_status() const;          // of the answer to the upgrade; 101 where it was accepted, 0: none came
  std::string subprotocol() const;  // that the server has chosen

  /// False when the other side has gone.
  bool send(std::string_view bytes, bool is_binary = true);
  bool send(const v1::CallRequest& request);
  /// The next message; false where the socket has been closed instead.
  bool receive(v1::CallResponse& response);
  int close_code() const;  // why it was; 0: it was not, or without a code
  std::string close_reason() const;

  struct Answer {
    int code = -1;  // a gRPC status code
    std::string error;
    v1::Status status;
    std::vector<std::string> messages;
  };
  /// One call, with its request messages, to its end. Messages of other calls are skipped.
  Answer call(const std::string& method, const std::vector<std::string>& requests);
  Answer call(const std::string& method, const google::protobuf::MessageLite& request);
  /// A number that no call has had.
  std::uint32_t next_call() { return ++calls_; }

 private:
  struct Socket;
  std::unique_ptr<Socket> socket_;
  std::uint32_t calls_ = 0;
};

}  // namespace curvecast::server
