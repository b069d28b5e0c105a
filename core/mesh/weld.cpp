#include "core/mesh/weld.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <numeric>
#include <tuple>

#include "core/base/hash_buckets.h"
#include "core/base/random.h"

namespace curvecast {
namespace {

struct Place {
  double x, y, z;
  std::uint32_t vertex;
};

bool same(const Place& a, const Place& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

std::uint64_t hash_of(const Vec3d& place) {
  std::uint64_t hash = 0;
  for (const double x : place) hash = mix_bits(hash + kRandomStep + std::bit_cast<std::uint64_t>(x + 0.0));  // -0 equals 0
  return hash;
}

}  // namespace

Weld weld(const std::vector<Vec3d>& positions, std::span<const std::uint32_t> candidates, const ExecutionContext& context) {
  Weld result;
  result.map.resize(positions.size());
  std::iota(result.map.begin(), result.map.end(), 0u);
  std::atomic<std::uint64_t> welded = 0;
  const auto weld_bucket = [&](std::span<const std::uint32_t> bucket) {
    std::vector<Place> places;
    places.reserve(bucket.size());
    for (const std::uint32_t i : bucket) {
      const Vec3d& p = positions[candidates[i]];
      places.push_back({p.x(), p.y(), p.z(), candidates[i]});
    }
    std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
      return std::tie(a.x, a.y, a.z, a.vertex) < std::tie(b.x, b.y, b.z, b.vertex);
    });
    for (std::size_t i = 1; i < places.size(); ++i) {
      if (!same(places[i], places[i - 1])) continue;
      result.map[places[i].vertex] = result.map[places[i - 1].vertex];
      welded.fetch_add(1, std::memory_order_relaxed);
    }
  };
  for_each_bucket(
      context, candidates.size(), [&](std::size_t i) { return hash_of(positions[candidates[i]]); }, weld_bucket);
  result.welded = welded;
  return result;
}

}  // namespace curvecast
