// SPDX-License-Identifier: Apache-2.0
#include "client/lib/view_stream.h"

#include <absl/strings/str_cat.h>

#include <deque>
#include <optional>
#include <thread>
#include <utility>

#include "client/lib/point_blocks.h"
#include "client/lib/point_edits.h"
#include "client/lib/retry.h"
#include "core/base/mutex.h"

namespace curvecast::client {
namespace {

// The server keeps two frames in flight at most; a few more are refused frames, which are small.
constexpr std::size_t kMaxQueuedFrames = 16;
// Views of which it is remembered what they asked for. A frame for an older one can be shown, but not resumed from.
constexpr std::size_t kMostRemembered = 256;

absl::Status bad_frame(const v1::PointFrame& message, absl::string_view why) {
  return absl::DataLossError(absl::StrCat("frame ", message.sequence(), ": ", why));
}

/// The points of a frame that has no error.
absl::StatusOr<Points> decode_points(const v1::PointFrame& message, const Points* held) {
  if (message.kind() == v1::FRAME_KIND_KEY) return decode_blocks(message.points());
  if (message.kind() != v1::FRAME_KIND_DELTA) return bad_frame(message, absl::StrCat("kind ", message.kind(), " is not known"));
  if (held == nullptr) return bad_frame(message, "a delta to points that are not there");
  const absl::StatusOr<Points> added = decode_blocks(message.points());
  if (!added.ok()) return added.status();
  absl::StatusOr<Points> points = apply_edits(*held, message.edits(), *added);
  if (!points.ok()) return bad_frame(message, points.status().message());
  if (points->size() != message.held_points()) {
    return bad_frame(message, absl::StrCat("there are ", points->size(), " points after it, not ", message.held_points()));
  }
  return points;
}

/// Takes a frame in.
absl::StatusOr<Frame> decode_frame(const v1::PointFrame& message, HeldFrame& held_frame) {
  std::shared_ptr<const Points>& held = held_frame.points;
  const auto start = std::chrono::steady_clock::now();
  Frame frame;
  frame.sequence = message.sequence();
  frame.curve_revision = message.curve_revision();
  frame.statistics = message.statistics();
  frame.points = held;
  if (message.has_error()) {
    frame.error = absl::Status(static_cast<absl::StatusCode>(message.error().code()), message.error().message());
    if (frame.error.ok()) frame.error = absl::UnknownError(message.error().message());
    if (message.error().retry_after() > 0)
      set_retry_after(frame.error, std::chrono::duration<double>(message.error().retry_after()));
    return frame;
  }
  absl::StatusOr<Points> points = decode_points(message, held.get());
  if (!points.ok()) {
    held_frame = {.points = nullptr, .digest = 0};
    return points.status();
  }
  frame.is_delta = message.kind() == v1::FRAME_KIND_DELTA;
  frame.removed = frame.is_delta ? static_cast<std::size_t>(message.edits().removed_size()) : held == nullptr ? 0 : held->size();
  frame.added = frame.is_delta ? static_cast<std::size_t>(message.edits().added_size()) : points->size();
  frame.resized = static_cast<std::size_t>(message.edits().resized_size());
  frame.points = held = std::make_shared<const Points>(*std::move(points));
  held_frame.digest = message.digest();
  frame.encoded_bytes = encoded_bytes(message.points()) + (frame.is_delta ? message.edits().ByteSizeLong() : 0);
  frame.decode_seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return frame;
}

}  // namespace

struct ViewStream::State {
  State(std::unique_ptr<ViewCall> view_call, std::stop_token stop_token, const ViewStreamOptions& options)
      : call(std::move(view_call)),
        stop(std::move(stop_token)),
        first_bytes(options.first_bytes),
        held(options.held.points != nullptr ? options.held : HeldFrame()),
        reader([this] { read_frames(); }) {}

  ~State() {
    {
      const MutexLock lock(mutex);
      closing = true;
    }
    changed.notify_all();
    call->cancel();
    reader.join();
  }

  void read_frames() {
    v1::StreamViewsResponse response;
    while (call->read(&response)) {
      {
        const MutexLock lock(mutex);
        while (!closing && queue.size() >= kMaxQueuedFrames) changed.wait(mutex);
        if (!closing) queue.push_back(std::move(*response.mutable_frame()));
      }
      changed.notify_all();
      response.Clear();
    }
    absl::Status status = call->finish();
    if (stop.stop_requested()) status = absl::CancelledError("cancelled");
    const MutexLock lock(mutex);
    ended = std::move(status);
    changed.notify_all();
  }

  bool write(const v1::StreamViewsRequest& request) {
    const MutexLock lock(write_mutex);
    return writing && call->write(request);
  }

  /// What the view of a frame asked for; sets its digest to none where that is forgotten.
  v1::SampleRequest sample_of(std::uint64_t sequence, std::uint64_t& digest) {
    const MutexLock lock(write_mutex);
    while (!sent.empty() && sent.front().sequence() < sequence) sent.pop_front();
    if (!sent.empty() && sent.front().sequence() == sequence) return sent.front().sample();
    digest = 0;
    return {};
  }

  std::unique_ptr<ViewCall> call;
  std::stop_token stop;
  const std::uint64_t first_bytes;
  Mutex write_mutex;  // gRPC takes one write at a time
  std::uint64_t last_sequence ABSL_GUARDED_BY(write_mutex) = 0;
  bool writing ABSL_GUARDED_BY(write_mutex) = true;              // until close()
  std::deque<v1::ViewUpdate> sent ABSL_GUARDED_BY(write_mutex);  // the newest views

  Mutex decode_mutex;                            // taken first: frames are taken in in their order
  HeldFrame held ABSL_GUARDED_BY(decode_mutex);  // no points after one that could not be

  Mutex mutex;
  CondVar changed;
  std::deque<v1::PointFrame> queue ABSL_GUARDED_BY(mutex);
  std::optional<absl::Status> ended ABSL_GUARDED_BY(mutex);
  bool closing ABSL_GUARDED_BY(mutex) = false;

  std::thread reader;  // last: it uses all of the above
};

ViewStream::ViewStream(std::unique_ptr<State> state) : state_(std::move(state)) {}
ViewStream::~ViewStream() = default;

std::unique_ptr<ViewStream> ViewStream::open(Connection& connection, const std::string& session_id, std::stop_token stop,
                                             const ViewStreamOptions& options) {
  v1::StreamViewsRequest request;
  request.mutable_open()->set_session_id(session_id);
  request.mutable_open()->set_accept_deltas(options.deltas);
  if (options.held.points != nullptr) {
    v1::HeldPoints& held = *request.mutable_open()->mutable_held();
    *held.mutable_sample() = options.held.sample;
    held.set_points(options.held.points->size());
    held.set_digest(options.held.digest);
  }
  std::unique_ptr<ViewCall> call = connection.stream_views(request.open(), stop);
  auto state = std::make_unique<State>(std::move(call), std::move(stop), options);
  state->write(request);  // a failure shows in the stream's status
  return std::unique_ptr<ViewStream>(new ViewStream(std::move(state)));
}

absl::StatusOr<std::uint64_t> ViewStream::send_view(const v1::SampleRequest& sample, bool key_frame, std::uint64_t sequence) {
  v1::StreamViewsRequest request;
  *request.mutable_view()->mutable_sample() = sample;
  request.mutable_view()->set_key_frame(key_frame);
  request.mutable_view()->set_first_bytes(state_->first_bytes);
  {
    const MutexLock lock(state_->write_mutex);
    if (!state_->writing) return absl::FailedPreconditionError("the stream is closed");
    if (sequence == 0) sequence = state_->last_sequence + 1;
    if (sequence <= state_->last_sequence) {
      return absl::InvalidArgumentError(absl::StrCat("view ", sequence, " after view ", state_->last_sequence));
    }
    state_->last_sequence = sequence;
    request.mutable_view()->set_sequence(sequence);
    state_->sent.push_back(request.view());
    if (state_->sent.size() > kMostRemembered) state_->sent.pop_front();
    if (state_->call->write(request)) return request.view().sequence();
  }
  const MutexLock lock(state_->mutex);
  while (!state_->ended) state_->changed.wait(state_->mutex);
  return state_->ended->ok() ? absl::AbortedError("the server has ended the stream") : *state_->ended;
}

absl::StatusOr<Frame> ViewStream::next_frame(std::chrono::milliseconds timeout) {
  const MutexLock decoding(state_->decode_mutex);
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  v1::PointFrame message;
  {
    const MutexLock lock(state_->mutex);
    bool in_time = true;
    while (state_->queue.empty() && !state_->ended && in_time) in_time = state_->changed.wait_until(state_->mutex, deadline);
    if (state_->queue.empty() && !state_->ended) {
      return absl::DeadlineExceededError(absl::StrCat("no frame within ", timeout.count(), " ms"));
    }
    if (state_->queue.empty()) {
      return state_->ended->ok() ? absl::AbortedError("the server has ended the stream") : *state_->ended;
    }
    message = std::move(state_->queue.front());
    state_->queue.pop_front();
  }
  state_->changed.notify_all();
  const auto acknowledge = [&] {
    v1::StreamViewsRequest request;
    request.mutable_ack()->set_sequence(message.sequence());
    state_->write(request);
  };
  // The server prepares the next frame while all points are decoded; a few are decoded as soon as that is said.
  const bool is_quick = message.kind() == v1::FRAME_KIND_DELTA;
  if (!is_quick) acknowledge();
  absl::StatusOr<Frame> frame = decode_frame(message, state_->held);
  if (is_quick) acknowledge();
  if (frame.ok() && frame->error.ok()) state_->held.sample = state_->sample_of(message.sequence(), state_->held.digest);
  return frame;
}

HeldFrame ViewStream::held() const {
  const MutexLock decoding(state_->decode_mutex);
  return state_->held.digest != 0 ? state_->held : HeldFrame();
}

absl::Status ViewStream::close() {
  {
    const MutexLock lock(state_->write_mutex);
    if (std::exchange(state_->writing, false)) state_->call->writes_done();
  }
  const MutexLock lock(state_->mutex);
  while (!state_->ended) {
    state_->queue.clear();
    state_->changed.notify_all();
    state_->changed.wait(state_->mutex);
  }
  return *state_->ended;
}

}  // namespace curvecast::client
