// Marks of sessions that are being made, so that one whose making ends the process is not made again and again.
#pragma once

#include <absl/status/status.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <map>
#include <string>

#include "core/base/mutex.h"

namespace curvecast::server {

/// Keeps a file ID.making in a folder for each session that is being made, locked. Where one is there that nobody holds, the
/// process that made the session has ended in the middle: the session is refused for a while, by all servers of the folder, four
/// times as long after each time. Thread-safe.
class MakingMarks {
 public:
  static constexpr std::chrono::seconds kMostPause{3600};

  /// `folder` is there. Removes old marks of others that nobody waits for any more.
  MakingMarks(std::string folder, std::chrono::seconds first_pause);
  /// forgive()
  ~MakingMarks();
  MakingMarks(const MakingMarks&) = delete;
  MakingMarks& operator=(const MakingMarks&) = delete;

  /// Marks a session as being made. Precondition: it is not, here. ResourceExhausted where the making has ended a process of
  /// late; not before enforce(). Where the mark cannot be written the session is made all the same.
  absl::Status begin(const std::string& id) ABSL_LOCKS_EXCLUDED(mutex_);
  /// It is over, however it ended.
  void end(const std::string& id) ABSL_LOCKS_EXCLUDED(mutex_);

  /// From now on begin() refuses. Before that, a server makes what it was started for.
  void enforce() { is_enforced_ = true; }
  /// The process ends because somebody wants it to: no session is to blame.
  void forgive() ABSL_LOCKS_EXCLUDED(mutex_);
  /// Tells the marks the time, so that they know when the process ended. To be called every second or so.
  void touch() ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  std::string path_of(const std::string& id) const;

  const std::string folder_;
  const std::chrono::seconds first_pause_;
  std::atomic<bool> is_enforced_ = false;
  Mutex mutex_;
  std::map<std::string, int> files_ ABSL_GUARDED_BY(mutex_);  // descriptors by session; they hold the locks
};

}  // namespace curvecast::server
