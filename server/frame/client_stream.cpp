#include "server/frame/client_stream.h"

#include <absl/strings/str_cat.h>

#include <utility>

#include "server/base/status_from_exceptions.h"
#include "server/convert/convert.h"

namespace curvecast::server {
namespace {

constexpr std::size_t kMaxUnacknowledged = 2;
// A density that varies within a leaf may find its parts too coarse again; after so many rounds the curve is as good as it gets.
constexpr int kMaxImprovements = 8;
constexpr std::uint64_t kLeastFirstBytes = 1024;

}  // namespace

ClientStream::ClientStream(Transport* transport, Hooks hooks) : transport_(transport), hooks_(std::move(hooks)) {}

ClientStream::~ClientStream() { hooks_.count_queued(-queued_bytes_ - sending_bytes_); }

void ClientStream::receive(const v1::StreamViewsRequest& request) {
  const std::lock_guard lock(mutex_);
  if (ended_ || ending_) return;
  const auto kind = request.request_case();
  if (kind == v1::StreamViewsRequest::REQUEST_NOT_SET) {
    ending_ = absl::InvalidArgumentError("the message holds neither open, view nor ack");
  } else if (kind == v1::StreamViewsRequest::kOpen) {
    open(request.open());
  } else if (session_ == nullptr) {
    ending_ = absl::InvalidArgumentError("the first message must be open");
  } else if (kind == v1::StreamViewsRequest::kView) {
    view(request.view());
  } else {
    acknowledge(request.ack().sequence());
  }
  advance();
}

void ClientStream::half_close() {
  const std::lock_guard lock(mutex_);
  half_closed_ = true;
  if (session_ == nullptr && !ending_) ending_ = absl::InvalidArgumentError("the stream ended before open");
  advance();
}

void ClientStream::sent(bool ok) {
  const std::lock_guard lock(mutex_);
  sending_ = false;
  hooks_.count_queued(-std::exchange(sending_bytes_, 0));
  if (!ok && !ending_) ending_ = absl::CancelledError("the client has gone");
  advance();
}

void ClientStream::refined(const Session& session) {
  const std::lock_guard lock(mutex_);
  if (session_ == nullptr || session_->revisions != session.revisions) return;
  refined_ = true;
  advance();
}

void ClientStream::stop(const absl::Status& reason) {
  const std::lock_guard lock(mutex_);
  if (!ending_) ending_ = reason;
  advance();
}

void ClientStream::open(const v1::OpenView& request) {
  if (session_ != nullptr) {
    ending_ = absl::InvalidArgumentError("open was sent twice; use a stream for each session");
    return;
  }
  auto session = hooks_.find(request.session_id());
  if (!session.ok()) {
    ending_ = session.status();
    return;
  }
  session_ = *std::move(session);
  accepts_deltas_ = request.accept_deltas();
  if (!accepts_deltas_ || request.held().digest() == 0) return;
  absl::StatusOr<Sample> sample = to_sample(request.held().sample());
  if (sample.ok()) {
    claim_ = HeldClaim{*std::move(sample), request.held().points(), request.held().digest()};
  } else {
    ending_ = absl::InvalidArgumentError(absl::StrCat("open.held: ", sample.status().message()));
  }
}

void ClientStream::view(const v1::ViewUpdate& update) {
  if (last_view_ && update.sequence() <= *last_view_) {
    ending_ = absl::InvalidArgumentError(
        absl::StrCat("view.sequence is ", update.sequence(), " after ", *last_view_, "; number the views upwards"));
    return;
  }
  last_view_ = update.sequence();
  wants_key_ = wants_key_ || update.key_frame();
  pending_ = View{update.sequence(), to_sample(update.sample()), update.first_bytes()};
  if (update.first_bytes() > 0 && update.first_bytes() < kLeastFirstBytes) {
    pending_->sample = absl::InvalidArgumentError(
        absl::StrCat("view.first_bytes is ", update.first_bytes(), "; it must be at least ", kLeastFirstBytes));
  }
  coarse_.reset();
}

void ClientStream::acknowledge(std::uint64_t sequence) {
  // Taken at its word, an acknowledgement ahead of its frame would let frames pile up for a client that reads none.
  if (!last_sent_ || sequence > *last_sent_) {
    ending_ = absl::InvalidArgumentError(absl::StrCat("ack.sequence is ", sequence, ", which no frame sent so far has reached"));
    return;
  }
  // A number may have been sent twice: a frame that is still to be sent is not meant.
  while (unacknowledged_.size() > outbox_.size() && unacknowledged_.front().sequence <= sequence) {
    const Unacknowledged& frame = unacknowledged_.front();
    if (frame.automatic) pace_.observe(*frame.automatic, frame.points, Clock::now() - frame.started);
    unacknowledged_.pop_front();
  }
}

bool ClientStream::is_due() const {
  const bool may_send = unacknowledged_.size() < kMaxUnacknowledged;
  if (pending_) return may_send || half_closed_;
  return coarse_ && refined_ && may_send && !half_closed_;
}

void ClientStream::ask_for_worker() {
  const absl::Status accepted = hooks_.submit([self = shared_from_this()] { self->work(); });
  if (accepted.ok()) {
    computing_ = true;
  } else if (pending_) {
    queue_frame(*std::exchange(pending_, std::nullopt), accepted);
  } else {
    coarse_.reset();
  }
}

ClientStream::View ClientStream::take_due() {
  std::optional<View>& due = pending_ ? pending_ : coarse_;
  if (!pending_) ++due->improvements;
  View view = *std::move(due);
  due.reset();
  return view;
}

void ClientStream::work() {
  std::unique_lock lock(mutex_);
  if (!ending_ && is_due()) {
    View view = take_due();
    refined_ = false;
    view.started = Clock::now();
    absl::StatusOr<Answer> made = absl::UnknownError("");
    if (!view.sample.ok()) {
      made = view.sample.status();
    } else {
      if (view.sample->automatic) view.sample->options.points = pace_.points(*view.sample->automatic);
      if (wants_key_) claim_.reset();
      // No frame is queued before this one is settled, unless with an error.
      const auto held = wants_key_ ? nullptr : held_;
      const auto claim = claim_;
      const auto session = session_;
      lock.unlock();
      made = status_from_exceptions([&] { return answer(session, view, held, claim); });
      lock.lock();
    }
    settle(std::move(view), std::move(made));
  }
  computing_ = false;
  advance();
}

absl::StatusOr<Answer> ClientStream::answer(const std::shared_ptr<const Session>& session, const View& view,
                                            std::shared_ptr<const HeldPoints> held, const std::optional<HeldClaim>& claim) const {
  if (claim) {
    absl::StatusOr<std::shared_ptr<const HeldPoints>> restored = hooks_.restore(*session, *claim);
    if (restored.ok()) held = *std::move(restored);  // else the client gets a key frame
  }
  return hooks_.answer(session, {.sample = *view.sample,
                                 .held = held.get(),
                                 .first_bytes = accepts_deltas_ ? view.first_bytes : 0,
                                 .may_refine = view.improvements < kMaxImprovements,
                                 .cancel = &cancel_});
}

void ClientStream::settle(View view, absl::StatusOr<Answer> answer) {
  const bool is_again = view.improvements > 0;
  const bool is_part = answer.ok() && answer->is_part;
  const bool is_coarse = answer.ok() && answer->frame.statistics().refining();
  const std::uint64_t revision = answer.ok() ? answer->frame.curve_revision() : 0;
  const std::uint64_t points = answer.ok() ? answer->frame.held_points() : 0;
  // The client has points for this view: only better ones are news, or more, or that there will be none.
  const bool is_better = revision > coarse_revision_ || points > coarse_points_ || !is_coarse;
  const bool is_news = !is_again || is_part || (answer.ok() && is_better);
  if (is_again && view.sequence != last_view_) return;  // overtaken meanwhile
  if (is_coarse && view.sequence == last_view_) {
    coarse_revision_ = revision;
    coarse_points_ = points;
    coarse_ = view;
    refined_ = refined_ || is_part;  // the next part waits for nothing
  }
  if (is_news) queue_frame(view, std::move(answer));
}

void ClientStream::queue_frame(const View& view, absl::StatusOr<Answer> answer) {
  if (ending_) return;
  v1::StreamViewsResponse response;
  Unacknowledged& frame = unacknowledged_.emplace_back(Unacknowledged{view.sequence});
  if (answer.ok()) {
    if (!answer->is_part) frame.automatic = view.sample->automatic;
    frame.points = view.sample->options.points;
    frame.started = view.started;
    *response.mutable_frame() = std::move(answer->frame);
    if (accepts_deltas_) held_ = std::move(answer->held);
    if (response.frame().kind() == v1::FRAME_KIND_KEY) wants_key_ = false;
    claim_.reset();
  } else {
    *response.mutable_frame()->mutable_error() = to_proto(answer.status());
  }
  response.mutable_frame()->set_sequence(view.sequence);
  const auto bytes = static_cast<std::int64_t>(response.ByteSizeLong());
  queued_bytes_ += bytes;
  hooks_.count_queued(bytes);
  outbox_.push_back(std::move(response));
}

void ClientStream::advance() {
  if (ended_) return;
  // A view that is refused needs no worker.
  if (!ending_ && !computing_ && is_due() && pending_ && !pending_->sample.ok()) {
    const View refused = *std::exchange(pending_, std::nullopt);
    queue_frame(refused, refused.sample.status());
  }
  if (!ending_ && !computing_ && is_due()) ask_for_worker();
  if (!ending_ && half_closed_ && !computing_ && outbox_.empty() && !sending_) ending_ = absl::OkStatus();
  if (ending_) {
    cancel_ = true;
    pending_.reset();
    coarse_.reset();
    outbox_.clear();
    hooks_.count_queued(-std::exchange(queued_bytes_, 0));
    if (sending_) return;
    ended_ = true;
    session_.reset();
    held_.reset();
    transport_->end(*ending_);
    return;
  }
  if (!sending_ && !outbox_.empty()) {
    sending_ = true;
    last_sent_ = outbox_.front().frame().sequence();
    sending_bytes_ = static_cast<std::int64_t>(outbox_.front().ByteSizeLong());
    queued_bytes_ -= sending_bytes_;
    transport_->send(std::move(outbox_.front()));
    outbox_.pop_front();
  }
}

}  // namespace curvecast::server
