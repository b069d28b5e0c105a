#include "server/frame/tileset_cache.h"

#include <algorithm>
#include <utility>

namespace curvecast::server {
namespace {

constexpr std::size_t kOfFile = 128;  // bytes of a map's node, beside what the strings hold

}  // namespace

std::size_t Tileset::byte_size() const {
  std::size_t bytes = sizeof(Tileset) + terms.size();
  for (const auto& [name, content] : files) bytes += kOfFile + content.capacity();
  return bytes;
}

std::shared_ptr<const Tileset> TilesetCache::find(std::string_view session_id, std::string_view terms,
                                                  const std::function<bool(const Tileset&)>& is_wanted) {
  const MutexLock lock(mutex_);
  const auto found = std::find_if(sets_.begin(), sets_.end(), [&](const auto& set) {
    return set->session_id == session_id && set->terms == terms && is_wanted(*set);
  });
  if (found == sets_.end()) return nullptr;
  sets_.splice(sets_.begin(), sets_, found);
  return *found;
}

void TilesetCache::keep(std::shared_ptr<const Tileset> set) {
  Sets gone;  // whose memory is freed after the lock
  const MutexLock lock(mutex_);
  for (auto it = sets_.begin(); it != sets_.end();) {
    const bool is_same = (*it)->session_id == set->session_id && (*it)->terms == set->terms && (*it)->digest == set->digest;
    it = is_same ? drop(it, gone) : std::next(it);
  }
  bytes_ += set->byte_size();
  sets_.push_front(std::move(set));
  while (sets_.size() > 1 && (bytes_ > most_bytes_ || sets_.size() > kMostSets)) drop(std::prev(sets_.end()), gone);
}

void TilesetCache::forget(std::string_view session_id) {
  Sets gone;
  const MutexLock lock(mutex_);
  for (auto it = sets_.begin(); it != sets_.end();) it = (*it)->session_id == session_id ? drop(it, gone) : std::next(it);
}

void TilesetCache::clear() {
  Sets gone;
  const MutexLock lock(mutex_);
  gone.swap(sets_);
  bytes_ = 0;
}

std::uint64_t TilesetCache::byte_size() const {
  const MutexLock lock(mutex_);
  return bytes_;
}

TilesetCache::Sets::iterator TilesetCache::drop(Sets::iterator set, Sets& gone) {
  const auto next = std::next(set);
  bytes_ -= (*set)->byte_size();
  gone.splice(gone.end(), sets_, set);
  return next;
}

}  // namespace curvecast::server
