// A server on the loopback that answers HTTP as a test says, or does not, or only half.
#pragma once

#include <atomic>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace curvecast::server {

class HttpServer {
 public:
  struct Request {
    std::string method, path, query;             // as they came
    std::map<std::string, std::string> headers;  // by name in lower case
    std::string body;

    std::string header(const std::string& name) const;
  };
  enum class End {
    kKeep,   // the connection stays
    kCut,    // after half of the body it ends
    kStall,  // after half of the body nothing comes any more
    kHang,   // there is no answer
    kReset,  // nor a connection
  };
  struct Reply {
    int status = 200;
    std::map<std::string, std::string> headers = {};
    std::string body = {};  // of HEAD only the length is sent
    End end = End::kKeep;
  };
  /// Called by a thread for each connection.
  using Handler = std::function<Reply(const Request& request)>;

  explicit HttpServer(Handler handler);
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;
  ~HttpServer();

  std::string url() const;  // "http://127.0.0.1:PORT"
  /// How many connections have been made so far.
  int connections() const { return connections_; }

 private:
  void accept_all();
  void serve(int connection);

  const Handler handler_;
  int listener_ = -1;
  int port_ = 0;
  std::atomic<int> connections_ = 0;
  std::mutex mutex_;
  bool is_ending_ = false;
  std::vector<int> open_;
  std::vector<std::thread> threads_;
  std::thread accepting_;  // last
};

}  // namespace curvecast::server
