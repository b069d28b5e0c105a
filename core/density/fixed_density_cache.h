// Keeps the last fixed densities, so that views of the same terms do not make them again.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>
#include <list>
#include <memory>
#include <span>
#include <vector>

#include "core/base/mutex.h"
#include "core/density/fixed_density.h"

namespace curvecast {

/// Thread-safe. Does not keep curves alive; entries of destroyed curves are evicted like any other.
class FixedDensityCache {
 public:
  /// Keeps at most max_entries densities, and max_bytes of them.
  explicit FixedDensityCache(std::size_t max_entries = 16, std::size_t max_bytes = std::size_t{256} << 20)
      : max_entries_(max_entries), max_bytes_(max_bytes) {}

  /// Returns what make_fixed_density() gives, made or kept. Several threads that ask for the same at once may each make it.
  absl::StatusOr<std::shared_ptr<const FixedDensity>> get(const std::shared_ptr<const SurfaceCurve>& curve,
                                                          std::span<const DensityTerm> terms,
                                                          const ExecutionContext& context = {});

  /// Returns the bytes of the densities that are kept.
  std::size_t byte_size() const;
  /// Lets go of all that are kept.
  void clear();

 private:
  struct Entry {
    std::weak_ptr<const SurfaceCurve> curve;
    std::vector<DensityTerm> terms;  // the fixed ones
    std::shared_ptr<const FixedDensity> fixed;
  };

  std::shared_ptr<const FixedDensity> find(const std::shared_ptr<const SurfaceCurve>& curve,
                                           const std::vector<DensityTerm>& terms);
  /// Returns the density with the most of the brush's dabs, where there is any; it has fewer than are wanted.
  EarlierPaint find_earlier(const std::shared_ptr<const SurfaceCurve>& curve, const std::vector<DensityTerm>& terms);
  void insert(Entry entry);

  const std::size_t max_entries_, max_bytes_;
  mutable Mutex mutex_;
  std::list<Entry> entries_ ABSL_GUARDED_BY(mutex_);  // the one used most recently comes first
  std::size_t bytes_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace curvecast
