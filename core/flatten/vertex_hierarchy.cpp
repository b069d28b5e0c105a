#include "core/flatten/vertex_hierarchy.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <limits>

namespace curvecast {
namespace {

constexpr float kNever = std::numeric_limits<float>::infinity();
// Of the vertices that could go, the share that a level considers: the others wait, so that features outlive what is flat.
constexpr double kShare = 0.7;
// Vertices that are asked for their costs to find out what is cheap.
constexpr std::size_t kProbes = 200;
// Moving a vertex by its distance from the surface counts in full, along the surface by this much: keeps triangles even.
constexpr double kTangential = 0.02;
// Levels that take less than one vertex in so many are not worth their while.
constexpr std::size_t kLeastShare = 200;

}  // namespace

VertexHierarchy::VertexHierarchy(const TriangleMesh& mesh, std::span<const std::uint32_t> pinned)
    : positions_(mesh.positions),
      triangles_(mesh.triangles),
      twins_(mesh.twins),
      outgoing_(mesh.vertex_count(), kNone),
      border_(mesh.vertex_count(), 0),
      degree_(mesh.vertex_count(), 0),
      pinned_(mesh.vertex_count(), false),
      locked_(mesh.vertex_count(), 0),
      gone_(mesh.vertex_count(), 0) {
  for (std::uint32_t h = 0; h < twins_.size(); ++h) {
    std::uint32_t& out = outgoing_[from(h)];
    if (out == kNone || twins_[h] == kNone) out = h;
    ++degree_[from(h)];
    if (twins_[h] != kNone) continue;
    border_[from(h)] = 1;
    ++degree_[to(h)];
  }
  for (const std::uint32_t v : pinned) pinned_[v] = true;
  for (std::uint32_t v = 0; v < outgoing_.size(); ++v) {
    if (outgoing_[v] != kNone) base_.push_back(v);
  }
}

/// Whether moving from(h) onto to(h) leaves a manifold of the same topology, with no inner edge between border vertices.
bool VertexHierarchy::may_collapse(std::uint32_t h) const {
  const std::uint32_t v = from(h);
  const std::uint32_t u = to(h);
  const std::uint32_t t = twins_[h];
  const std::uint32_t a = from(previous_halfedge(h));
  const std::uint32_t b = t == kNone ? kNone : from(previous_halfedge(t));
  const bool v_border = on_border(v);
  const bool u_border = on_border(u);
  if (v_border && t != kNone) return false;
  if (a == b) return false;
  const std::uint32_t size = degree_[v];
  // Vertices of many neighbours stay as they are; the last vertex inside a triangle may still go.
  if (size > kMaxDegree || (size > 3 && degree_[u] + size > kMaxDegree + 4)) return false;
  const auto may_lose_one = [&](std::uint32_t x) { return on_border(x) || degree_[x] > 3; };
  if (!may_lose_one(a) || (b != kNone && !may_lose_one(b)) || (size == 3 && !may_lose_one(u))) return false;
  std::array<std::uint32_t, kMaxDegree> ring;
  std::uint32_t filled = 0;
  bool fits = true;
  for_each_neighbour(v, [&](std::uint32_t x) {
    // A new edge from u to x.
    fits = fits && !(u_border && !v_border && x != u && x != a && x != b && on_border(x));
    ring[filled++] = x;
  });
  if (!fits) return false;
  if (v_border && ring[size - 1] == a) return false;  // a triangle with two sides on the border
  std::uint32_t shared = 0;
  for_each_neighbour(u, [&](std::uint32_t x) {
    for (std::uint32_t i = 0; i < size; ++i) shared += ring[i] == x;
  });
  return shared == (t == kNone ? 1u : 2u);
}

/// The cheapest way for v to go. The cost of a step is its squared distances from the planes around, weighted by area, and a
/// little for every step along them.
VertexHierarchy::Candidate VertexHierarchy::best_candidate(std::uint32_t v) const {
  constexpr Candidate kStays{kNever, kNone};
  if (pinned_[v] || degree_[v] > kMaxDegree) return kStays;
  struct Neighbour {
    Vec3d step;              // from v
    std::uint32_t halfedge;  // to it; kNone for the previous one on a border
    Vec3d normal;            // of the triangle with the next neighbour, twice its area long
    double length = 0;       // of that normal
    double cost = kNever;
    bool checked = false;
  };
  std::array<Neighbour, kMaxDegree> ring;
  std::size_t size = 0;
  const Vec3d p = positions_[v];
  const bool border = on_border(v);
  std::uint32_t h = outgoing_[v];
  for (;;) {
    ring[size].step = positions_[to(h)] - p;
    ring[size].halfedge = h;
    ++size;
    const std::uint32_t back = previous_halfedge(h);
    h = twins_[back];
    if (h == kNone) {
      ring[size].step = positions_[from(back)] - p;
      ring[size].halfedge = kNone;
      ++size;
      break;
    }
    if (h == outgoing_[v]) break;
  }
  const std::size_t triangles = border ? size - 1 : size;
  double area = 0;
  for (std::size_t i = 0; i < triangles; ++i) {
    ring[i].normal = ring[i].step.cross(ring[i + 1 < size ? i + 1 : 0].step);
    ring[i].length = ring[i].normal.norm();
    area += ring[i].length;
  }
  const std::size_t targets = border ? 1 : size;
  for (std::size_t t = 0; t < targets; ++t) {
    double planes = 0;
    for (std::size_t i = 0; i < triangles; ++i) {
      const double height = ring[t].step.dot(ring[i].normal);
      if (ring[i].length > 0) planes += height * height / ring[i].length;
    }
    ring[t].cost = planes + kTangential * ring[t].step.squaredNorm() * area;
  }
  const auto folds = [&](std::size_t t) {
    for (std::size_t i = 0; i < triangles; ++i) {
      const std::size_t j = i + 1 < size ? i + 1 : 0;
      if (i == t || j == t) continue;
      const Vec3d moved = (ring[i].step - ring[t].step).cross(ring[j].step - ring[t].step);
      if (moved.dot(ring[i].normal) <= 0.2 * ring[i].length * moved.norm()) return true;
    }
    return false;
  };
  for (;;) {
    const auto best = std::min_element(ring.begin(), ring.begin() + static_cast<std::ptrdiff_t>(targets),
                                       [](const Neighbour& x, const Neighbour& y) { return x.cost < y.cost; });
    if (best->cost == kNever) return kStays;
    if (!best->checked) {
      best->checked = true;
      if (!may_collapse(best->halfedge)) {
        best->cost = kNever;
      } else if (folds(static_cast<std::size_t>(best - ring.begin()))) {
        best->cost += best->step.squaredNorm() * area;
      }
      continue;
    }
    return {static_cast<float>(best->cost), best->halfedge};
  }
}

/// Gives the start of every halfedge around the start of h, in the fan that h belongs to, the name v.
void VertexHierarchy::relabel(std::uint32_t h, std::uint32_t v) {
  std::uint32_t out = h;
  do {
    triangles_[out / 3][out % 3] = v;
    out = twins_[previous_halfedge(out)];
  } while (out != kNone && out != h);
}

void VertexHierarchy::collapse(std::uint32_t h) {
  const std::uint32_t v = from(h);
  const std::uint32_t u = to(h);
  const std::uint32_t t = twins_[h];
  const std::uint32_t n = next_halfedge(h);      // u -> a
  const std::uint32_t p = previous_halfedge(h);  // a -> v
  const std::uint32_t a = from(p);
  // The two triangles at the edge keep their corners for the way back; the others of the fan get theirs from the far side.
  for (std::uint32_t out = twins_[p]; out != kNone && out / 3 != (t == kNone ? kNone : t / 3);
       out = twins_[previous_halfedge(out)]) {
    triangles_[out / 3][out % 3] = u;
  }
  const auto join = [&](std::uint32_t x, std::uint32_t y) {
    if (x != kNone) twins_[x] = y;
    if (y != kNone) twins_[y] = x;
  };
  const std::uint32_t beyond_n = twins_[n];
  const std::uint32_t beyond_p = twins_[p];
  if (outgoing_[a] == p) outgoing_[a] = beyond_n;
  if (outgoing_[u] == n || outgoing_[u] == t) outgoing_[u] = beyond_p;
  --degree_[a];
  degree_[u] += degree_[v] - (t == kNone ? 3 : 4);
  if (t != kNone) {
    const std::uint32_t n1 = next_halfedge(t);      // v -> b
    const std::uint32_t p1 = previous_halfedge(t);  // b -> u
    const std::uint32_t b = from(p1);
    if (outgoing_[b] == p1) outgoing_[b] = twins_[n1];
    --degree_[b];
    join(twins_[n1], twins_[p1]);
  }
  join(beyond_n, beyond_p);
  outgoing_[v] = h;
}

/// Undoes collapse(h): everything around is as it was right after it.
void VertexHierarchy::restore(std::uint32_t h) {
  const std::uint32_t v = from(h);
  const std::uint32_t u = to(h);
  const std::uint32_t t = twins_[h];
  const std::uint32_t n = next_halfedge(h);
  const std::uint32_t p = previous_halfedge(h);
  const auto reattach = [&](std::uint32_t x) {
    if (twins_[x] != kNone) twins_[twins_[x]] = x;
  };
  reattach(n);
  reattach(p);
  if (t != kNone) {
    const std::uint32_t n1 = next_halfedge(t);
    const std::uint32_t p1 = previous_halfedge(t);
    reattach(n1);
    reattach(p1);
    if (twins_[p1] == kNone) outgoing_[from(p1)] = p1;
  }
  relabel(h, v);
  if (from(outgoing_[u]) != u) outgoing_[u] = n;
}

/// The cost below which kShare of the vertices lie, going by some of them.
float VertexHierarchy::typical_cost() const {
  const std::size_t step = std::max<std::size_t>(1, base_.size() / kProbes);
  std::vector<Candidate> probes((base_.size() + step - 1 - step / 2) / step);
  tbb::parallel_for(tbb::blocked_range<std::size_t>(0, probes.size(), 64), [&](const auto& range) {
    for (std::size_t i = range.begin(); i < range.end(); ++i) probes[i] = best_candidate(base_[step / 2 + i * step]);
  });
  std::vector<float> costs;
  for (const Candidate& c : probes) {
    if (c.halfedge != kNone) costs.push_back(c.cost);
  }
  if (costs.empty()) return kNever;
  const auto limit = costs.begin() + static_cast<std::ptrdiff_t>(kShare * static_cast<double>(costs.size() - 1));
  std::nth_element(costs.begin(), limit, costs.end());
  return *limit;
}

/// Whether the face of h is gone: with it went one of its corners.
bool VertexHierarchy::is_gone(std::uint32_t h) const {
  return std::ranges::any_of(triangles_[h / 3], [&](std::uint32_t v) { return gone_[v] != 0; });
}

/// Collapses h. The neighbours stay, in this level.
void VertexHierarchy::remove(std::uint32_t h, std::vector<std::uint32_t>& removed) {
  const auto mark = static_cast<std::uint32_t>(levels_.size() + 1);
  for_each_neighbour(from(h), [&](std::uint32_t x) { locked_[x] = mark; });
  collapse(h);
  gone_[from(h)] = 1;
  removed.push_back(h);
}

void VertexHierarchy::remove_cheap(std::span<const std::uint32_t> vertices, float highest, std::vector<std::uint32_t>& removed) {
  for (const std::uint32_t v : vertices) {
    if (locked_[v] == levels_.size() + 1) continue;
    if (const Candidate c = best_candidate(v); c.halfedge != kNone && c.cost <= highest) remove(c.halfedge, removed);
  }
}

/// Block by block what is away from their seams, and the rest after it.
void VertexHierarchy::remove_in_blocks(Level& level) {
  struct Block {
    std::vector<std::uint32_t> vertices, removed;
  };
  std::vector<Block> blocks(blocks_.count());
  std::vector<std::uint32_t> near;
  for (const std::uint32_t v : base_) (blocks_.is_away(v) ? blocks[blocks_.block(v)].vertices : near).push_back(v);
  tbb::parallel_for(std::size_t{0}, blocks.size(),
                    [&](std::size_t i) { remove_cheap(blocks[i].vertices, level.highest, blocks[i].removed); });
  for (const Block& block : blocks) level.halfedges.insert(level.halfedges.end(), block.removed.begin(), block.removed.end());
  for (const std::uint32_t v : near) {
    const std::size_t count = level.halfedges.size();
    remove_cheap({&v, 1}, level.highest, level.halfedges);
    if (level.halfedges.size() > count) blocks_.spread_seams(to(level.halfedges.back()), *this);
  }
}

/// Ends a level. False where nothing went.
bool VertexHierarchy::finish(Level level) {
  if (level.halfedges.empty()) return false;
  std::erase_if(base_, [&](std::uint32_t v) { return gone_[v] != 0; });
  levels_.push_back(std::move(level));
  return true;
}

void VertexHierarchy::coarsen(std::size_t target, const ExecutionContext& context) {
  while (base_.size() > target && !context.cancelled()) {
    Level level{.highest = typical_cost()};
    blocks_.set_count(VertexBlocks::wanted(base_.size()), *this, positions_);
    if (blocks_.count() > 1) {
      remove_in_blocks(level);
    } else {
      remove_cheap(base_, level.highest, level.halfedges);
    }
    if (!finish(std::move(level)) || levels_.back().halfedges.size() < base_.size() / kLeastShare) break;
  }
}

void VertexHierarchy::coarsen_like(std::span<const Level> levels, const ExecutionContext& context) {
  if (levels.empty()) return;
  std::vector<std::uint32_t> strays;  // beside a cut, or left behind
  std::vector<bool> strays_now(border_.begin(), border_.end());
  for (const std::uint32_t v : base_) {
    if (strays_now[v]) strays.push_back(v);
  }
  for (const Level& other : levels) {
    if (context.cancelled()) return;
    Level level{.highest = other.highest};
    remove_cheap(strays, level.highest, level.halfedges);
    for (const std::uint32_t h : other.halfedges) {
      if (is_gone(h)) continue;
      const std::uint32_t v = from(h);
      if (locked_[v] != levels_.size() + 1 && !pinned_[v] && may_collapse(h)) {
        remove(h, level.halfedges);
      } else if (!strays_now[v]) {
        strays_now[v] = true;
        strays.push_back(v);
      }
    }
    std::erase_if(strays, [&](std::uint32_t v) { return gone_[v] != 0; });
    finish(std::move(level));
  }
}

std::vector<std::uint32_t> VertexHierarchy::level(std::size_t l) const {
  std::vector<std::uint32_t> vertices;
  vertices.reserve(levels_[l].halfedges.size());
  for (const std::uint32_t h : levels_[l].halfedges) vertices.push_back(from(h));
  return vertices;
}

void VertexHierarchy::restore_level() {
  const std::vector<std::uint32_t>& halfedges = levels_.back().halfedges;
  for (auto h = halfedges.rbegin(); h != halfedges.rend(); ++h) restore(*h);
  levels_.pop_back();
}

TriangleMesh VertexHierarchy::base_mesh() const {
  std::vector<std::uint32_t> face(triangles_.size(), 0);
  for (const Level& level : levels_) {
    for (const std::uint32_t h : level.halfedges) {
      face[h / 3] = kNone;
      if (twins_[h] != kNone) face[twins_[h] / 3] = kNone;
    }
  }
  std::vector<std::uint32_t> vertex(positions_.size(), kNone);
  TriangleMesh mesh;
  for (const std::uint32_t v : base_) {
    vertex[v] = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(positions_[v]);
  }
  for (std::uint32_t f = 0; f < face.size(); ++f) {
    if (face[f] == kNone) continue;
    face[f] = static_cast<std::uint32_t>(mesh.triangles.size());
    const Triangle& t = triangles_[f];
    mesh.triangles.push_back({vertex[t[0]], vertex[t[1]], vertex[t[2]]});
  }
  mesh.twins.reserve(3 * mesh.triangles.size());
  for (std::uint32_t h = 0; h < twins_.size(); ++h) {
    if (face[h / 3] == kNone) continue;
    mesh.twins.push_back(twins_[h] == kNone ? kNone : 3 * face[twins_[h] / 3] + twins_[h] % 3);
  }
  return mesh;
}

}  // namespace curvecast
