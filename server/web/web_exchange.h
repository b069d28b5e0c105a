// A request for a resource: it may have a body, is answered later, and ends when its client goes.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/engine/caller.h"

namespace curvecast::server {

/// An answer to a request.
struct WebAnswer {
  int status = 200;
  std::string body = {};
  std::string type = "text/plain; charset=utf-8";
  std::vector<std::pair<std::string, std::string>> header = {};  // further fields. Cache-Control is no-store without one
  std::shared_ptr<void> held = {};  // kept until the answer has left, or will not: what its bytes count as. May be null
};

/// What the header of a request says. Fields are empty where there are none.
struct WebRequest {
  std::string method;  // "GET"
  std::string path;    // as it came, without the query
  std::string query;   // what follows the path's "?", as it came
  std::string host, origin, fetch_site, content_type, if_none_match, request_id, preflight_method;
  bool has_body = false;
  std::optional<std::uint64_t> body_bytes;  // null: it does not say, or there is none
  Peer peer;                                // who asks, unchecked
};

/// Thread-safe. One that goes without an answer is answered as a failure.
class WebExchange {
 public:
  explicit WebExchange(WebRequest request) : request_(std::move(request)) {}
  virtual ~WebExchange() = default;
  WebExchange(const WebExchange&) = delete;
  WebExchange& operator=(const WebExchange&) = delete;

  const WebRequest& request() const { return request_; }

  /// Reads on, and calls `take` once, on the gateway's thread: with the next bytes of the body, at most kMaxBodyPiece; with none
  /// at its end. Cancelled: the client has gone, or was too slow. InvalidArgument: this is no HTTP. One at a time.
  using Take = std::function<void(absl::StatusOr<std::string>)>;
  virtual void read_body(Take take) = 0;
  static constexpr std::size_t kMaxBodyPiece = std::size_t{256} << 10;

  /// Answers, the first time that it is called. Not while the body is being read.
  virtual void answer(WebAnswer answer) = 0;

  /// Has `gone` called, once at most, on the gateway's thread, when the client goes before it has an answer.
  virtual void on_gone(std::function<void()> gone) = 0;

 private:
  const WebRequest request_;
};

}  // namespace curvecast::server
