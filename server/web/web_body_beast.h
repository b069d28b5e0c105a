// The body of a request, piece by piece.
#pragma once

#include <absl/status/statusor.h>

#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http/buffer_body.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "server/web/web_exchange.h"
#include "server/web/web_stream_beast.h"

namespace curvecast::server {

/// How slowly a client may send, and take.
inline constexpr std::size_t kLeastRate = 16 * 1024;  // bytes a second, after the first while

/// Used on the gateway's thread. `stream` and `buffer` outlive it, and whatever it has begun.
class WebBody {
 public:
  using HeaderParser = boost::beast::http::request_parser<boost::beast::http::empty_body>;

  /// `parser` has read a header that says that a body follows. Of the client's time, `time_out` is free.
  WebBody(WebStream& stream, boost::beast::flat_buffer& buffer, HeaderParser&& parser, std::chrono::milliseconds time_out);

  /// Whether all of it has been read.
  bool is_done() const { return parser_.is_done(); }
  /// Whether something is being read.
  bool is_reading() const { return is_reading_; }
  /// As WebExchange::read_body(); InvalidArgument also where trailers follow the chunks. `keeper` is kept until `take` is called;
  /// it keeps the stream. A client that waits to be told so before it sends (Expect: 100-continue) is told.
  void read(std::shared_ptr<void> keeper, WebExchange::Take take);

 private:
  using Clock = std::chrono::steady_clock;
  using Error = boost::system::error_code;

  void read_piece(std::shared_ptr<void> keeper, WebExchange::Take take);
  void finish_piece(Error error, std::shared_ptr<void> keeper, WebExchange::Take take);

  WebStream& stream_;
  boost::beast::flat_buffer& buffer_;
  const std::chrono::milliseconds time_out_;
  boost::beast::http::request_parser<boost::beast::http::buffer_body> parser_;
  const std::ptrdiff_t fields_;  // of the header
  bool says_continue_;           // to be said yet
  bool is_reading_ = false;
  std::string piece_;           // being read
  std::uint64_t received_ = 0;  // bytes
  Clock::duration waited_{};    // for the client
};

}  // namespace curvecast::server
