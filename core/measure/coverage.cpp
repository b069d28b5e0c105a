#include "core/measure/coverage.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "core/measure/spacing.h"

namespace curvecast {
namespace {

using Corners = std::array<Vec3d, 3>;

/// Both halves of a triangle, cut through its longest side.
std::array<Corners, 2> halves(const Corners& t) {
  int longest = 0;
  double square = -1;
  for (int i = 0; i < 3; ++i) {
    const double side = (t[(i + 1) % 3] - t[i]).squaredNorm();
    if (side <= square) continue;
    longest = i;
    square = side;
  }
  const Vec3d &a = t[longest], &b = t[(longest + 1) % 3], &c = t[(longest + 2) % 3];
  const Vec3d middle = 0.5 * (a + b);
  return {Corners{a, middle, c}, Corners{middle, b, c}};
}

}  // namespace

double coverage_radius(const TriangleMesh& mesh, const PointCloud& points, const ExecutionContext& context) {
  // Batches come from the end of what is left: deep first, so that there is never much of it, and in an order of their own, so
  // that threads don't matter.
  constexpr std::size_t kBatch = 16'384;
  constexpr double kLeast = 0.05;  // nothing smaller is looked for: 1.155 is the best on a plane
  std::vector<Corners> left, batch;
  const double least = kLeast * packing_radius(surface_area(mesh), points.size());
  std::vector<double> distance, reach;  // of the middle of each in the batch: to the nearest point, to the farthest corner
  double largest = 0;
  for (std::size_t next_face = 0; next_face < mesh.face_count() || !left.empty();) {
    if (context.cancelled()) break;
    const std::size_t taken = std::min(kBatch, left.size());
    batch.assign(left.end() - static_cast<std::ptrdiff_t>(taken), left.end());
    left.resize(left.size() - taken);
    for (; batch.size() < kBatch && next_face < mesh.face_count(); ++next_face) {
      const Triangle& t = mesh.triangles[next_face];
      batch.push_back({mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]});
    }
    distance.resize(batch.size());
    reach.resize(batch.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, batch.size(), 128), [&](const auto& range) {
      for (std::size_t i = range.begin(); i < range.end(); ++i) {
        const auto& [a, b, c] = batch[i];
        const Vec3d middle = (a + b + c) / 3;
        Neighbour nearest;
        points.tree.nearest(points.local(middle), std::span(&nearest, 1));
        distance[i] = points.distance(nearest);
        reach[i] = std::sqrt(std::max({(a - middle).squaredNorm(), (b - middle).squaredNorm(), (c - middle).squaredNorm()}));
      }
    });
    for (const double d : distance) largest = std::max(largest, d);
    const double enough = std::max(largest * (1 + kCoverageTolerance), least);
    for (std::size_t i = 0; i < batch.size(); ++i) {
      if (distance[i] + reach[i] <= enough) continue;
      for (const Corners& half : halves(batch[i])) left.push_back(half);
    }
  }
  return largest;
}

}  // namespace curvecast
