#include "core/flatten/square_border.h"

#include <algorithm>
#include <array>

namespace curvecast {

std::vector<Vec2d> square_border(const DiscMesh& disc) {
  std::vector<Vec2d> uv(disc.vertex_count(), Vec2d::Zero());
  const std::vector<std::uint32_t>& loop = disc.border;
  const std::size_t n = loop.size();
  std::vector<double> along(n + 1, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    along[i + 1] = along[i] + (disc.positions[loop[(i + 1) % n]] - disc.positions[loop[i]]).norm();
  }
  // No edge may vanish beside much longer ones.
  const double least = 1e-3 * along[n] / static_cast<double>(n);
  for (std::size_t i = 0; i < n; ++i) {
    along[i + 1] = along[i] + std::max((disc.positions[loop[(i + 1) % n]] - disc.positions[loop[i]]).norm(), least);
  }
  std::array<std::size_t, 5> corner = {0, 0, 0, 0, n};
  for (std::size_t k = 1; k < 4; ++k) {
    const double target = along[n] * static_cast<double>(k) / 4;
    std::size_t i = static_cast<std::size_t>(std::lower_bound(along.begin(), along.end(), target) - along.begin());
    if (i > 0 && target - along[i - 1] < along[i] - target) --i;
    corner[k] = std::clamp(i, corner[k - 1] + 1, n - 4 + k);
  }
  const std::array<Vec2d, 5> place = {Vec2d(0, 0), Vec2d(1, 0), Vec2d(1, 1), Vec2d(0, 1), Vec2d(0, 0)};
  for (std::size_t k = 0; k < 4; ++k) {
    const double length = along[corner[k + 1]] - along[corner[k]];
    for (std::size_t i = corner[k]; i < corner[k + 1]; ++i) {
      const double t = (along[i] - along[corner[k]]) / length;
      uv[loop[i]] = place[k] + t * (place[k + 1] - place[k]);
    }
  }
  return uv;
}

}  // namespace curvecast
