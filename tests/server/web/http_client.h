// A plain socket that speaks HTTP word by word, for tests of what others may send.
#pragma once

#include <string>

namespace curvecast::server {

class HttpClient {
 public:
  /// Connects to a port of the loopback.
  explicit HttpClient(int port);
  HttpClient(const HttpClient&) = delete;
  HttpClient& operator=(const HttpClient&) = delete;
  ~HttpClient();

  /// False when the other side has gone.
  bool send(const std::string& bytes) const;
  struct Response {
    int status = 0;  // 0: there was none
    std::string header;
    std::string body;
  };
  /// One response; `has_body` is false for one to HEAD.
  Response receive(bool has_body = true);
  Response get(const std::string& path, const std::string& method = "GET");
  /// Whether the other side closes the connection without sending more; waits for it.
  bool is_closed();

 private:
  bool fill();

  int socket_ = -1;
  std::string received_;
};

}  // namespace curvecast::server
