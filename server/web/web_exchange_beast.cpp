#include "server/web/web_exchange_beast.h"

#include <poll.h>

#include <boost/asio/post.hpp>
#include <chrono>
#include <utility>

#include "server/web/web_connection_beast.h"

namespace curvecast::server {
namespace {

constexpr auto kLook = std::chrono::milliseconds(100);  // between looks whether a client that waits is still there

}  // namespace

BeastExchange::BeastExchange(std::shared_ptr<boost::asio::io_context> io, std::weak_ptr<WebConnection> connection,
                             std::uint64_t number, WebRequest request)
    : WebExchange(std::move(request)), io_(std::move(io)), connection_(std::move(connection)), number_(number) {}

BeastExchange::~BeastExchange() {
  if (!answered_) answer({.status = 500, .body = "the server failed\n"});
}

void BeastExchange::read_body(Take take) {
  boost::asio::post(*io_, [connection = connection_, number = number_, take = std::move(take)]() mutable {
    if (const auto open = connection.lock()) return open->read_body(number, std::move(take));
    take(absl::CancelledError("the client has gone"));
  });
}

void BeastExchange::answer(WebAnswer answer) {
  if (answered_.exchange(true)) return;
  boost::asio::post(*io_, [connection = connection_, number = number_, answer = std::move(answer)]() mutable {
    if (const auto open = connection.lock()) open->answer_exchange(number, std::move(answer));
  });
}

void BeastExchange::on_gone(std::function<void()> gone) {
  boost::asio::post(*io_, [connection = connection_, number = number_, gone = std::move(gone)]() mutable {
    if (const auto open = connection.lock(); open != nullptr && open->watch(number, gone)) return;
    gone();
  });
}

bool has_gone(int socket) {
  pollfd looked = {.fd = socket, .events = POLLRDHUP, .revents = 0};
  return ::poll(&looked, 1, 0) > 0 && (looked.revents & (POLLRDHUP | POLLHUP | POLLERR | POLLNVAL)) != 0;
}

// What a connection does for the exchange that waits for its answer.

void WebConnection::keep_watch() {
  timer_.expires_after(kLook);
  timer_.async_wait([self = shared_from_this(), number = open_question_](Error error) {
    if (error || self->open_question_ != number) return;
    if (has_gone(self->stream_.next_layer().socket().native_handle())) return self->lose_client();
    self->keep_watch();
  });
}

void WebConnection::lose_client() {
  open_question_ = 0;
  timer_.cancel();
  stream_.next_layer().close();
  if (const auto lost = std::exchange(on_lost_, nullptr)) lost();
}

bool WebConnection::watch(std::uint64_t number, std::function<void()> gone) {
  if (open_question_ != number) return false;
  on_lost_ = std::move(gone);
  return true;
}

void WebConnection::read_body(std::uint64_t number, WebExchange::Take take) {
  if (open_question_ != number) return take(absl::CancelledError("the client has gone"));
  if (body_ == nullptr) return take(std::string());
  body_->read(shared_from_this(), [this, number, take = std::move(take)](absl::StatusOr<std::string> piece) {
    const bool is_gone = absl::IsCancelled(piece.status());
    take(std::move(piece));
    if (is_gone && open_question_ == number) lose_client();
  });
}

}  // namespace curvecast::server
