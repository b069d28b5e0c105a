// Sets of tiles that were made of sessions' points, for viewers that come for one tile after the other.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <string>
#include <string_view>

#include "core/base/mutex.h"

namespace curvecast::server {

/// A set of tiles with all that it was made of.
struct Tileset {
  std::string session_id;
  std::string terms;                         // what the client asked for, in one spelling
  std::string digest;                        // of the points and the terms, which determine the files' bytes
  std::uint64_t revision = 0;                // of the curve, as Session.curve_revision
  bool is_final = true;                      // false: the same request may get better points later
  bool is_refining = false;                  // those are being made
  std::map<std::string, std::string> files;  // by name

  std::size_t byte_size() const;
};

/// Keeps the sets that were asked for last, up to a number of bytes; the last one in any case, so that its tiles need not be made
/// one by one. What it drops can be made again. Thread-safe.
class TilesetCache {
 public:
  explicit TilesetCache(std::uint64_t most_bytes) : most_bytes_(most_bytes) {}

  /// Returns the set of these terms that `is_wanted` and was used last, null where there is none. `is_wanted` is called with a
  /// lock.
  std::shared_ptr<const Tileset> find(std::string_view session_id, std::string_view terms,
                                      const std::function<bool(const Tileset&)>& is_wanted) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Keeps a set, instead of one with the same terms and digest.
  void keep(std::shared_ptr<const Tileset> set) ABSL_LOCKS_EXCLUDED(mutex_);
  /// Drops what was made of a session.
  void forget(std::string_view session_id) ABSL_LOCKS_EXCLUDED(mutex_);
  void clear() ABSL_LOCKS_EXCLUDED(mutex_);
  std::uint64_t byte_size() const ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  static constexpr std::size_t kMostSets = 64;
  using Sets = std::list<std::shared_ptr<const Tileset>>;

  /// Moves a set to `gone`. Returns what follows it.
  Sets::iterator drop(Sets::iterator set, Sets& gone) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const std::uint64_t most_bytes_;
  mutable Mutex mutex_;
  Sets sets_ ABSL_GUARDED_BY(mutex_);  // those used last first
  std::uint64_t bytes_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace curvecast::server
