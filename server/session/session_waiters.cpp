#include "server/session/session_waiters.h"

#include <algorithm>
#include <utility>

namespace curvecast::server {
namespace {

constexpr auto kReportInterval = std::chrono::milliseconds(50);

}  // namespace

void SessionWaiters::add(SessionWaiter* waiter) {
  const MutexLock lock(mutex_);
  auto recipient = std::make_shared<Recipient>(Recipient{.waiter = waiter});
  recipient->calls.push_back({.stage = stage_, .fraction = fraction_});
  if (preview_ != nullptr) recipient->calls.push_back({.preview = preview_});
  recipients_.push_back(std::move(recipient));
}

bool SessionWaiters::remove(SessionWaiter* waiter) {
  const MutexLock lock(mutex_);
  const auto found = std::ranges::find(recipients_, waiter, [](const auto& recipient) { return recipient->waiter; });
  if (found == recipients_.end()) return false;
  const std::shared_ptr<Recipient> recipient = *found;
  recipients_.erase(found);
  while (recipient->is_being_called) call_over_.wait(mutex_);
  return true;
}

bool SessionWaiters::empty() const {
  const MutexLock lock(mutex_);
  return recipients_.empty();
}

bool SessionWaiters::want_preview() const {
  const MutexLock lock(mutex_);
  return std::ranges::any_of(recipients_, [](const auto& recipient) { return recipient->waiter->wants_preview(); });
}

void SessionWaiters::progress(std::string_view stage, double fraction) {
  const MutexLock lock(mutex_);
  if (is_finished_) return;
  if (stage != stage_) {
    if (fraction_ < 1) broadcast(std::string(stage_), 1);
    broadcast(stage, fraction);
  } else if ((fraction >= 1 && fraction_ < 1) || Clock::now() - told_at_ >= kReportInterval) {
    broadcast(stage, fraction);
  }
}

void SessionWaiters::preview(std::shared_ptr<const Session> preview) {
  const MutexLock lock(mutex_);
  if (is_finished_) return;
  preview_ = std::move(preview);
  for (const auto& recipient : recipients_) recipient->calls.push_back({.preview = preview_});
}

void SessionWaiters::finish(const Result& result) {
  const MutexLock lock(mutex_);
  if (is_finished_) return;
  if (result.ok() && fraction_ < 1) broadcast(std::string(stage_), 1);
  is_finished_ = true;
  preview_ = nullptr;
  for (const auto& recipient : recipients_) recipient->calls.push_back({.result = result});
}

void SessionWaiters::broadcast(std::string_view stage, double fraction) {
  stage_ = stage;
  fraction_ = std::clamp(fraction, 0.0, 1.0);
  told_at_ = Clock::now();
  for (const auto& recipient : recipients_) recipient->calls.push_back({.stage = stage_, .fraction = fraction_});
}

void SessionWaiters::deliver() {
  const auto can_be_called = [](const auto& recipient) { return !recipient->is_being_called && !recipient->calls.empty(); };
  MutexLock lock(mutex_);
  while (true) {
    const auto next = std::ranges::find_if(recipients_, can_be_called);
    if (next == recipients_.end()) return;
    const std::shared_ptr<Recipient> recipient = *next;
    Call call = std::move(recipient->calls.front());
    recipient->calls.pop_front();
    recipient->is_being_called = true;
    if (call.result) recipients_.erase(next);
    lock.unlock();
    if (call.result) {
      // Moved, for a session that somebody else refers to is not idle. The waiter may be gone when this returns.
      recipient->waiter->on_done(*std::move(call.result));
    } else if (call.preview != nullptr) {
      recipient->waiter->on_preview(call.preview);
    } else {
      recipient->waiter->on_progress(call.stage, call.fraction);
    }
    lock.lock();
    recipient->is_being_called = false;
    call_over_.notify_all();
  }
}

}  // namespace curvecast::server
