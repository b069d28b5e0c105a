#include "core/refine/split_leaves.h"

#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "core/curve/area_element.h"
#include "core/curve/crease_band.h"
#include "core/curve/curve_columns.h"

namespace curvecast {
namespace {

constexpr std::size_t kBlock = 256;  // leaves that one task divides
constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();

/// What one task makes: the new leaves of a few old ones, in curve order.
struct Piece {
  std::vector<std::uint64_t> key;
  std::vector<std::uint8_t> level;
  std::vector<std::uint32_t> x, y;   // see QuadtreeLeaves
  std::vector<std::uint32_t> count;  // of triangles
  std::vector<std::uint32_t> triangles;
  std::vector<std::uint32_t> children;  // of each old leaf
};

/// Divides leaves of one disc, one at a time.
class Splitter {
 public:
  Splitter(const CurveBase& base, std::size_t disc)
      : base_(base), disc_(disc), mesh_(base.mesh_of(disc)), touching_(mesh_), lists_(kMaxLevel + 1) {}

  void split(const SurfaceCurve& curve, std::size_t l, int levels, Piece& piece) {
    const std::uint64_t key = curve.key[l];
    const int level = curve.level[l];
    const Quad quad = leaf_quad(key, static_cast<std::uint8_t>(level));
    HilbertState state = 0;
    for (int depth = 1; depth <= level; ++depth) state = hilbert_child_state(state, key >> 2 * (kMaxLevel - depth) & 3);
    touching_.find(quad, base_.triangle_in(disc_, curve.triangle[l]), lists_[level]);
    const std::size_t before = piece.key.size();
    divide({quad, key, level, state}, level + levels, piece);
    piece.children.push_back(static_cast<std::uint32_t>(piece.key.size() - before));
  }

 private:
  struct Node {
    Quad quad;
    std::uint64_t key;
    int level;
    HilbertState state;
  };

  /// lists_[node.level] are the node's triangles.
  void divide(const Node& node, int last, Piece& piece) {
    const std::vector<std::uint32_t>& near = lists_[node.level];
    if (node.level == last) {
      piece.key.push_back(node.key);
      piece.level.push_back(static_cast<std::uint8_t>(last));
      piece.x.push_back(static_cast<std::uint32_t>(node.quad.corner.x() / kCellSide));
      piece.y.push_back(static_cast<std::uint32_t>(node.quad.corner.y() / kCellSide));
      piece.count.push_back(static_cast<std::uint32_t>(near.size()));
      piece.triangles.insert(piece.triangles.end(), near.begin(), near.end());
      return;
    }
    const double half = side_of_level(node.level + 1);
    const std::uint64_t step = std::uint64_t{1} << 2 * (kMaxLevel - node.level - 1);
    for (unsigned i = 0; i < 4; ++i) {
      const unsigned quadrant = hilbert_quadrant(node.state, i);
      const Quad quad{node.quad.corner + Vec2d(quadrant & 1 ? half : 0, quadrant & 2 ? half : 0), half};
      std::vector<std::uint32_t>& inside = lists_[node.level + 1];
      inside.clear();
      if (near.size() == 1) {
        inside.push_back(near[0]);  // the quad lies within it
      } else {
        for (const std::uint32_t t : near) {
          if (touches(mesh_.triangles[t], quad)) inside.push_back(t);
        }
      }
      // Rounding may say that none touches: then the child takes what its parent has.
      if (inside.empty()) inside = near;
      divide({quad, node.key + i * step, node.level + 1, hilbert_child_state(node.state, i)}, last, piece);
    }
  }

  const CurveBase& base_;
  const std::size_t disc_;
  const ParameterMesh mesh_;
  TouchingTriangles touching_;
  std::vector<std::vector<std::uint32_t>> lists_;  // by level
};

/// All new leaves of a disc; `children`: of each old leaf that was divided.
struct NewLeaves {
  QuadtreeLeaves leaves;
  std::vector<std::uint32_t> children;
};

/// Returns the triangles that the leaves have, ascending, and makes the leaves' own numbers places in this list.
std::vector<std::uint32_t> renumber_triangles(QuadtreeLeaves& leaves) {
  std::vector<std::uint32_t> numbers(leaves.triangles.begin(), leaves.triangles.end());
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
  for (std::uint32_t& t : leaves.triangles) {
    t = static_cast<std::uint32_t>(std::lower_bound(numbers.begin(), numbers.end(), t) - numbers.begin());
  }
  return numbers;
}

absl::StatusOr<NewLeaves> divide_disc(const CurveBase& base, const SurfaceCurve& curve, std::size_t disc,
                                      std::span<const std::uint8_t> levels, std::span<const std::uint32_t> divided,
                                      const ExecutionContext& context) {
  std::vector<Piece> pieces((divided.size() + kBlock - 1) / kBlock);
  tbb::enumerable_thread_specific<Splitter> splitters([&] { return Splitter(base, disc); });
  tbb::parallel_for(std::size_t{0}, pieces.size(), [&](std::size_t i) {
    if (context.cancelled()) return;
    Splitter& splitter = splitters.local();
    for (std::size_t k = i * kBlock; k < std::min((i + 1) * kBlock, divided.size()); ++k) {
      splitter.split(curve, divided[k], levels[divided[k]], pieces[i]);
    }
  });
  if (absl::Status status = context.check(); !status.ok()) return status;
  std::uint64_t count = 0, triangles = 0;
  for (const Piece& piece : pieces) count += piece.key.size(), triangles += piece.triangles.size();
  if (triangles >= kMost) {
    return absl::ResourceExhaustedError("the new leaves would meet triangles more than 2^32 times: ask for fewer points");
  }
  NewLeaves out;
  QuadtreeLeaves& leaves = out.leaves;
  leaves.key.resize(count);
  leaves.level.resize(count);
  leaves.x.resize(count);
  leaves.y.resize(count);
  leaves.triangle_begin.resize(count + 1);
  leaves.triangles.resize(triangles);
  std::size_t l = 0, t = 0;
  for (Piece& piece : pieces) {
    std::copy(piece.key.begin(), piece.key.end(), leaves.key.begin() + l);
    std::copy(piece.level.begin(), piece.level.end(), leaves.level.begin() + l);
    std::copy(piece.x.begin(), piece.x.end(), leaves.x.begin() + l);
    std::copy(piece.y.begin(), piece.y.end(), leaves.y.begin() + l);
    std::copy(piece.triangles.begin(), piece.triangles.end(), leaves.triangles.begin() + t);
    for (const std::uint32_t n : piece.count) {
      leaves.triangle_begin[l++] = static_cast<std::uint32_t>(t);
      t += n;
    }
    out.children.insert(out.children.end(), piece.children.begin(), piece.children.end());
    piece = {};
  }
  leaves.triangle_begin[l] = static_cast<std::uint32_t>(t);
  return out;
}

/// Entries [from, from + count) of the old curve, or of the new vertices, that go to [to, to + count).
struct Run {
  bool is_new;
  std::size_t from, to, count;
};

/// Long runs are cut, so that threads share the copying.
std::vector<Run> make_runs(std::size_t old_size, std::span<const std::uint32_t> divided,
                           std::span<const std::uint32_t> children) {
  constexpr std::size_t kLongest = 65'536;
  std::vector<Run> runs;
  std::size_t to = 0, fresh = 0;
  const auto add = [&](bool is_new, std::size_t from, std::size_t count) {
    if (count == 0) return;
    if (!runs.empty() && runs.back().is_new == is_new && runs.back().count + count <= kLongest) {
      runs.back().count += count;
      to += count;
      return;
    }
    for (std::size_t done = 0; done < count; done += kLongest) {
      const std::size_t part = std::min(kLongest, count - done);
      runs.push_back({is_new, from + done, to, part});
      to += part;
    }
  };
  std::size_t old = 0;
  for (std::size_t i = 0; i < divided.size(); ++i) {
    add(false, old, divided[i] - old);
    add(true, fresh, children[i]);
    fresh += children[i];
    old = divided[i] + 1;
  }
  add(false, old, old_size - old);
  return runs;
}

void merge(std::span<const Run> runs, const SurfaceCurve& old, const SurfaceCurve& fresh, SurfaceCurve& out) {
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, runs.size(), 64), [&](const auto& range) {
    for (std::size_t r = range.begin(); r < range.end(); ++r) {
      const Run& run = runs[r];
      const SurfaceCurve& source = run.is_new ? fresh : old;
      const auto copy = [&run](const auto& from, auto& to) {
        std::copy_n(from.data() + run.from, run.count, to.data() + run.to);
      };
      visit_column_members([&](const char* /*name*/, auto column, ColumnLength /*length*/) {
        if (!(out.*column).empty()) copy(source.*column, out.*column);
      });
      for (std::size_t s = 0; s < out.scalars.size(); ++s) copy(source.scalars[s].values, out.scalars[s].values);
    }
  });
}

/// Makes the children's areas add up to their parent's: whatever it stood for, its points go on to them.
void share_areas(const SurfaceCurve& old, std::span<const std::uint32_t> divided, std::span<const std::uint32_t> children,
                 std::span<float> area) {
  std::size_t begin = 0;
  for (std::size_t i = 0; i < divided.size(); ++i) {
    const std::span<float> mine = area.subspan(begin, children[i]);
    double sum = 0;
    for (const float a : mine) sum += static_cast<double>(a);
    const double factor = sum > 0 ? static_cast<double>(old.area[divided[i]]) / sum : 0;
    for (float& a : mine) a = static_cast<float>(a * factor);
    begin += children[i];
  }
}

/// Gives the children what lies beside their parents.
void inherit_beside(const SurfaceCurve& old, std::span<const std::uint32_t> divided, std::span<const std::uint32_t> children,
                    SurfaceCurve& fresh) {
  std::size_t child = 0;
  for (std::size_t i = 0; i < divided.size(); ++i) {
    for (const std::size_t end = child + children[i]; child < end; ++child) {
      fresh.beside[child] = beside_within(old, divided[i], fresh.normal(child));
    }
  }
}

}  // namespace

absl::StatusOr<SurfaceCurve> split_leaves(const CurveBase& base, const SurfaceCurve& curve, std::span<const std::uint8_t> levels,
                                          const ExecutionContext& context) {
  SurfaceCurve out = next_revision(curve);
  std::vector<std::uint32_t> divided, children;  // of all discs
  std::vector<NewLeaves> discs;
  std::vector<std::size_t> fresh_begin(1, 0);
  out.disc_begin.assign(1, 0);
  std::uint64_t total = 0;
  for (std::size_t d = 0; d < base.charts.size(); ++d) {
    context.progress("curve", static_cast<double>(d) / static_cast<double>(base.charts.size()));
    const std::size_t first = divided.size();
    for (std::uint32_t l = curve.disc_begin[d]; l < curve.disc_begin[d + 1]; ++l) {
      if (levels[l] > 0) divided.push_back(l);
    }
    const std::span mine = std::span<const std::uint32_t>(divided).subspan(first);
    if (!mine.empty() && !base.is_sound(d)) return base.status();
    absl::StatusOr<NewLeaves> made = mine.empty() ? NewLeaves{} : divide_disc(base, curve, d, levels, mine, context);
    if (!made.ok()) return made.status();
    fresh_begin.push_back(fresh_begin.back() + made->leaves.size());
    total += curve.disc_begin[d + 1] - curve.disc_begin[d] - mine.size() + made->leaves.size();
    if (total >= kMost) return absl::ResourceExhaustedError("the curve would need more than 2^32 vertices: ask for fewer points");
    out.disc_begin.push_back(static_cast<std::uint32_t>(total));
    children.insert(children.end(), made->children.begin(), made->children.end());
    discs.push_back(*std::move(made));
  }

  context.progress("map", 0);
  SurfaceCurve fresh = next_revision(curve);
  fresh.resize(fresh_begin.back(), base.data.colour != nullptr, !curve.beside.empty());
  for (std::size_t d = 0; d < discs.size(); ++d) {
    QuadtreeLeaves& leaves = discs[d].leaves;
    if (leaves.size() == 0) continue;
    Column<std::uint32_t> under;
    under.resize(leaves.size());
    const std::vector<std::uint32_t> numbers = renumber_triangles(leaves);
    const ChartTriangles of_chart(base.charts[d]);
    std::vector<ParameterTriangle> triangles;
    triangles.reserve(numbers.size());
    for (const std::uint32_t t : numbers) triangles.push_back(of_chart.whole(t));
    locate_centres(triangles, leaves, under);
    area_elements(triangles, base.charts[d].fills_square, leaves, {fresh.area.data() + fresh_begin[d], leaves.size()});
    for (std::uint32_t& t : under) t = numbers[t];
    map_to_surface(base.mappers[d], leaves, under, fresh_begin[d], fresh);
    discs[d] = {};
    if (absl::Status status = context.check(); !status.ok()) return status;
  }
  share_areas(curve, divided, children, fresh.area);
  if (!curve.beside.empty()) inherit_beside(curve, divided, children, fresh);
  out.resize(total, base.data.colour != nullptr, !curve.beside.empty());
  merge(make_runs(curve.size(), divided, children), curve, fresh, out);
  context.progress("map", 1);
  return out;
}

}  // namespace curvecast
