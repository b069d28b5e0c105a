#include "core/density/fixed_density_cache.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace curvecast {
namespace {

/// Not by address: another curve may lie where one was that has gone.
bool is_same(const std::weak_ptr<const SurfaceCurve>& a, const std::shared_ptr<const SurfaceCurve>& b) {
  return !a.owner_before(b) && !b.owner_before(a);
}

/// Says whether the terms differ by this only, that `later` has more of the brush's dabs.
bool is_earlier(const std::vector<DensityTerm>& earlier, const std::vector<DensityTerm>& later) {
  return std::equal(earlier.begin(), earlier.end(), later.begin(), later.end(), [](const DensityTerm& a, const DensityTerm& b) {
    const auto *const before = std::get_if<BrushTerm>(&a), *const after = std::get_if<BrushTerm>(&b);
    if (before == nullptr || after == nullptr) return a == b;
    return before->dabs.size() < after->dabs.size() && std::equal(before->dabs.begin(), before->dabs.end(), after->dabs.begin());
  });
}

}  // namespace

absl::StatusOr<std::shared_ptr<const FixedDensity>> FixedDensityCache::get(const std::shared_ptr<const SurfaceCurve>& curve,
                                                                           std::span<const DensityTerm> terms,
                                                                           const ExecutionContext& context) {
  std::vector<DensityTerm> fixed_terms;
  std::copy_if(terms.begin(), terms.end(), std::back_inserter(fixed_terms),
               [](const DensityTerm& term) { return has_fixed_terms(std::span(&term, 1)); });
  if (!fixed_terms.empty()) {
    if (auto found = find(curve, fixed_terms)) return found;
  }
  absl::StatusOr<std::shared_ptr<const FixedDensity>> made =
      make_fixed_density(*curve, fixed_terms, find_earlier(curve, fixed_terms), context);
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
  const auto entry =
      std::find_if(entries_.begin(), entries_.end(), [&](const Entry& e) { return is_same(e.curve, curve) && e.terms == terms; });
  if (entry == entries_.end()) return nullptr;
  entries_.splice(entries_.begin(), entries_, entry);
  return entry->fixed;
}

EarlierPaint FixedDensityCache::find_earlier(const std::shared_ptr<const SurfaceCurve>& curve,
                                             const std::vector<DensityTerm>& terms) {
  EarlierPaint found;
  if (only_brush(terms) == nullptr) return found;
  const MutexLock lock(mutex_);
  for (const Entry& e : entries_) {
    if (!is_same(e.curve, curve) || !is_earlier(e.terms, terms)) continue;
    const std::size_t dabs = only_brush(e.terms)->dabs.size();
    if (found.fixed == nullptr || dabs > found.dabs) found = {e.fixed, dabs};
  }
  return found;
}

void FixedDensityCache::clear() {
  std::list<Entry> gone;  // after the lock, as below
  const MutexLock lock(mutex_);
  gone.swap(entries_);
  bytes_ = 0;
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
