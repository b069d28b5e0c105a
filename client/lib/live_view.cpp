// SPDX-License-Identifier: Apache-2.0
#include "client/lib/live_view.h"

#include <algorithm>
#include <condition_variable>
#include <optional>
#include <stop_token>
#include <thread>
#include <utility>

#include "client/lib/retry.h"
#include "core/base/mutex.h"

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

struct LiveView::State {
  State(std::shared_ptr<Connection> view_connection, std::string session, LiveViewCallbacks view_callbacks,
        const LiveViewOptions& view_options)
      : connection(std::move(view_connection)),
        session_id(std::move(session)),
        callbacks(std::move(view_callbacks)),
        options(view_options),
        backoff(options.first_delay, options.longest_delay),
        thread([this](const std::stop_token& stop) { run(stop); }) {}

  void run(const std::stop_token& stop);
  absl::Status follow(const std::stop_token& stop);
  void send_views(ViewStream& stream, const std::stop_token& stop);
  absl::Status take_frames(ViewStream& stream, const std::stop_token& stop);
  bool wait_for_look(MutexLock& lock, const std::stop_token& stop, std::uint64_t last) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex);
  void tell(LiveViewState state, const absl::Status& status = absl::OkStatus()) const;

  const std::shared_ptr<Connection> connection;
  const std::string session_id;
  const LiveViewCallbacks callbacks;
  const LiveViewOptions options;

  Mutex mutex;
  std::condition_variable_any looked;
  v1::SampleRequest newest ABSL_GUARDED_BY(mutex);
  std::uint64_t looks ABSL_GUARDED_BY(mutex) = 0;  // the number of the newest view

  // Of the thread.
  HeldFrame held;
  Backoff backoff;

  std::jthread thread;  // last: it uses all of the above
};

LiveView::LiveView(std::shared_ptr<Connection> connection, std::string session_id, LiveViewCallbacks callbacks,
                   const LiveViewOptions& options)
    : state_(std::make_unique<State>(std::move(connection), std::move(session_id), std::move(callbacks), options)) {}
LiveView::~LiveView() = default;

std::uint64_t LiveView::look(v1::SampleRequest sample) {
  const MutexLock lock(state_->mutex);
  state_->newest = std::move(sample);
  state_->looked.notify_all();
  return ++state_->looks;
}

void LiveView::State::run(const std::stop_token& stop) {
  {
    MutexLock lock(mutex);
    if (!wait_for_look(lock, stop, 0)) return;
  }
  while (!stop.stop_requested()) {
    tell(LiveViewState::kConnecting);
    const absl::Status status = follow(stop);
    if (stop.stop_requested()) return;
    if (!may_pass(status)) return tell(LiveViewState::kEnded, status);
    tell(LiveViewState::kWaiting, status);
    connection->pause(std::max(backoff.next(), retry_after(status).value_or(std::chrono::milliseconds(0))), stop);
  }
}

/// One stream, from its beginning to its end.
absl::Status LiveView::State::follow(const std::stop_token& stop) {
  std::stop_source over;  // with the stream, or with the whole view
  const std::stop_callback with_all(stop, [&over] { over.request_stop(); });
  const std::unique_ptr<ViewStream> stream = ViewStream::open(
      *connection, session_id, over.get_token(), {.deltas = options.deltas, .first_bytes = options.first_bytes, .held = held});
  // Writing may block, while look() and reading must not.
  std::thread sender([&] { send_views(*stream, over.get_token()); });
  absl::Status status = take_frames(*stream, stop);
  over.request_stop();
  stream->close().IgnoreError();  // drops frames that nobody takes any more: the sender may wait for the end behind them
  sender.join();
  // Without a digest the server cannot go on from the points, but until its next frame they are what is shown.
  std::shared_ptr<const Points> shown = std::move(held.points);
  held = stream->held();
  if (held.digest == 0) held.points = std::move(shown);
  return status;
}

void LiveView::State::send_views(ViewStream& stream, const std::stop_token& stop) {
  std::uint64_t sent = 0;
  while (true) {
    v1::SampleRequest sample;
    {
      MutexLock lock(mutex);
      if (!wait_for_look(lock, stop, sent)) return;
      sample = newest;
      sent = looks;
    }
    if (!stream.send_view(sample, /*key_frame=*/false, sent).ok()) return;  // the frames tell why
  }
}

absl::Status LiveView::State::take_frames(ViewStream& stream, const std::stop_token& stop) {
  std::optional<Clock::time_point> began;  // the first frame came
  while (true) {
    const absl::StatusOr<Frame> frame = stream.next_frame(kForever);
    if (!frame.ok()) {
      // One that fails at once after each first frame is no better than one that sends none.
      if (began && Clock::now() - *began >= kSound) backoff.reset();
      return frame.status();
    }
    if (stop.stop_requested()) return absl::CancelledError("stopped");
    if (!began) {
      began = Clock::now();
      tell(LiveViewState::kLive);
    }
    held.points = frame->points;
    if (callbacks.on_frame) callbacks.on_frame(*frame);
  }
}

/// Waits for a view after number `last`. False: it is to stop.
bool LiveView::State::wait_for_look(MutexLock& lock, const std::stop_token& stop, std::uint64_t last) {
  return looked.wait(lock, stop, [this, last] {
    mutex.assert_held();
    return looks > last;
  });
}

void LiveView::State::tell(LiveViewState state, const absl::Status& status) const {
  if (callbacks.on_state) callbacks.on_state(state, status);
}

}  // namespace curvecast::client
