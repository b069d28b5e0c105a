#include "server/web/web_body_beast.h"

#include <absl/status/status.h>
#include <absl/strings/match.h>
#include <absl/strings/str_cat.h>

#include <boost/asio/write.hpp>
#include <boost/beast/http/read.hpp>
#include <iterator>
#include <string_view>
#include <utility>

namespace curvecast::server {
namespace {

namespace asio = boost::asio;
namespace http = boost::beast::http;

constexpr std::string_view kContinue = "HTTP/1.1 100 Continue\r\n\r\n";

template <class Parser>
bool expects_continue(const Parser& parser) {
  const auto field = parser.get()[http::field::expect];
  return absl::EqualsIgnoreCase(absl::string_view(field.data(), field.size()), "100-continue");
}

template <class Parser>
std::ptrdiff_t count_fields(const Parser& parser) {
  return std::distance(parser.get().begin(), parser.get().end());
}

}  // namespace

WebBody::WebBody(WebStream& stream, boost::beast::flat_buffer& buffer, HeaderParser&& parser, std::chrono::milliseconds time_out)
    : stream_(stream),
      buffer_(buffer),
      time_out_(time_out),
      parser_(std::move(parser)),
      fields_(count_fields(parser_)),
      says_continue_(expects_continue(parser_) && buffer.size() == 0) {}

void WebBody::read(std::shared_ptr<void> keeper, WebExchange::Take take) {
  if (parser_.is_done()) return take(std::string());
  is_reading_ = true;
  if (!std::exchange(says_continue_, false)) return read_piece(std::move(keeper), std::move(take));
  stream_.next_layer().expires_after(time_out_);
  asio::async_write(stream_, asio::buffer(kContinue.data(), kContinue.size()),
                    [this, keeper = std::move(keeper), take = std::move(take)](Error error, std::size_t /*bytes*/) mutable {
                      is_reading_ = !error;
                      if (error) return take(absl::CancelledError("the client has gone"));
                      read_piece(std::move(keeper), std::move(take));
                    });
}

void WebBody::read_piece(std::shared_ptr<void> keeper, WebExchange::Take take) {
  const auto most = std::chrono::duration_cast<Clock::duration>(time_out_) +
                    std::chrono::seconds((received_ + WebExchange::kMaxBodyPiece) / kLeastRate);
  if (most <= waited_) {
    is_reading_ = false;
    return take(absl::CancelledError("the body comes too slowly"));
  }
  piece_.resize(WebExchange::kMaxBodyPiece);
  parser_.get().body().data = piece_.data();
  parser_.get().body().size = piece_.size();
  stream_.next_layer().expires_after(most - waited_);
  auto handle = [this, keeper = std::move(keeper), take = std::move(take), began = Clock::now()](Error error,
                                                                                                 std::size_t /*bytes*/) mutable {
    waited_ += Clock::now() - began;
    finish_piece(error, std::move(keeper), std::move(take));
  };
  // Of the first piece whatever is there, so that who refuses the rest can do so at once.
  if (received_ == 0) {
    http::async_read_some(stream_, buffer_, parser_, std::move(handle));
  } else {
    http::async_read(stream_, buffer_, parser_, std::move(handle));
  }
}

void WebBody::finish_piece(Error error, std::shared_ptr<void> keeper, WebExchange::Take take) {
  is_reading_ = false;
  const bool is_malformed = error.category() == http::make_error_code(http::error::bad_chunk).category();
  if (error && error != http::error::need_buffer) {
    if (!is_malformed || error == http::error::end_of_stream || error == http::error::partial_message) {
      return take(absl::CancelledError("the client has gone, or was too slow"));
    }
    return take(absl::InvalidArgumentError(absl::StrCat("the body is no HTTP: ", error.message())));
  }
  if (parser_.is_done() && count_fields(parser_) != fields_) {  // the parser adds them to the header, long after it was read
    return take(absl::InvalidArgumentError("the body has trailers; nothing is taken after its last chunk"));
  }
  piece_.resize(piece_.size() - parser_.get().body().size);
  if (piece_.empty() && !parser_.is_done()) {  // the beginning of a chunk
    is_reading_ = true;
    return read_piece(std::move(keeper), std::move(take));
  }
  received_ += piece_.size();
  take(std::exchange(piece_, {}));
}

}  // namespace curvecast::server
