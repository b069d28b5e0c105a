#include "core/reference/voronoi_area.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "core/base/column.h"
#include "core/curve/deepest_triangle.h"
#include "core/reference/leaf_neighbours.h"

namespace curvecast {
namespace {

constexpr std::size_t kGrain = 4096;  // leaves

/// A vertex as its neighbours ask for it: together in memory.
struct Vertex {
  float x, y, z;
  float area_ratio;
};

/// The same with its place in the square, and who it is.
struct Node {
  Vec3d place;
  Vec2d uv;
  double area_ratio;
  std::uint32_t leaf;
};

double triangle_area(const Vec3d& p, const Vec3d& q, const Vec3d& r) { return 0.5 * (q - p).cross(r - p).norm(); }

/// The part of the triangle q, p, r that is q's. The parts of the three corners add up to 1.
double mixed_share(const Vec3d& q, const Vec3d& p, const Vec3d& r) {
  const Vec3d to_p = p - q, to_r = r - q, across = r - p;
  const double dot_p = -to_p.dot(across), dot_r = to_r.dot(across);
  if (to_p.dot(to_r) < 0) return 0.5;
  if (dot_p < 0 || dot_r < 0) return 0.25;
  const double square = to_p.cross(to_r).squaredNorm();  // of twice the area
  return square > 0 ? (to_r.squaredNorm() * dot_p + to_p.squaredNorm() * dot_r) / (4 * square) : 1.0 / 3;
}

/// What q has of the surface beneath a triangle, counter-clockwise.
double mixed_area(const Node& q, const Node& p, const Node& r) {
  const Vec2d to_p = p.uv - q.uv, to_r = r.uv - q.uv;
  const double uv_area = 0.5 * (to_p.x() * to_r.y() - to_p.y() * to_r.x());
  return mixed_share(q.place, p.place, r.place) * uv_area * (q.area_ratio + p.area_ratio + r.area_ratio) / 3;
}

/// Cotangent of the angle at p; the same bits with a and b swapped.
double cotangent(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  const Vec3d to_a = a - p, to_b = b - p;
  return to_a.dot(to_b) / std::max(to_a.cross(to_b).norm(), std::numeric_limits<double>::min());
}

/// Whether the quad q, p, d, r has the diagonal from q to d. All four leaves decide alike, on a tie too.
bool has_diagonal(const Node& q, const Node& p, const Node& d, const Node& r) {
  const double own = cotangent(p.place, q.place, d.place) + cotangent(r.place, q.place, d.place);
  const double other = cotangent(q.place, p.place, r.place) + cotangent(d.place, p.place, r.place);
  return own != other ? own > other : std::min(q.leaf, d.leaf) < std::min(p.leaf, r.leaf);
}

class Cells {
 public:
  Cells(const Chart& chart, std::span<const ParameterTriangle> triangles, const QuadtreeLeaves& leaves,
        const LeafVertices& vertices)
      : chart_(chart), triangles_(triangles), leaves_(leaves), keys_{leaves.key, leaves.level}, origin_(vertices.origin) {
    vertices_.resize(leaves.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, leaves.size(), kGrain), [&](const auto& range) {
      for (std::size_t l = range.begin(); l < range.end(); ++l) {
        vertices_[l] = {vertices.x[l], vertices.y[l], vertices.z[l], static_cast<float>(triangles[vertices.under[l]].area_ratio)};
      }
    });
  }

  /// `ring` is scratch.
  double area(std::uint32_t leaf, std::vector<RingEntry>& ring) const {
    const HilbertCell own_cell = leaf_ring(keys_, leaf, ring);
    const Node q = node(leaf, own_cell);
    double sum = 0;
    int side = 0;  // from the right one, counter-clockwise
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const RingEntry& here = ring[i];
      const RingEntry& next = ring[i + 1 < ring.size() ? i + 1 : 0];
      if (here.is_corner) {
        sum += at_corner(q, side, ring[i - 1], here, next);
        ++side;
      } else if (here.leaf == kNone) {
        sum += triangle_area(q.place, corner(leaf, side), corner(leaf, side + 1));
      } else if (!next.is_corner && next.leaf != kNone) {  // what lies beyond the beginning of a gap is not known
        sum += mixed_area(q, node(here.leaf, here.cell), node(next.leaf, next.cell));
      }
    }
    return sum;
  }

 private:
  Vec3d place(std::uint32_t leaf) const { return {vertices_[leaf].x, vertices_[leaf].y, vertices_[leaf].z}; }

  Node node(std::uint32_t leaf, HilbertCell cell_in_it) const {
    const std::uint32_t cells = std::uint32_t{1} << (kMaxLevel - leaves_.level[leaf]);
    const auto middle = [&](std::uint32_t c) { return ((c & ~(cells - 1)) + 0.5 * cells) * kCellSide; };
    return {place(leaf), Vec2d(middle(cell_in_it.x), middle(cell_in_it.y)), vertices_[leaf].area_ratio, leaf};
  }

  /// The surface at a corner of the leaf, counted counter-clockwise from the lower right one.
  Vec3d corner(std::uint32_t leaf, int i) const {
    const Quad quad = leaves_.quad(leaf);
    const double u = quad.corner.x() + (i % 4 < 2 ? quad.side : 0);
    const double v = quad.corner.y() + (i % 4 == 1 || i % 4 == 2 ? quad.side : 0);
    const std::uint32_t t = deepest_triangle(triangles_, leaves_.triangles_of(leaf), u, v);
    const Vec3d weights = triangles_[t].weights(u, v);
    const Triangle& corners = chart_.disc.triangles[t];
    const std::vector<Vec3d>& places = chart_.disc.positions;
    return weights[0] * places[corners[0]] + weights[1] * places[corners[1]] + weights[2] * places[corners[2]] - origin_;
  }

  /// What q has of the dual face at the corner after the given side.
  double at_corner(const Node& q, int side, const RingEntry& before, const RingEntry& across, const RingEntry& after) const {
    std::array<Node, 3> others;  // the leaves that are there
    std::size_t count = 0;
    for (const RingEntry* entry : {&before, &across, &after}) {
      const bool is_new = entry->leaf != kNone && (count == 0 || others[count - 1].leaf != entry->leaf);
      if (is_new) others[count++] = node(entry->leaf, entry->cell);
    }
    if (count == 2) return mixed_area(q, others[0], others[1]);
    if (count < 2) {
      // On the border the face is a triangle with a corner that belongs to nobody: its two leaves share it. Leaves that only
      // touch at the corner have none.
      const bool is_beside = before.leaf != kNone || after.leaf != kNone;
      return is_beside ? 0.5 * triangle_area(q.place, corner(q.leaf, side + 1), others[0].place) : 0;
    }
    const Node &p = others[0], &d = others[1], &r = others[2];
    return has_diagonal(q, p, d, r) ? mixed_area(q, p, d) + mixed_area(q, d, r) : mixed_area(q, p, r);
  }

  const Chart& chart_;
  std::span<const ParameterTriangle> triangles_;
  const QuadtreeLeaves& leaves_;
  LeafKeys keys_;
  Vec3d origin_;
  Column<Vertex> vertices_;
};

}  // namespace

double voronoi_areas(const Chart& chart, std::span<const ParameterTriangle> triangles, const QuadtreeLeaves& leaves,
                     const LeafVertices& vertices, std::span<float> area) {
  const Cells cells(chart, triangles, leaves, vertices);
  const auto write = [&](const tbb::blocked_range<std::size_t>& range, double total) {
    std::vector<RingEntry> ring;
    for (std::size_t l = range.begin(); l < range.end(); ++l) {
      const double a = cells.area(static_cast<std::uint32_t>(l), ring);
      area[l] = static_cast<float>(a);
      total += a;
    }
    return total;
  };
  // The same order of additions on any number of threads.
  return tbb::parallel_deterministic_reduce(tbb::blocked_range<std::size_t>(0, leaves.size(), kGrain), 0.0, write, std::plus<>());
}

}  // namespace curvecast
