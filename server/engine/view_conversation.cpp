#include "server/engine/view_conversation.h"

#include <chrono>
#include <utility>

#include "server/base/status_from_exceptions.h"

namespace curvecast::server {

absl::StatusOr<std::unique_ptr<ViewConversation>> ViewConversation::begin(Engine& engine, ClientStream::Transport* transport,
                                                                          const Caller& caller) {
  absl::StatusOr<Admission::Ticket> ticket = engine.streams->admit(caller.name);
  if (!ticket.ok()) return ticket.status();
  auto stream = engine.make_stream(transport, caller);
  if (!stream.ok()) return stream.status();
  return std::unique_ptr<ViewConversation>(new ViewConversation(engine, caller, *std::move(ticket), *std::move(stream)));
}

ViewConversation::ViewConversation(Engine& engine, const Caller& caller, Admission::Ticket ticket,
                                   std::shared_ptr<ClientStream> stream)
    : engine_(engine),
      owner_(caller.owner),
      ticket_(std::move(ticket)),
      stream_(std::move(stream)),
      watched_(engine.callers, caller,
               [weak = std::weak_ptr(stream_)](const absl::Status& why) {
                 if (const auto open = weak.lock()) open->stop(why);
               }),
      tally_(engine.metrics),
      rate_(engine.max_view_rate) {}

void ViewConversation::receive(const v1::StreamViewsRequest& request, std::function<void()> on_received) {
  if (request.has_view()) tally_.received(request.view().sequence());
  if (request.has_open() && engine_.sessions.must_load(request.open().session_id())) {
    // By a thread that may wait for the disk, or the store, before the stream hears of it.
    const auto submitted = engine_.cache->loading(request.open().session_id()).submit([this, &request, on_received] {
      const auto loaded = status_from_exceptions([&] { return engine_.sessions.find(request.open().session_id(), owner_); });
      stream_->receive(request);  // finds it in memory, or an error
      on_received();
    });
    if (submitted.ok()) return;
    stream_->stop(submitted.status());
    return on_received();
  }
  stream_->receive(request);
  const RateLimit::Clock::duration wait = rate_.take(RateLimit::Clock::now());
  {
    const MutexLock lock(mutex_);
    if (wait > RateLimit::Clock::duration::zero() && !is_over_) {
      // Not reading is what slows the client down: its messages wait with itself. The alarm keeps the function that it is given
      // after it has gone off: that one must hold nothing.
      on_received_ = std::move(on_received);
      return alarm_.Set(std::chrono::system_clock::now() + wait, [this](bool) { resume(); });
    }
  }
  on_received();
}

void ViewConversation::resume() {
  std::function<void()> on_received;
  {
    const MutexLock lock(mutex_);
    on_received.swap(on_received_);
  }
  on_received();  // may destroy this conversation
}

void ViewConversation::end_pause() {
  const MutexLock lock(mutex_);
  is_over_ = true;
  alarm_.Cancel();
}

void ViewConversation::count_sent(const v1::StreamViewsResponse& response) {
  tally_.answered(response.frame().sequence());
  engine_.metrics.frame(response.frame());
}

}  // namespace curvecast::server
