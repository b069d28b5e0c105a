// Which sessions are held: whose they are, which are pinned, and which go when there are too many.
#pragma once

#include <absl/status/status.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "server/session/eviction.h"
#include "server/session/session.h"

namespace curvecast::server {

struct SessionJob;

/// Not thread-safe. Sessions that leave the table are handed out, so that they can be destroyed after a lock: curves take their
/// time to go. References to sessions must only be taken from the table by those who have exclusive use of it: a session to which
/// there is no other reference counts as idle.
class SessionTable {
 public:
  using Clock = std::chrono::steady_clock;
  using Sessions = std::vector<std::shared_ptr<const Session>>;

  struct Entry {
    SessionInfo info;                        // its state is as of info_of()
    std::shared_ptr<SessionJob> job;         // what makes the session; null when it is ready
    std::shared_ptr<const Session> preview;  // a stand-in, for as long as there is a job
    std::string owner;                       // who had it made here; empty: nobody in particular
    std::uint64_t last_used = 0;             // greater: later
    Clock::time_point used_at = {};

    bool is_idle() const { return job == nullptr && info.session.use_count() == 1; }
  };

  /// `is_unsaved`: whether a session still waits to be saved; such sessions leave the table only where there is no other way.
  /// Empty: none does.
  explicit SessionTable(const SessionLimits& limits, std::function<bool(const std::string& id)> is_unsaved = {})
      : limits_(limits), is_unsaved_(std::move(is_unsaved)) {}

  /// Null where there is no such session.
  Entry* find(const std::string& id);
  /// As find(), and the session counts as used now.
  Entry* use(const std::string& id);
  /// Adds a session by its info.id, used now. Precondition: it is not there, and make_room().
  void insert(Entry entry);
  /// Takes a session out. Precondition: it is there.
  Entry take(const std::string& id);

  /// Evicts as many idle sessions as it takes until one more fits. ResourceExhausted where too many are in use, pinned or being
  /// made; none goes then.
  absl::Status make_room(Sessions& evicted);
  /// Evicts idle sessions as long as those that have grown are too much together.
  Sessions evict_excess();
  /// Evicts idle sessions until they have freed so many bytes, or there are none left.
  Sessions evict_bytes(std::uint64_t bytes);
  /// ResourceExhausted where as many sessions are being made for the caller as may be at once.
  absl::Status may_make(const std::string& caller) const;
  /// ResourceExhausted where pinned sessions would take more than half of the limits with this one.
  absl::Status may_pin(const Session& session) const;
  /// Takes out the sessions that nobody has used for their time to live, once they are saved.
  Sessions take_unused(Clock::time_point now);
  /// Ids of the sessions that are in use, or were since then.
  std::vector<std::string> used_since(Clock::time_point then) const;

  /// By id, at most `most` of those after one with this id that are wanted.
  std::vector<SessionInfo> list(
      const std::string& after = {}, std::size_t most = std::numeric_limits<std::size_t>::max(),
      const std::function<bool(const Entry&)>& is_wanted = [](const Entry&) { return true; }) const;
  static SessionInfo info_of(const Entry& entry);
  /// Jobs of all sessions that are being made.
  std::vector<std::shared_ptr<SessionJob>> jobs() const;
  std::uint64_t memory_bytes() const;  // of all sessions

 private:
  Eviction choose(const SessionLimits& limits) const;
  Sessions take(const Eviction& eviction);

  bool is_unsaved(const std::string& id) const { return is_unsaved_ && is_unsaved_(id); }

  const SessionLimits limits_;
  const std::function<bool(const std::string& id)> is_unsaved_;
  std::map<std::string, Entry> entries_;
  std::uint64_t clock_ = 0;  // counts uses
};

}  // namespace curvecast::server
