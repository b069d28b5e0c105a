#include "client/lib/live_view.h"

#include <algorithm>
#include <optional>
#include <utility>

namespace curvecast::client {
namespace {

// Of next_frame(): a view that nobody moves gets no frames. A lost server is noticed by the connection.
constexpr std::chrono::hours kForever{24 * 365};
constexpr std::chrono::seconds kSound{1};  // a stream that has lasted so long was a good one
using Clock = std::chrono::steady_clock;

/// Whether a stream that ended so is worth opening again.
bool may_pass(const absl::Status& status) {
  switch (status.code()) {
    case absl::StatusCode::kAborted:
    case absl::StatusCode::kDeadlineExceeded:
    case absl::StatusCode::kDataLoss:
      return true;
    case absl::StatusCode::kResourceExhausted:  // without: a frame larger than this client takes
      return retry_after(status).has_value();
    default:
      return is_lost(status);
  }
}

}  // namespace

LiveView::LiveView(std::shared_ptr<Connection> connection, std::string session_id, LiveViewCallbacks callbacks,
                   const LiveViewOptions& options)
    : connection_(std::move(connection)),
      session_id_(std::move(session_id)),
      callbacks_(std::move(callbacks)),
      options_(options),
      backoff_(options.first_delay, options.longest_delay),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

std::uint64_t LiveView::look(v1::SampleRequest sample) {
  const std::lock_guard lock(mutex_);
  newest_ = std::move(sample);
  looked_.notify_all();
  return ++looks_;
}

void LiveView::run(const std::stop_token& stop) {
  {
    std::unique_lock lock(mutex_);
    if (!looked_.wait(lock, stop, [this] { return looks_ > 0; })) return;
  }
  while (!stop.stop_requested()) {
    tell(LiveViewState::kConnecting);
    const absl::Status status = follow(stop);
    if (stop.stop_requested()) return;
    if (!may_pass(status)) return tell(LiveViewState::kEnded, status);
    tell(LiveViewState::kWaiting, status);
    sleep_for(std::max(backoff_.next(), retry_after(status).value_or(std::chrono::milliseconds(0))), stop);
  }
}

/// One stream, from its beginning to its end.
absl::Status LiveView::follow(const std::stop_token& stop) {
  std::stop_source over;  // with the stream, or with the whole view
  const std::stop_callback with_all(stop, [&over] { over.request_stop(); });
  const std::unique_ptr<ViewStream> stream =
      ViewStream::open(*connection_, session_id_, over.get_token(),
                       {.deltas = options_.deltas, .first_bytes = options_.first_bytes, .held = held_});
  // Writing may block, while look() and reading must not.
  std::thread sender([&] { send_views(*stream, over.get_token()); });
  absl::Status status = take_frames(*stream, stop);
  over.request_stop();
  stream->close().IgnoreError();  // drops frames that nobody takes any more: the sender may wait for the end behind them
  sender.join();
  // Without a digest the server cannot go on from the points, but until its next frame they are what is shown.
  std::shared_ptr<const Points> shown = std::move(held_.points);
  held_ = stream->held();
  if (held_.digest == 0) held_.points = std::move(shown);
  return status;
}

void LiveView::send_views(ViewStream& stream, const std::stop_token& stop) {
  std::uint64_t sent = 0;
  while (true) {
    v1::SampleRequest sample;
    {
      std::unique_lock lock(mutex_);
      if (!looked_.wait(lock, stop, [&] { return looks_ > sent; })) return;
      sample = newest_;
      sent = looks_;
    }
    if (!stream.send_view(sample, /*key_frame=*/false, sent).ok()) return;  // the frames tell why
  }
}

absl::Status LiveView::take_frames(ViewStream& stream, const std::stop_token& stop) {
  std::optional<Clock::time_point> began;  // the first frame came
  while (true) {
    const absl::StatusOr<Frame> frame = stream.next_frame(kForever);
    if (!frame.ok()) {
      // One that fails at once after each first frame is no better than one that sends none.
      if (began && Clock::now() - *began >= kSound) backoff_.reset();
      return frame.status();
    }
    if (stop.stop_requested()) return absl::CancelledError("stopped");
    if (!began) {
      began = Clock::now();
      tell(LiveViewState::kLive);
    }
    held_.points = frame->points;
    if (callbacks_.on_frame) callbacks_.on_frame(*frame);
  }
}

void LiveView::tell(LiveViewState state, const absl::Status& status) const {
  if (callbacks_.on_state) callbacks_.on_state(state, status);
}

}  // namespace curvecast::client
