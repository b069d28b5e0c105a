#include "core/flatten/parameterise.h"

#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace curvecast {
namespace {

using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
using Solution = Eigen::Matrix<double, Eigen::Dynamic, 2>;

/// Places the border loop on the square's sides, by arc length, with four of its vertices on the corners.
void place_border(const DiscMesh& disc, std::vector<Vec2d>& uv) {
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
}

/// Tangent of half the angle at `apex`, kept away from the extremes that slivers have.
double half_tangent(const Vec3d& apex, const Vec3d& p, const Vec3d& q) {
  const Vec3d u = p - apex;
  const Vec3d v = q - apex;
  const double lengths = u.norm() * v.norm();
  const double cosine = u.dot(v);
  const double sine = u.cross(v).norm();
  const double tangent = cosine > 0 ? sine / (lengths + cosine) : (lengths - cosine) / std::max(sine, 1e-300);
  return std::clamp(tangent, 1e-4, 1e4);
}

/// The equations of the inner vertices: each is the weighted mean of its neighbours.
struct System {
  Matrix matrix;                     // not symmetric: a vertex and its neighbour see each other under different angles
  Solution right;                    // from the border
  std::vector<std::uint32_t> inner;  // vertex of each unknown
};

/// Weights towards a vertex are divided by its stretch.
System assemble(const DiscMesh& disc, ParameterWeights weights, const std::vector<double>& stretch,
                const std::vector<Vec2d>& uv) {
  System system;
  std::vector<int> unknown(disc.vertex_count(), 0);
  for (const std::uint32_t v : disc.border) unknown[v] = -1;
  for (std::uint32_t v = 0; v < disc.vertex_count(); ++v) {
    if (unknown[v] < 0) continue;
    unknown[v] = static_cast<int>(system.inner.size());
    system.inner.push_back(v);
  }
  const auto n = static_cast<Eigen::Index>(system.inner.size());
  system.right = Solution::Zero(n, 2);
  Eigen::VectorXd diagonal = Eigen::VectorXd::Zero(n);
  std::vector<Eigen::Triplet<double, int>> entries;
  entries.reserve(6 * disc.triangles.size());
  // Row i of the inner vertex gets weight w towards neighbour j.
  const auto add = [&](std::uint32_t i, std::uint32_t j, double w) {
    const int row = unknown[i];
    if (row < 0) return;
    diagonal[row] += w;
    if (unknown[j] >= 0) {
      entries.emplace_back(row, unknown[j], -w);
    } else {
      system.right.row(row) += w * uv[j].transpose();
    }
  };
  for (const Triangle& t : disc.triangles) {
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t a = t[i];
      const std::uint32_t b = t[(i + 1) % 3];
      const std::uint32_t c = t[(i + 2) % 3];
      double to_b = 1;
      double to_c = 1;
      if (weights == ParameterWeights::kMeanValue) {
        const Vec3d &p = disc.positions[a], &q = disc.positions[b], &r = disc.positions[c];
        const double tangent = half_tangent(p, q, r);
        to_b = tangent / (q - p).norm();
        to_c = tangent / (r - p).norm();
      }
      add(a, b, to_b / stretch[b]);
      add(a, c, to_c / stretch[c]);
    }
  }
  for (int i = 0; i < n; ++i) entries.emplace_back(i, i, diagonal[i]);
  system.matrix.resize(n, n);
  system.matrix.setFromTriplets(entries.begin(), entries.end());
  return system;
}

/// The L2 stretch of the map from uv to the surface: of the whole, and of the triangles around each vertex, both relative to the
/// stretch of an isometric map.
struct Stretch {
  double total = 0;
  std::vector<double> vertex;
};

Stretch measure_stretch(const DiscMesh& disc, const std::vector<Vec2d>& uv) {
  constexpr double kSmallestArea = 1e-60;  // in uv: stands for triangles that rounding has collapsed or folded
  Stretch stretch;
  stretch.vertex.assign(disc.vertex_count(), 0.0);
  std::vector<double> area_sum(disc.vertex_count(), 0.0);
  double surface = 0;
  for (const Triangle& t : disc.triangles) {
    const Vec2d p = uv[t[1]] - uv[t[0]];
    const Vec2d q = uv[t[2]] - uv[t[0]];
    const Vec3d e = disc.positions[t[1]] - disc.positions[t[0]];
    const Vec3d f = disc.positions[t[2]] - disc.positions[t[0]];
    const double area = 0.5 * e.cross(f).norm();
    const double determinant = std::max(p.x() * q.y() - p.y() * q.x(), kSmallestArea);
    const Vec3d along_u = (e * q.y() - f * p.y()) / determinant;
    const Vec3d along_v = (f * p.x() - e * q.x()) / determinant;
    const double square = 0.5 * (along_u.squaredNorm() + along_v.squaredNorm());
    for (const std::uint32_t v : t) {
      stretch.vertex[v] += area * square;
      area_sum[v] += area;
    }
    stretch.total += area * square;
    surface += area;
  }
  stretch.total = std::sqrt(stretch.total) / surface;  // the square's own area is 1
  for (std::size_t v = 0; v < area_sum.size(); ++v) stretch.vertex[v] = std::sqrt(stretch.vertex[v] / (area_sum[v] * surface));
  return stretch;
}

}  // namespace

absl::StatusOr<std::vector<Vec2d>> parameterise(const DiscMesh& disc, const ParameteriseOptions& options) {
  // Reweighting multiplies up; beyond this the system would lose its digits.
  constexpr double kSmallestStretch = 1e-3;
  constexpr double kLargestStretch = 1e15;
  const int reweightings = options.weights == ParameterWeights::kMeanValue ? options.reweightings : 0;
  std::vector<Vec2d> uv(disc.vertex_count(), Vec2d::Zero());
  place_border(disc, uv);
  std::vector<double> divisor(disc.vertex_count(), 1.0);
  std::vector<Vec2d> best;
  double best_stretch = std::numeric_limits<double>::infinity();
  // A direct solver: limbs shrink to 1e-9 of the square and smaller, where an iterative one's tolerance would fold them.
  Eigen::SparseLU<Matrix> factor;
  for (int round = 0; round <= reweightings; ++round) {
    const System system = assemble(disc, options.weights, divisor, uv);
    if (system.inner.empty()) return uv;
    if (round == 0) factor.analyzePattern(system.matrix);
    factor.factorize(system.matrix);
    if (factor.info() != Eigen::Success) {
      if (!best.empty()) break;
      return absl::InternalError("the parameterisation's matrix could not be factorised: " + factor.lastErrorMessage());
    }
    const Solution solution = factor.solve(system.right);
    for (std::size_t i = 0; i < system.inner.size(); ++i) uv[system.inner[i]] = solution.row(static_cast<Eigen::Index>(i));
    const Stretch stretch = measure_stretch(disc, uv);
    if (round > 0 && !(stretch.total < best_stretch)) break;
    best = uv;
    best_stretch = stretch.total;
    if (best_stretch < options.good_stretch) break;
    for (std::size_t v = 0; v < divisor.size(); ++v) {
      divisor[v] = std::clamp(divisor[v] * stretch.vertex[v], kSmallestStretch, kLargestStretch);
    }
  }
  return best;
}

}  // namespace curvecast
