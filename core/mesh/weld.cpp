#include "core/mesh/weld.h"

#include <algorithm>
#include <numeric>
#include <tuple>

namespace curvecast {
namespace {

struct Place {
  double x, y, z;
  std::uint32_t vertex;
};

bool same(const Place& a, const Place& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }

}  // namespace

Weld weld(const std::vector<Vec3d>& positions, std::span<const std::uint32_t> candidates) {
  std::vector<Place> places;
  places.reserve(candidates.size());
  for (const std::uint32_t v : candidates) places.push_back({positions[v].x(), positions[v].y(), positions[v].z(), v});
  std::sort(places.begin(), places.end(),
            [](const Place& a, const Place& b) { return std::tie(a.x, a.y, a.z, a.vertex) < std::tie(b.x, b.y, b.z, b.vertex); });
  Weld result;
  result.map.resize(positions.size());
  std::iota(result.map.begin(), result.map.end(), 0u);
  for (std::size_t i = 1; i < places.size(); ++i) {
    if (!same(places[i], places[i - 1])) continue;
    result.map[places[i].vertex] = result.map[places[i - 1].vertex];
    ++result.welded;
  }
  return result;
}

}  // namespace curvecast
