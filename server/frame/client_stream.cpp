#include "server/frame/client_stream.h"

#include <absl/strings/str_cat.h>

#include <algorithm>
#include <utility>

#include "core/sample/point_set.h"
#include "server/base/protocol.h"
#include "server/base/status_from_exceptions.h"
#include "server/convert/convert.h"

namespace curvecast::server {
namespace {

// A density that varies within a leaf may find its parts too coarse again; after so many rounds the curve is as good as it gets.
constexpr int kMaxImprovements = 8;
// Work for other clients makes a view's answer anew too, which may bring it nothing.
constexpr int kMaxInVain = 8;
// What an answer may take of the processors once a newer view has come.
constexpr WorkLimit::Nanoseconds kMostOutdatedWork = std::chrono::milliseconds(100);
// What a point takes of the processors, about.
constexpr std::chrono::nanoseconds kWorkOfPoint(60);

ViewEvent event_of(FollowUp follow_up) {
  switch (follow_up) {
    case FollowUp::kNone:
      return ViewEvent::kFinal;
    case FollowUp::kNextPart:
      return ViewEvent::kPart;
    case FollowUp::kAfterImprovement:
      return ViewEvent::kPromised;
  }
  return ViewEvent::kFinal;
}

}  // namespace

bool ClientStream::View::may_refine() const { return improvements + (shown ? 1 : 0) < kMaxImprovements && in_vain < kMaxInVain; }

ClientStream::ClientStream(Transport* transport, Hooks hooks)
    : transport_(transport), hooks_(std::move(hooks)), window_(hooks_.count_queued) {}

// ------------------------------------------------------------------------------------------------------------ events

void ClientStream::receive(const v1::StreamViewsRequest& request) {
  const MutexLock lock(mutex_);
  if (is_over()) return;
  const auto kind = request.request_case();
  if (kind == v1::StreamViewsRequest::REQUEST_NOT_SET) {
    fail(absl::InvalidArgumentError("the message holds neither open, view nor ack"));
  } else if (kind == v1::StreamViewsRequest::kOpen) {
    receive_open(request.open());
  } else if (link_ == LinkState::kUnopened) {
    fail(absl::InvalidArgumentError("the first message must be open"));
  } else if (kind == v1::StreamViewsRequest::kView) {
    receive_view(request.view());
  } else {
    receive_ack(request.ack().sequence());
  }
  dispatch();
}

void ClientStream::half_close() {
  const MutexLock lock(mutex_);
  change_link(LinkEvent::kHalfClosed, absl::InvalidArgumentError("the stream ended before open"));
  dispatch();
}

void ClientStream::sent(bool ok) {
  const MutexLock lock(mutex_);
  window_.end_send();
  if (!ok) fail(absl::CancelledError("the client has gone"));
  dispatch();
}

void ClientStream::refined(const Session& session) {
  const MutexLock lock(mutex_);
  if (session_ == nullptr || session_->revisions != session.revisions) return;
  view_state_ = next(view_state_, ViewEvent::kImproved);
  dispatch();
}

void ClientStream::replace(const Session& preview, const absl::StatusOr<std::shared_ptr<const Session>>& real) {
  const MutexLock lock(mutex_);
  if (session_ == nullptr || session_->revisions != preview.revisions) return;
  if (real.ok()) {
    session_ = *real;
    reference_.reset();
    claim_.reset();
    wants_key_ = true;
    if (view_) answer_anew(*std::exchange(view_, std::nullopt));
  } else {
    fail(real.status());
  }
  dispatch();
}

void ClientStream::retry() {
  const MutexLock lock(mutex_);
  if (claim_ && view_ && Clock::now() >= claimed_ + hooks_.patience) view_state_ = next(view_state_, ViewEvent::kImproved);
  dispatch();
}

void ClientStream::retire(const absl::Status& reason) {
  const MutexLock lock(mutex_);
  retired_ = reason;
  dispatch();
}

void ClientStream::stop(const absl::Status& reason) {
  const MutexLock lock(mutex_);
  fail(reason);
  dispatch();
}

void ClientStream::receive_open(const v1::OpenView& request) {
  if (link_ != LinkState::kUnopened) {
    return fail(absl::InvalidArgumentError("open was sent twice; use a stream for each session"));
  }
  auto session = hooks_.find(request.session_id());
  if (!session.ok()) return fail(session.status());
  session_ = *std::move(session);
  accepts_deltas_ = request.accept_deltas();
  change_link(LinkEvent::kOpened);
  if (!accepts_deltas_ || request.held().digest() == 0) return;
  absl::StatusOr<PointSetRequest> held = to_streamed_request(request.held().sample());
  if (!held.ok()) return fail(absl::InvalidArgumentError(absl::StrCat("open.held: ", held.status().message())));
  claim_ = ResumeClaim{*std::move(held), request.held().points(), request.held().digest()};
  claimed_ = Clock::now();
}

void ClientStream::receive_view(const v1::ViewUpdate& update) {
  if (newest_sequence_ && update.sequence() <= *newest_sequence_) {
    return fail(absl::InvalidArgumentError(
        absl::StrCat("view.sequence is ", update.sequence(), " after ", *newest_sequence_, "; number the views upwards")));
  }
  newest_sequence_ = update.sequence();
  hurry_answer();
  wants_key_ = wants_key_ || update.key_frame();
  view_ = View{update.sequence(), to_streamed_request(update.sample()), update.first_bytes()};
  if (update.first_bytes() > 0 && update.first_bytes() < kMinBudgetBytes) {
    view_->request = absl::InvalidArgumentError(
        absl::StrCat("view.first_bytes is ", update.first_bytes(), "; it must be at least ", kMinBudgetBytes));
  }
  view_state_ = next(view_state_, ViewEvent::kArrived);
}

void ClientStream::hurry_answer() {
  const bool is_answering = view_state_ == ViewState::kAnswering || view_state_ == ViewState::kOutdated;
  // Of two answers in a row one is finished: somebody who moves on all the time is to see something.
  if (!is_answering || was_given_up_) return;
  work_->spend(kMostViewWork - kMostOutdatedWork);
  is_hurried_ = true;
}

void ClientStream::receive_ack(std::uint64_t sequence) {
  const bool is_sent = window_.acknowledge(sequence, [this](const SendWindow::Frame& frame) {
    mutex_.assert_held();
    if (frame.automatic) pace_.observe(*frame.automatic, frame.points, Clock::now() - frame.started);
  });
  if (!is_sent) {
    fail(absl::InvalidArgumentError(absl::StrCat("ack.sequence is ", sequence, ", which no frame sent so far has reached")));
  }
}

// ----------------------------------------------------------------------------------------------------------- actions

void ClientStream::fail(absl::Status reason) { change_link(LinkEvent::kFailed, std::move(reason)); }

void ClientStream::change_link(LinkEvent event, absl::Status reason) {
  const bool was_over = is_over();
  link_ = next(link_, event);
  if (was_over || !is_over()) return;
  end_status_ = std::move(reason);
  cancel_ = true;
  view_.reset();
}

void ClientStream::dispatch() {
  if (retired_ && !has_worker_ && !window_.has_queued()) fail(*retired_);
  if (is_over()) return end_when_idle();
  if (!has_worker_ && is_due() && !retired_) {
    if (view_state_ == ViewState::kWaiting && !view_->request.ok()) {
      refuse_waiting_view(view_->request.status());  // needs no worker
    } else {
      ask_for_worker();
    }
  }
  if (!window_.is_sending() && window_.has_queued()) {
    transport_->send(window_.begin_send());
  } else if (link_ == LinkState::kHalfClosed && !has_worker_ && !window_.is_sending()) {
    change_link(LinkEvent::kDrained);
    end_when_idle();
  }
}

void ClientStream::end_when_idle() {
  window_.clear();
  if (link_ == LinkState::kEnded || window_.is_sending()) return;
  change_link(LinkEvent::kIdle);
  session_.reset();
  reference_.reset();
  transport_->end(end_status_);
}

std::chrono::nanoseconds ClientStream::expected_work() const {
  if (!view_ || !view_->request.ok()) return {};
  const PointSetRequest& request = *view_->request;
  const std::uint64_t points = request.automatic ? pace_.points(*request.automatic) : request.options.points;
  if (points == 0) return last_work_;  // a budget of bytes or pixels
  // Anything may be asked for; more points than there may be are refused later.
  return std::min<std::chrono::nanoseconds>(static_cast<std::int64_t>(std::min(points, kMaxPoints)) * kWorkOfPoint,
                                            kMostViewWork);
}

void ClientStream::ask_for_worker() {
  absl::Status accepted = hooks_.has_room();
  if (accepted.ok()) accepted = hooks_.submit([self = shared_from_this()] { self->run_worker(); }, expected_work());
  has_worker_ = accepted.ok();
  // A better frame is asked for again with the next event or retry(): its promise stands.
  if (!accepted.ok() && view_state_ == ViewState::kWaiting) refuse_waiting_view(accepted);
}

void ClientStream::run_worker() {
  MutexLock lock(mutex_);
  const absl::Status room = hooks_.has_room();  // for all who asked for workers when there was
  if (is_due() && !room.ok()) {
    if (view_state_ == ViewState::kWaiting) refuse_waiting_view(room);
  } else if (is_due()) {
    View view = begin_answer();
    absl::StatusOr<Answer> made = absl::UnknownError("");
    const auto session = session_;
    if (!view.request.ok()) {
      made = view.request.status();
    } else {
      if (view.request->automatic) view.request->options.points = pace_.points(*view.request->automatic);
      if (wants_key_) claim_.reset();
      // No frame is queued before this one, unless with an error.
      auto claim = claim_;
      auto reference = wants_key_ ? nullptr : reference_;
      const std::uint64_t first_bytes = accepts_deltas_ ? view.first_bytes : 0;
      const ExecutionContext context{.cancel = &cancel_, .limit = &*work_};
      lock.unlock();
      made = status_from_exceptions([&]() -> absl::StatusOr<Answer> {
        if (claim) {
          absl::StatusOr<std::shared_ptr<const ReferenceFrame>> restored = hooks_.restore(*session, *claim, context);
          if (restored.ok()) reference = *std::move(restored);  // else the client gets a key frame
        }
        return hooks_.answer(session, {.point_set = *view.request,
                                       .reference = reference.get(),
                                       .first_bytes = first_bytes,
                                       .may_refine = view.may_refine(),
                                       .context = context});
      });
      lock.lock();
    }
    if (session_ == session || is_over()) {
      finish_answer(std::move(view), std::move(made));
    } else {
      answer_anew(std::move(view));  // another session has come meanwhile
    }
  }
  has_worker_ = false;
  dispatch();
}

void ClientStream::answer_anew(View view) {
  if (view_state_ == ViewState::kWaiting && view_) return;  // a newer one waits
  view.shown.reset();
  view.improvements = view.in_vain = 0;
  view_ = std::move(view);
  view_state_ = next(view_state_, ViewEvent::kArrived);
}

ClientStream::View ClientStream::begin_answer() {
  View view = *std::exchange(view_, std::nullopt);
  view_state_ = next(view_state_, ViewEvent::kTaken);
  view.started = Clock::now();
  work_.emplace(kMostViewWork);
  is_hurried_ = false;
  return view;
}

void ClientStream::finish_answer(View view, absl::StatusOr<Answer> answer) {
  last_work_ = Clock::now() - view.started;
  if (is_over()) return;
  if (absl::IsDataLoss(answer.status())) return fail(answer.status());
  const bool is_overtaken = view_state_ == ViewState::kWaiting;
  was_given_up_ = is_hurried_ && absl::IsDeadlineExceeded(answer.status());
  if (is_overtaken && (view.shown || was_given_up_)) return;
  Progress progress;
  FollowUp follow_up = FollowUp::kNone;
  if (answer.ok()) {
    progress = {answer->frame.curve_revision(), answer->frame.held_points(), answer->frame.digest()};
    follow_up = answer->follow_up;
  }
  if (answer.ok() && follow_up == FollowUp::kNone && session_->is_preview) {
    answer->follow_up = follow_up = FollowUp::kAfterImprovement;  // the real session follows
  }
  if (answer.ok() && keeps_claimed(view, *answer)) {
    view_state_ = next(view_state_, event_of(follow_up));
    if (!is_overtaken) view_ = std::move(view);
    return;
  }
  const bool has_progress = !view.shown || view.shown->is_surpassed_by(progress);
  if (!has_progress && !view.is_in_parts) ++view.in_vain;
  // Ranks come to an end by themselves.
  if (view.shown && progress.curve_revision > view.shown->curve_revision) ++view.improvements;
  // A part without progress is the last one, and answering the view once more would bring the same points.
  if (follow_up == FollowUp::kNextPart && !has_progress) answer->follow_up = follow_up = FollowUp::kNone;
  view_state_ = next(view_state_, event_of(follow_up));
  // Without progress only the word that no better frame follows is news, or why.
  if (has_progress || follow_up == FollowUp::kNone) queue_frame(view, std::move(answer));
  if (follow_up == FollowUp::kNone || is_overtaken) return;
  if (has_progress) view.shown = progress;
  view.is_in_parts = follow_up == FollowUp::kNextPart;
  view_ = std::move(view);
}

bool ClientStream::keeps_claimed(const View& view, const Answer& answer) const {
  return claim_ && claim_->point_set.fingerprint == view.request->fingerprint && claim_->points > answer.frame.held_points() &&
         answer.follow_up == FollowUp::kAfterImprovement && Clock::now() < claimed_ + hooks_.patience;
}

void ClientStream::refuse_waiting_view(const absl::Status& reason) {
  view_state_ = next(view_state_, ViewEvent::kRefused);
  queue_frame(*std::exchange(view_, std::nullopt), reason);
}

void ClientStream::queue_frame(const View& view, absl::StatusOr<Answer> answer) {
  v1::StreamViewsResponse response;
  v1::PointFrame& frame = *response.mutable_frame();
  SendWindow::Frame queued{.sequence = view.sequence, .automatic = {}, .points = 0, .started = view.started};
  if (answer.ok()) {
    frame = std::move(answer->frame);
    frame.mutable_statistics()->set_refining(is_better_frame_due(link_, view_state_));
    queued.points = view.request->options.points;
    if (answer->follow_up != FollowUp::kNextPart) queued.automatic = view.request->automatic;
    if (accepts_deltas_) reference_ = std::move(answer->reference);
    if (frame.kind() == v1::FRAME_KIND_KEY) wants_key_ = false;
    claim_.reset();
  } else {
    *frame.mutable_error() = to_proto(answer.status());
  }
  frame.set_sequence(view.sequence);
  window_.push(queued, std::move(response));
}

}  // namespace curvecast::server
