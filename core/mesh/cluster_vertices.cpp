#include "core/mesh/cluster_vertices.h"

#include <tbb/blocked_range.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <tuple>
#include <utility>

#include "core/mesh/triangle_mesh.h"

namespace curvecast {
namespace {

constexpr double kCellsPerVertex = 1.5;  // a slanted plane meets so many cells for each square of its own
constexpr double kMostCells = 1 << 25;   // of the grid: 128 MiB
constexpr std::size_t kGrain = 1 << 14;

using Range = tbb::blocked_range<std::size_t>;

/// Calls visit(polygon, first corner) for the triangles of the fans of polygons begin .. end - 1.
template <typename Visit>
void for_triangles(const PolygonSoup& soup, const Range& polygons, const Visit& visit) {
  for (std::size_t p = polygons.begin(); p < polygons.end(); ++p) {
    const std::uint32_t first = soup.polygon_begin[p];
    for (std::uint32_t c = first + 1; c + 1 < soup.polygon_begin[p + 1]; ++c) visit(p, first, c);
  }
}

double area_of(const PolygonSoup& soup) {
  return tbb::parallel_deterministic_reduce(
      Range(0, soup.polygon_count(), kGrain), 0.0,
      [&](const Range& polygons, double sum) {
        for_triangles(soup, polygons, [&](std::size_t, std::uint32_t a, std::uint32_t b) {
          const Vec3d& origin = soup.positions[soup.indices[a]];
          sum += (soup.positions[soup.indices[b]] - origin).cross(soup.positions[soup.indices[b + 1]] - origin).norm() / 2;
        });
        return sum;
      },
      std::plus<>());
}

/// The cells of the soup's box, x fastest.
class Grid {
 public:
  Grid(const PolygonSoup& soup, std::size_t vertices) {
    box_ = tbb::parallel_reduce(
        Range(0, soup.positions.size(), kGrain), Box3d(),
        [&](const Range& range, Box3d box) {
          for (std::size_t v = range.begin(); v < range.end(); ++v) box.extend(soup.positions[v]);
          return box;
        },
        [](Box3d a, const Box3d& b) {
          a.extend(b.min);
          a.extend(b.max);
          return a;
        });
    const Vec3d size = box_.max - box_.min;
    double edge = std::sqrt(kCellsPerVertex * area_of(soup) / static_cast<double>(vertices));
    if (!(edge > 0)) edge = std::max(size.maxCoeff(), 1e-300);
    const auto counts = [&] { return Vec3d((size / edge).array().floor() + 1); };
    while (counts().prod() > kMostCells) edge *= 1.1;
    edge_ = edge;
    counts_ = counts().cast<std::size_t>();
  }

  std::size_t size() const { return counts_.prod(); }
  std::size_t cell_of(const Vec3d& position) const {
    const auto cell = ((position - box_.min) / edge_).array().floor().cast<std::size_t>().min(counts_.array() - 1).eval();
    return (cell[2] * counts_[1] + cell[1]) * counts_[0] + cell[0];
  }

 private:
  Box3d box_;
  double edge_ = 1;
  Eigen::Matrix<std::size_t, 3, 1> counts_;
};

/// A triangle whose corners lie in three clusters.
struct Kept {
  std::array<std::uint32_t, 3> clusters;  // ascending
  bool is_turned;                         // it runs the other way around
  std::array<std::uint32_t, 3> corners;   // of the soup, in the order of the clusters
  std::uint32_t polygon;

  bool operator<(const Kept& other) const {
    return std::tie(clusters, is_turned, corners) < std::tie(other.clusters, other.is_turned, other.corners);
  }
};

/// Has the first of those triangles between the same three clusters of which there are more than of those that run the other way
/// around; none where they are as many: so folds vanish, and what had no border has none. `all` is sorted.
void cancel_folds(std::vector<Kept>& all) {
  auto out = all.begin();
  for (auto begin = all.begin(); begin != all.end();) {
    const auto end = std::find_if(begin, all.end(), [&](const Kept& other) { return other.clusters != begin->clusters; });
    const auto turned = std::find_if(begin, end, [](const Kept& kept) { return kept.is_turned; });
    const auto ahead = (turned - begin) - (end - turned);
    if (ahead != 0) *out++ = ahead > 0 ? *begin : *turned;
    begin = end;
  }
  all.erase(out, all.end());
}

std::vector<Kept> kept_triangles(const PolygonSoup& soup, const std::vector<std::uint32_t>& cluster_of) {
  tbb::enumerable_thread_specific<std::vector<Kept>> of_threads;
  tbb::parallel_for(Range(0, soup.polygon_count(), kGrain), [&](const Range& polygons) {
    std::vector<Kept>& kept = of_threads.local();
    for_triangles(soup, polygons, [&](std::size_t p, std::uint32_t first, std::uint32_t c) {
      Kept triangle{{}, false, {first, c, c + 1}, static_cast<std::uint32_t>(p)};
      for (int i = 0; i < 3; ++i) triangle.clusters[i] = cluster_of[soup.indices[triangle.corners[i]]];
      const auto sort_two = [&](int i, int k) {
        if (triangle.clusters[i] <= triangle.clusters[k]) return;
        std::swap(triangle.clusters[i], triangle.clusters[k]);
        std::swap(triangle.corners[i], triangle.corners[k]);
        triangle.is_turned = !triangle.is_turned;
      };
      sort_two(0, 1), sort_two(1, 2), sort_two(0, 1);
      if (triangle.clusters[0] == triangle.clusters[1] || triangle.clusters[1] == triangle.clusters[2]) return;
      kept.push_back(triangle);
    });
  });
  std::vector<Kept> all;
  for (const std::vector<Kept>& kept : of_threads) all.insert(all.end(), kept.begin(), kept.end());
  tbb::parallel_sort(all);  // whatever thread found them
  cancel_folds(all);
  return all;
}

/// The sums of what the vertices of each cluster have.
template <typename Sum, typename Value>
std::vector<Sum> add_up(const std::vector<Value>& values, const std::vector<std::uint32_t>& cluster_of, std::size_t clusters,
                        const Sum& zero) {
  std::vector<Sum> sums(clusters, zero);
  for (std::size_t v = 0; v < values.size(); ++v) {
    if constexpr (std::is_same_v<Value, Rgba8>) {
      sums[cluster_of[v]] += Sum(values[v].r, values[v].g, values[v].b, values[v].a);
    } else {
      sums[cluster_of[v]] += values[v];
    }
  }
  return sums;
}

}  // namespace

PolygonSoup cluster_vertices(const PolygonSoup& soup, std::size_t vertices) {
  PolygonSoup coarse;
  if (soup.positions.empty()) return coarse;
  const Grid grid(soup, vertices);
  std::vector<std::uint32_t> cluster_of(soup.positions.size());
  tbb::parallel_for(Range(0, cluster_of.size(), kGrain), [&](const Range& range) {
    for (std::size_t v = range.begin(); v < range.end(); ++v) {
      cluster_of[v] = static_cast<std::uint32_t>(grid.cell_of(soup.positions[v]));
    }
  });
  std::vector<double> count;  // of vertices
  {
    std::vector<std::uint32_t> cluster_of_cell(grid.size(), kNone);
    for (std::uint32_t& cluster : cluster_of) {  // a cell, so far
      std::uint32_t& known = cluster_of_cell[cluster];
      if (known == kNone) {
        known = static_cast<std::uint32_t>(count.size());
        count.push_back(0);
      }
      cluster = known;
      ++count[cluster];
    }
  }
  const std::size_t clusters = count.size();
  coarse.positions = add_up<Vec3d>(soup.positions, cluster_of, clusters, Vec3d::Zero());
  for (std::size_t c = 0; c < clusters; ++c) coarse.positions[c] /= count[c];

  const MeshAttributes& from = soup.attributes;
  MeshAttributes& to = coarse.attributes;
  using Colour = Eigen::Vector4d;
  const std::vector<Colour> colours =
      add_up<Colour>(from.colours, cluster_of, from.colours.empty() ? 0 : clusters, Colour::Zero());
  for (std::size_t c = 0; c < colours.size(); ++c) {
    const auto mean = (colours[c] / count[c]).array().round().cast<std::uint8_t>().eval();
    to.colours.push_back({mean[0], mean[1], mean[2], mean[3]});
  }
  for (const ScalarAttribute& scalar : from.scalars) {
    const std::vector<double> values = add_up<double>(scalar.values, cluster_of, clusters, 0.0);
    ScalarAttribute& mean = to.scalars.emplace_back(ScalarAttribute{scalar.name, {}});
    for (std::size_t c = 0; c < clusters; ++c) mean.values.push_back(static_cast<float>(values[c] / count[c]));
  }
  to.materials = from.materials;
  coarse.polygon_begin.push_back(0);
  for (Kept triangle : kept_triangles(soup, cluster_of)) {
    if (triangle.is_turned) {
      std::swap(triangle.clusters[1], triangle.clusters[2]);
      std::swap(triangle.corners[1], triangle.corners[2]);
    }
    coarse.indices.insert(coarse.indices.end(), triangle.clusters.begin(), triangle.clusters.end());
    coarse.polygon_begin.push_back(static_cast<std::uint32_t>(coarse.indices.size()));
    if (!from.face_colours.empty()) to.face_colours.push_back(from.face_colours[triangle.polygon]);
    if (!from.material_of_face.empty()) to.material_of_face.push_back(from.material_of_face[triangle.polygon]);
    if (from.uv.empty()) continue;
    for (const std::uint32_t corner : triangle.corners) to.uv.push_back(from.uv[corner]);
  }
  return coarse;
}

}  // namespace curvecast
