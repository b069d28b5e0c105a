#include "core/density/fixed_density_cache.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace curvecast {

absl::StatusOr<std::shared_ptr<const FixedDensity>> FixedDensityCache::get(const std::shared_ptr<const SurfaceCurve>& curve,
                                                                           std::span<const DensityTerm> terms) {
  std::vector<DensityTerm> fixed_terms;
  std::copy_if(terms.begin(), terms.end(), std::back_inserter(fixed_terms),
               [](const DensityTerm& term) { return has_fixed_terms(std::span(&term, 1)); });
  if (!fixed_terms.empty()) {
    if (auto found = find(curve, fixed_terms)) return found;
  }
  absl::StatusOr<std::shared_ptr<const FixedDensity>> made = make_fixed_density(*curve, terms);
  if (made.ok() && *made != nullptr) insert({curve, std::move(fixed_terms), *made});
  return made;
}

std::size_t FixedDensityCache::byte_size() const {
  const MutexLock lock(mutex_);
  return bytes_;
}

std::shared_ptr<const FixedDensity> FixedDensityCache::find(const std::shared_ptr<const SurfaceCurve>& curve,
                                                            const std::vector<DensityTerm>& terms) {
  const MutexLock lock(mutex_);
  const auto entry = std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) {
    // Not by address: another curve may lie where one was that has gone.
    return !e.curve.owner_before(curve) && !curve.owner_before(e.curve) && e.terms == terms;
  });
  if (entry == entries_.end()) return nullptr;
  entries_.splice(entries_.begin(), entries_, entry);
  return entry->fixed;
}

void FixedDensityCache::insert(Entry entry) {
  std::list<Entry> gone;  // after the lock, which takes its time
  const MutexLock lock(mutex_);
  bytes_ += entry.fixed->byte_size();
  entries_.push_front(std::move(entry));
  const auto drop = [&](std::list<Entry>::iterator e) {
    mutex_.assert_held();
    bytes_ -= e->fixed->byte_size();
    gone.splice(gone.begin(), entries_, e);
  };
  for (auto e = entries_.begin(); e != entries_.end();) {
    const auto next = std::next(e);
    if (e->curve.expired()) drop(e);
    e = next;
  }
  while (entries_.size() > max_entries_ || bytes_ > max_bytes_) drop(std::prev(entries_.end()));
}

}  // namespace curvecast
