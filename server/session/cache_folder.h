// What lies where in the folder in which sessions survive the server: for each a file with the first revision of its curve and
// what the session is, one with what refining the curve starts from, one with the points that first views show, one with those
// that were made for other views, and where the curve was refined, one with the newest revision. An empty file marks one that was
// closed; one with the store's URL those whose files are in a store that servers share, too.
#pragma once

#include <absl/status/statusor.h>

#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace curvecast::server {

/// Makes a folder for its owner only (mode 0700) if it is missing, those above it too, and returns its absolute path.
/// FailedPrecondition where it cannot be used.
absl::StatusOr<std::string> make_cache_folder(const std::string& folder);

/// Whether it may be a session's or a mesh's id, 32 hexadecimal digits. Nothing else may become part of a path: ids come from
/// clients.
bool is_content_id(const std::string& id);

/// Whether there is a file of that path.
bool is_file(const std::string& path);
/// Removes it, if there is one.
void remove_path(const std::string& path);

/// Counts a file as used now.
void touch_file(const std::string& path);

/// Calls visit(path) for the marks of sessions in a folder, files ID.ENDING, that nobody has touched for so long.
void visit_old_marks(const std::string& folder, std::string_view ending, std::chrono::seconds age,
                     const std::function<void(const std::string& path)>& visit);

/// Thread-safe. Several processes may share a folder.
class CacheFolder {
 public:
  /// Precondition: the folder is there.
  explicit CacheFolder(std::string folder) : folder_(std::move(folder)) {}

  const std::string& path() const { return folder_; }
  std::string curve_path(const std::string& id) const;
  std::string refined_path(const std::string& id) const;
  std::string surface_path(const std::string& id) const;
  std::string ranks_path(const std::string& id) const;
  std::string grown_path(const std::string& id) const;
  /// All of these.
  std::array<std::string, 5> paths(const std::string& id) const;
  /// Removes a session's files, also the mark of those in a store. False where there was no curve.
  bool remove_files(const std::string& id) const;

  /// Whether some server has closed the session, and nobody has asked for it since.
  bool is_closed(const std::string& id) const;
  void mark_closed(const std::string& id) const;
  void remove_mark(const std::string& id) const;
  /// Removes the marks of sessions that were closed so long ago that no server has them in memory.
  void remove_old_marks() const;

  /// Whether the session's files are in that store, as they are here.
  bool is_stored(const std::string& id, const std::string& url) const;
  void mark_stored(const std::string& id, const std::string& url) const;
  void unmark_stored(const std::string& id) const;
  /// Ids of the sessions that can be loaded and are not in that store.
  std::vector<std::string> unstored(const std::string& url) const;

  /// All files of sessions, of any version, whichever process wrote them.
  struct Contents {
    std::size_t sessions = 0;  // that can be loaded
    std::size_t foreign = 0;   // files of other versions
    std::uint64_t bytes = 0;
  };
  /// Looks at each file.
  Contents contents() const;
  /// Removes the least recently used sessions that may go as long as all take more than `max_bytes`. Returns the bytes that the
  /// others take.
  std::uint64_t make_room(std::uint64_t max_bytes, const std::function<bool(const std::string& id)>& may_go,
                          const std::function<void(const std::string& id)>& on_removed) const;

  /// How often the files of a session were removed, and how often that failed.
  std::pair<std::uint64_t, std::uint64_t> removals() const { return {removed_, not_removed_}; }

 private:
  std::string closed_path(const std::string& id) const;
  std::string stored_path(const std::string& id) const;
  template <typename Paths>
  void remove_all(const Paths& paths) const;

  const std::string folder_;
  mutable std::atomic<std::uint64_t> removed_ = 0, not_removed_ = 0;
};

}  // namespace curvecast::server
