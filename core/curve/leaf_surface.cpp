#include "core/curve/leaf_surface.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <optional>
#include <utility>

#include "core/base/simd.h"
#include "core/curve/covered_share.h"
#include "core/curve/deepest_triangle.h"
#include "core/curve/hilbert.h"

namespace curvecast {
namespace {

// Divisions of a leaf. A piece that meets several triangles after so many has hardly any area.
constexpr int kMaxDepth = 24;
// Triangles whose area on the surface, beside that in the parameter square, differs by less than this factor count as even.
constexpr double kEven = 1.25;
// A leaf of which the disc covers all but this part is covered.
constexpr double kUncovered = 1e-6;

// Where the curve is in a piece is looked up a few levels at a time.
constexpr int kTableLevels = 4;
constexpr int kTables = 5;      // one after the other: 20 levels, finer than a float can tell
constexpr int kEvenTables = 3;  // 12 levels: enough where there are only a few places in each leaf
constexpr unsigned kTableSize = 1u << 2 * kTableLevels;

struct TableEntry {
  std::uint8_t x, y;  // of the cell, in cells
  HilbertState state;
};

constexpr auto kTable = [] {
  std::array<std::array<TableEntry, kTableSize>, 4> table{};
  for (HilbertState start = 0; start < 4; ++start) {
    for (unsigned i = 0; i < kTableSize; ++i) {
      TableEntry entry{0, 0, start};
      for (int shift = 2 * kTableLevels - 2; shift >= 0; shift -= 2) {
        const unsigned quadrant = hilbert_quadrant(entry.state, i >> shift & 3);
        entry.x = static_cast<std::uint8_t>(entry.x << 1 | (quadrant & 1));
        entry.y = static_cast<std::uint8_t>(entry.y << 1 | quadrant >> 1);
        entry.state = hilbert_child_state(entry.state, i >> shift & 3);
      }
      table[start][i] = entry;
    }
  }
  return table;
}();

/// Where the curve has passed a part of a quad, in [0, 1]: the middle of the cell there. There are 4^(4 tables) cells.
template <int tables>
[[gnu::always_inline]] inline Vec2d place_in_quad(const Quad& quad, HilbertState state, double part) {
  constexpr std::int64_t kSide = std::int64_t{1} << kTableLevels * tables;
  constexpr auto kCells = static_cast<double>(kSide * kSide);
  const auto index = static_cast<std::int64_t>(fast_clamp(part * kCells, 0, kCells - 1));
  std::int64_t x = 0, y = 0;
  for (int t = tables - 1; t >= 0; --t) {
    const TableEntry& entry = kTable[state][index >> 2 * kTableLevels * t & (kTableSize - 1)];
    x = x << kTableLevels | entry.x;
    y = y << kTableLevels | entry.y;
    state = entry.state;
  }
  const double cell = quad.side / static_cast<double>(kSide);
  return quad.corner + cell * Vec2d(static_cast<double>(x) + 0.5, static_cast<double>(y) + 0.5);
}

/// A piece of a leaf.
struct Piece {
  Quad quad;
  HilbertState state;
  double begin, end;  // the part of the leaf's area before it, and before the next

  Quad child(unsigned quadrant) const {
    const double half = 0.5 * quad.side;
    return {quad.corner + Vec2d(quadrant & 1 ? half : 0, quadrant & 2 ? half : 0), half};
  }
};

Piece whole_leaf(const SurfaceCurve& curve, std::size_t l) {
  const std::uint64_t key = curve.key[l];
  HilbertState state = 0;
  for (int depth = 1; depth <= curve.level[l]; ++depth) {
    state = hilbert_child_state(state, key >> 2 * (kMaxLevel - depth) & 3);
  }
  return {leaf_quad(key, curve.level[l]), state, 0, 1};
}

/// Returns the part of a quad that triangles cover.
CURVECAST_WIDE double covered_in(const ParameterTriangle* triangles, const std::uint32_t* near, std::size_t count,
                                 const Quad& quad) {
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) {
    sum += fast_max(covered_share(triangles[near[i]], quad.corner.x(), quad.corner.y(), 1 / quad.side), 0.0);
  }
  return sum;
}

/// Returns the area on the surface that triangles have in a quad, in units of the quad's.
CURVECAST_WIDE double area_in(const ParameterTriangle* triangles, const std::uint32_t* near, std::size_t count,
                              const Quad& quad) {
  const double x = quad.corner.x(), y = quad.corner.y(), scale = 1 / quad.side;
  double sum = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const ParameterTriangle& triangle = triangles[near[i]];
    sum += fast_max(covered_share(triangle, x, y, scale), 0.0) * triangle.area_ratio;
  }
  return sum;
}

}  // namespace

/// Finds places of one leaf.
class LeafSurface::Finder {
 public:
  Finder(const LeafSurface& surface, std::size_t disc, double grain, std::span<const double> parts,
         std::span<SurfacePlace> places, Memory& memory)
      : mapper_(surface.base_->mappers[disc]),
        triangles_(memory.triangles),
        origin_(surface.curve_->origin),
        grain_(grain),
        parts_(parts),
        places_(places),
        memory_(memory) {}

  /// memory_.numbers and triangles are those that touch the leaf. Finds all places.
  void find(const Piece& leaf) {
    leaf_ = leaf.quad;
    std::vector<std::uint32_t>& all = memory_.lists[0];
    all.resize(triangles_.size());
    std::iota(all.begin(), all.end(), 0u);
    descend(leaf, 0, 0, parts_.size());
    finish();
  }

 private:
  /// memory_.lists[depth] has the piece's triangles. Finds the places [first, last).
  void descend(const Piece& piece, int depth, std::size_t first, std::size_t last) {
    const std::vector<std::uint32_t>& near = memory_.lists[static_cast<std::size_t>(depth)];
    if (near.size() == 1 || piece.end - piece.begin <= grain_ || depth == kMaxDepth || is_even(near)) {
      for (std::size_t i = first; i < last; ++i) put(piece, near, i);
      return;
    }
    double area[4], all = 0;
    for (unsigned i = 0; i < 4; ++i) {
      all += area[i] = area_in(triangles_.data(), near.data(), near.size(), piece.child(hilbert_quadrant(piece.state, i)));
    }
    double begin = piece.begin;
    for (unsigned i = 0; i < 4; ++i) {
      const double end = i == 3 ? piece.end : begin + (piece.end - piece.begin) * (all > 0 ? area[i] / all : 0.25);
      std::size_t next = last;
      if (i < 3) {
        next = first;
        while (next < last && parts_[next] < end) ++next;
      }
      if (next > first) {
        const unsigned quadrant = hilbert_quadrant(piece.state, i);
        const Piece child{piece.child(quadrant), hilbert_child_state(piece.state, i), begin, end};
        list_touching(near, child.quad, memory_.lists[static_cast<std::size_t>(depth) + 1]);
        descend(child, depth + 1, first, next);
      }
      first = next;
      begin = end;
    }
  }

  /// Maps what is left in the batch.
  void finish() {
    if (memory_.batch.count == 0) return;
    mapper_.place(memory_.batch, origin_, &places_[done_]);
    done_ += memory_.batch.count;
    memory_.batch.count = 0;
  }

  /// Says whether the surface's area is even in a piece of the leaf that these triangles touch.
  bool is_even(const std::vector<std::uint32_t>& near) {
    double least = triangles_[near[0]].area_ratio, most = least;
    for (const std::uint32_t t : near) {
      least = std::min(least, triangles_[t].area_ratio);
      most = std::max(most, triangles_[t].area_ratio);
    }
    return most <= kEven * least && is_covered();
  }

  /// Says whether the disc covers the leaf.
  bool is_covered() {
    if (!is_covered_) {
      const std::vector<std::uint32_t>& all = memory_.lists[0];
      is_covered_ = covered_in(triangles_.data(), all.data(), all.size(), leaf_) > 1 - kUncovered;
    }
    return *is_covered_;
  }

  void list_touching(const std::vector<std::uint32_t>& near, const Quad& quad, std::vector<std::uint32_t>& list) const {
    list.clear();
    for (const std::uint32_t t : near) {
      if (touches(triangles_[t], quad)) list.push_back(t);
    }
    if (list.empty()) list = near;  // rounding says that none touches
  }

  void put(const Piece& piece, const std::vector<std::uint32_t>& near, std::size_t i) {
    const double size = piece.end - piece.begin;
    const double part = size > 0 ? (parts_[i] - piece.begin) / size : 0;
    const Vec2d uv = place_in_quad<kTables>(piece.quad, piece.state, part);
    LeafBatch& batch = memory_.batch;
    batch.u[batch.count] = uv.x();
    batch.v[batch.count] = uv.y();
    batch.under[batch.count] = memory_.numbers[near.size() == 1 ? near[0] : deepest_triangle(triangles_, near, uv.x(), uv.y())];
    if (++batch.count == LeafBatch::kSize) finish();
  }

  const SurfaceMapper& mapper_;
  std::span<const ParameterTriangle> triangles_;
  const Vec3d& origin_;
  const double grain_;
  std::span<const double> parts_;
  std::span<SurfacePlace> places_;
  Memory& memory_;
  std::size_t done_ = 0;
  Quad leaf_;
  std::optional<bool> is_covered_;  // the leaf, by its disc; once asked for
};

LeafSurface::LeafSurface(std::shared_ptr<const CurveBase> base, std::shared_ptr<const SurfaceCurve> curve)
    : base_(std::move(base)), curve_(std::move(curve)) {}

std::size_t LeafSurface::disc_of(std::size_t l) const {
  const auto end_of_disc = std::upper_bound(curve_->disc_begin.begin(), curve_->disc_begin.end(), l);
  return static_cast<std::size_t>(end_of_disc - curve_->disc_begin.begin()) - 1;
}

void LeafSurface::find(std::size_t l, std::span<const double> parts, double grain, std::span<SurfacePlace> places) const {
  const std::size_t disc = disc_of(l);
  if (!base_->is_sound(disc)) {
    std::fill(places.begin(), places.end(), SurfacePlace{});
    return;
  }
  Memory& memory = memory_.local();
  memory.lists.resize(kMaxDepth + 1);
  memory.batch.count = 0;
  const Piece leaf = whole_leaf(*curve_, l);
  TouchingTriangles& touching = memory.touching.try_emplace(disc, base_->mesh_of(disc)).first->second;
  touching.find(leaf.quad, base_->triangle_in(disc, curve_->triangle[l]), memory.numbers);
  const ChartTriangles triangles(base_->charts[disc]);
  memory.triangles.clear();
  for (const std::uint32_t t : memory.numbers) memory.triangles.push_back(triangles.whole(t));
  Finder(*this, disc, grain, parts, places, memory).find(leaf);
}

void LeafSurface::find_even(std::span<const LeafPart> at, std::span<SurfacePlace> places) const {
  LeafBatch& batch = memory_.local().batch;
  batch.count = 0;
  std::size_t done = 0, disc = SIZE_MAX;
  const auto finish = [&] {
    if (batch.count == 0) return;
    base_->mappers[disc].place(batch, curve_->origin, &places[done]);
    done += batch.count;
    batch.count = 0;
  };
  for (std::size_t begin = 0, end; begin < at.size(); begin = end) {
    const std::uint32_t l = at[begin].leaf;
    for (end = begin + 1; end < at.size() && at[end].leaf == l;) ++end;
    if (disc == SIZE_MAX || l < curve_->disc_begin[disc] || l >= curve_->disc_begin[disc + 1]) {
      finish();
      disc = disc_of(l);
    }
    if (!base_->is_sound(disc)) {
      finish();
      for (; done < end; ++done) places[done] = {};
      continue;
    }
    const Piece leaf = whole_leaf(*curve_, l);
    const ParameterMesh mesh = base_->mesh_of(disc);
    const std::uint32_t own = base_->triangle_in(disc, curve_->triangle[l]);
    for (std::size_t i = begin; i < end; ++i) {
      const Vec2d uv = place_in_quad<kEvenTables>(leaf.quad, leaf.state, at[i].part);
      batch.u[batch.count] = uv.x();
      batch.v[batch.count] = uv.y();
      batch.under[batch.count] = find_triangle(mesh, uv, own);
      if (++batch.count == LeafBatch::kSize) finish();
    }
  }
  finish();
}

const SurfaceData* LeafSurface::data_of(std::size_t l, std::uint32_t face) const {
  const std::size_t disc = disc_of(l);
  return base_->is_sound(disc) && base_->has_face(disc, face) ? &base_->data : nullptr;
}

Rgba8 LeafSurface::colour(std::size_t l, std::uint32_t face, std::array<float, 2> weights, double share) const {
  const SurfaceData* const data = data_of(l, face);
  if (data == nullptr) return {};
  const double area = std::min(static_cast<double>(curve_->area[l]), share * curve_->total_area);
  return data->colour->at(face, {1 - weights[0] - weights[1], weights[0], weights[1]}, area);
}

}  // namespace curvecast
