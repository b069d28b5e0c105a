#include "core/remesh/chart_borders.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/mesh/topology.h"

namespace curvecast {
namespace {

/// How far along a segment a point of it lies.
double along(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  constexpr double kNothing = 1e-9;
  if (p == a) return 0;
  if (p == b) return 1;
  const Vec3d d = b - a;
  const double square = d.squaredNorm(), at = square > 0 ? (p - a).dot(d) / square : 0;
  return at < kNothing ? 0 : at > 1 - kNothing ? 1 : at;
}

double square_from(const Vec3d& p, const Vec3d& a, const Vec3d& b) {
  return (p - a - std::clamp(along(p, a, b), 0.0, 1.0) * (b - a)).squaredNorm();
}

BorderPiece piece_of(const TriangleMesh& surface, const ChartView& chart, std::uint32_t h) {
  const Triangle& t = chart.triangles[h / 3];
  const Vec3d &p = chart.positions[t[h % 3]], &q = chart.positions[t[(h + 1) % 3]];
  BorderPiece best{h, kNone, 0, 1};
  double least = std::numeric_limits<double>::infinity();
  for (std::uint32_t edge = 3 * chart.face_of[h / 3], i = 0; i < 3; ++i, ++edge) {
    const Vec3d &a = surface.positions[surface.from(edge)], &b = surface.positions[surface.to(edge)];
    const double square = square_from(p, a, b) + square_from(q, a, b);
    if (best.edge != kNone && !(square < least)) continue;
    least = square;
    best = {h, edge, along(p, a, b), along(q, a, b)};
  }
  return best;
}

}  // namespace

std::vector<BorderPiece> chart_border(const TriangleMesh& surface, const ChartView& chart) {
  std::vector<BorderPiece> pieces;
  const auto first = std::find(chart.twins.begin(), chart.twins.end(), kNone);
  if (first == chart.twins.end()) return pieces;
  const auto start = static_cast<std::uint32_t>(first - chart.twins.begin());
  std::uint32_t h = start;
  do {
    pieces.push_back(piece_of(surface, chart, h));
    h = next_on_border(chart.twins, h);
  } while (h != start);
  return pieces;
}

std::vector<bool> cut_edges(const TriangleMesh& surface, std::span<const std::vector<BorderPiece>> borders) {
  std::vector<bool> is_cut(surface.twins.size(), false);
  for (const std::vector<BorderPiece>& border : borders) {
    for (const BorderPiece& piece : border) {
      const std::uint32_t twin = surface.twins[piece.edge];
      if (twin != kNone) is_cut[piece.edge] = is_cut[twin] = true;
    }
  }
  return is_cut;
}

}  // namespace curvecast
