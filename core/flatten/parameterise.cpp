#include "core/flatten/parameterise.h"

#include <Eigen/SparseCore>
#include <Eigen/SparseLU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/flatten/distortion.h"
#include "core/flatten/mean_value.h"
#include "core/flatten/square_border.h"

namespace curvecast {
namespace {

using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
using Solution = Eigen::Matrix<double, Eigen::Dynamic, 2>;

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
        const double tangent = half_tangent(q - p, r - p);
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

}  // namespace

absl::StatusOr<std::vector<Vec2d>> parameterise(const DiscMesh& disc, const ParameteriseOptions& options,
                                                const ExecutionContext& context) {
  return parameterise_inside(disc, square_border(disc), options, context);
}

absl::StatusOr<std::vector<Vec2d>> parameterise_inside(const DiscMesh& disc, std::vector<Vec2d> uv,
                                                       const ParameteriseOptions& options, const ExecutionContext& context) {
  // Reweighting multiplies up; beyond this the system would lose its digits.
  constexpr double kSmallestStretch = 1e-3;
  constexpr double kLargestStretch = 1e15;
  const int reweightings = options.weights == ParameterWeights::kMeanValue ? options.reweightings : 0;
  std::vector<double> divisor(disc.vertex_count(), 1.0);
  std::vector<Vec2d> best;
  double best_stretch = std::numeric_limits<double>::infinity();
  // A direct solver: limbs shrink to 1e-9 of the square and smaller, where an iterative one's tolerance would fold them.
  Eigen::SparseLU<Matrix> factor;
  for (int round = 0; round <= reweightings; ++round) {
    if (absl::Status status = context.check(); !status.ok()) return status;
    const System system = assemble(disc, options.weights, divisor, uv);
    if (system.inner.empty()) return uv;
    if (absl::Status status = context.check(); !status.ok()) return status;
    if (round == 0) factor.analyzePattern(system.matrix);
    factor.factorize(system.matrix);
    if (factor.info() != Eigen::Success) {
      if (!best.empty()) break;
      return absl::InternalError("the parameterisation's matrix could not be factorised: " + factor.lastErrorMessage());
    }
    if (absl::Status status = context.check(); !status.ok()) return status;
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
