// The folder in which sessions survive the server: for each a file with the first revision of its curve and what the session is,
// one with what refining the curve starts from, one with the points that first views show, and where the curve was refined, one
// with the newest revision.
#pragma once

#include <absl/status/statusor.h>

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "core/base/mutex.h"
#include "server/base/job_queue.h"
#include "server/session/session.h"

namespace spdlog {
class logger;
}

namespace curvecast::server {

/// Thread-safe. Several processes may share a folder: files appear and go whole, and nobody touches what another one is writing.
/// Files of other versions of the format have other names, and those of other versions of the algorithm belong to other sessions:
/// they are left alone until they are the least recently used.
class SessionCache {
 public:
  /// Makes the folder if it is missing (mode 0700) and removes what killed processes left half-written. FailedPrecondition when
  /// the folder cannot be used.
  static absl::StatusOr<std::unique_ptr<SessionCache>> open(const std::string& folder, std::uint64_t max_bytes,
                                                            std::shared_ptr<spdlog::logger> log);
  ~SessionCache();  // stop()

  /// Saves the session as it is now in the background, replacing what was saved of it before; then its surface is taken from the
  /// file, and what it took in memory is free. When it cannot, because the disk is full or too many saves wait, the log says so
  /// (once until it works again), and the session is just not cached.
  void save(const Session& session);
  /// Whether there is a file from which a session can be loaded, unless it turns out to be damaged. Takes microseconds.
  bool holds(const std::string& id) const;
  /// Loads a session. NotFound when there is none; DataLoss, FailedPrecondition and so on for files that cannot be used. The log
  /// says why, and they are removed.
  absl::StatusOr<std::shared_ptr<const Session>> load(const std::string& id);
  /// Opens the surface on which a session's curve lies, see open_surface(). Errors as of load(). Where a chart turns out to be
  /// damaged later, the session's files are removed.
  absl::StatusOr<std::shared_ptr<const CurveBase>> open_surface(const std::string& id);
  /// Who had a session made first, as its file says. NotFound when there is none that can be used; other errors where nobody can
  /// tell now.
  absl::StatusOr<std::string> owner(const std::string& id) const;
  /// Counts a session as used now: the least recently used go first when there is no room.
  void touch(const std::string& id) const;
  /// Removes a session's files, also those still to be saved, and marks it as closed for a day: no server that has it in memory
  /// writes it back. False when there were none.
  bool remove(const std::string& id);
  /// Waits until a save is over that was under way when the session was removed: only then all its files are gone.
  void wait_until_removed(const std::string& id);
  /// Whether some server has removed the session, and nobody has asked for it since.
  bool is_closed(const std::string& id) const;
  /// Lets a session be saved that was removed before: somebody asks for it anew.
  void reopen(const std::string& id) const;
  /// Bytes of all files of sessions in the folder, whichever process wrote them. Looks at each.
  std::uint64_t used_bytes() const;

  const std::string& folder() const { return folder_; }
  /// The queue on which those load who must not wait. Apart from the one that saves, which waits for the disk.
  JobQueue& loading() { return loading_; }
  /// Finishes the loads and saves that have been accepted, and refuses later ones.
  void stop();

 private:
  /// What is saved of a session: shares its arrays, but does not keep it from being evicted.
  struct Snapshot {
    std::shared_ptr<const SurfaceCurve> first, newest;  // revisions of the curve; may be the same
    std::shared_ptr<SessionSurface> surface;
    std::shared_ptr<RankedCandidates> candidates;
    std::string record;  // what the session is besides
  };

  SessionCache(std::string folder, std::uint64_t max_bytes, std::shared_ptr<spdlog::logger> log);
  std::string curve_path(const std::string& id) const;
  std::string refined_path(const std::string& id) const;
  std::string surface_path(const std::string& id) const;
  std::string ranks_path(const std::string& id) const;
  std::string closed_path(const std::string& id) const;
  /// All of these but the last.
  std::array<std::string, 4> paths(const std::string& id) const;
  /// Whether a session's files are being written, and are to be removed then.
  bool is_going(const std::string& id) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  bool remove_files(const std::string& id) const;
  /// Takes up the points that first views show, if they are there.
  void load_ranks(const Session& session);
  /// Takes up the newest revision of a session's curve, if it is there.
  void load_refined(const Session& session);
  void discard(const std::string& path, const absl::Status& reason) const;
  void discard_surface(const std::string& id, const absl::Status& reason) const;
  void move_to_file(const std::string& id, const Snapshot& snapshot);
  void save_next(const std::string& id);
  absl::Status write(const std::string& id, const Snapshot& snapshot) const;
  /// Cancelled where the session that is being saved has been removed meanwhile.
  absl::Status check_wanted(const std::string& id) const;
  void make_room() const;
  void note_failure(const std::string& id, const absl::Status& status) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const std::string folder_;
  const std::uint64_t max_bytes_;
  const std::shared_ptr<spdlog::logger> log_;
  mutable Mutex mutex_;
  CondVar saved_;
  std::map<std::string, Snapshot> pending_ ABSL_GUARDED_BY(mutex_);  // by session, the newest state of each
  std::string saving_ ABSL_GUARDED_BY(mutex_);                       // session that is being written
  bool unwanted_ ABSL_GUARDED_BY(mutex_) = false;  // saving_ has been removed meanwhile: its files go when they are written
  bool failing_ ABSL_GUARDED_BY(mutex_) = false;   // the last save failed, and the log says so
  JobQueue loading_, saving_queue_;                // last: their jobs use all of the above
};

}  // namespace curvecast::server
