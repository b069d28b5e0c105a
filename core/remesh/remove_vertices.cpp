#include "core/remesh/remove_vertices.h"

#include <algorithm>
#include <limits>
#include <vector>

namespace curvecast {
namespace {

constexpr char kStage[] = "triangulate";
constexpr double kNever = -std::numeric_limits<double>::infinity();

}  // namespace

VertexRemover::VertexRemover(HalfedgeMesh& mesh) : mesh_(mesh), flips_(mesh) {
  flips_.add_all();
  flips_.run();
}

/// Takes a vertex out, where a neighbour is found onto which it can go without triangles of less than `least` quality.
bool VertexRemover::remove_one(std::uint32_t v, double least) {
  const std::uint32_t h = best_target(v, least);
  if (h == kNone) return false;
  const std::uint32_t u = mesh_.to(h);
  mesh_.collapse(h);
  flips_.add_around(u);
  flips_.run();
  return true;
}

/// Turns an edge at v away, whatever the angles, where no triangle folds over by that.
bool VertexRemover::loosen(std::uint32_t v) {
  halfedges_.clear();
  mesh_.for_each_outgoing(v, [&](std::uint32_t h) { halfedges_.push_back(h); });
  for (const std::uint32_t h : halfedges_) {
    const std::uint32_t t = mesh_.twins[h];
    if (t == kNone) continue;
    const Vec3d &a = mesh_.positions[v], &b = mesh_.positions[mesh_.to(h)];
    const Vec3d &c = mesh_.positions[mesh_.apex(h)], &d = mesh_.positions[mesh_.apex(t)];
    const Vec3d before = (b - a).cross(c - a) + (a - b).cross(d - b);
    const auto faces_on = [&](const Vec3d& p) { return (d - c).cross(p - c).dot(before); };
    if (!(faces_on(a) < 0 && faces_on(b) > 0) || !mesh_.may_flip(h)) continue;
    mesh_.flip(h);
    return true;
  }
  return false;
}

/// The halfedge from v along which to move it: where the worst of the triangles that come of it is best.
std::uint32_t VertexRemover::best_target(std::uint32_t v, double least) {
  ring_.clear();
  halfedges_.clear();
  mesh_.for_each_outgoing(v, [&](std::uint32_t h) { halfedges_.push_back(h); });
  mesh_.for_each_neighbour(v, [&](std::uint32_t x) { ring_.emplace_back(mesh_.positions[x] - mesh_.positions[v]); });
  const bool border = mesh_.on_border(v);
  const std::size_t size = ring_.size(), triangles = border ? size - 1 : size;
  Vec3d normal = Vec3d::Zero();
  for (std::size_t i = 0; i < triangles; ++i) normal += ring_[i].cross(ring_[(i + 1) % size]);
  const double length = normal.norm();
  if (length > 0) normal /= length;
  const auto quality = [&](std::size_t target) {
    double worst = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < triangles && worst > least; ++i) {
      const std::size_t j = (i + 1) % size;
      if (i == target || j == target) continue;
      const Vec3d p = ring_[i] - ring_[target], q = ring_[j] - ring_[target];
      const double sides = p.squaredNorm() + q.squaredNorm() + (p - q).squaredNorm();
      worst = std::min(worst, sides > 0 ? p.cross(q).dot(normal) / sides : 0.0);
    }
    return worst;
  };
  candidates_.clear();
  for (std::size_t i = 0; i < (border ? 1 : size); ++i) {
    if (const double q = quality(i); q > least) candidates_.push_back({q, halfedges_[i]});
  }
  std::sort(candidates_.begin(), candidates_.end(), [](const Candidate& a, const Candidate& b) {
    return a.quality != b.quality ? a.quality > b.quality : a.halfedge < b.halfedge;
  });
  for (const Candidate& candidate : candidates_) {
    if (mesh_.may_collapse(candidate.halfedge)) return candidate.halfedge;
  }
  return kNone;
}

std::vector<std::uint32_t> VertexRemover::remove(std::span<const std::uint32_t> vertices, const ExecutionContext& context,
                                                 std::size_t most) {
  constexpr std::size_t kBlock = 4096;  // vertices between two looks whether the work was cancelled
  std::vector<std::uint32_t> left(vertices.begin(), vertices.end()), next;
  const auto all = static_cast<double>(left.size());
  std::size_t removed = 0;
  // Where a triangle would fold over a vertex waits for its neighbours to go; what waits in vain goes in spite of that.
  double least = 0;
  while (!left.empty() && removed < most) {
    next.clear();
    for (std::size_t i = 0; i < left.size(); ++i) {
      if (i % kBlock == 0) {
        if (context.cancelled()) return left;
        context.progress(kStage, 1 - static_cast<double>(left.size() - i + next.size()) / all);
      }
      if (removed < most && remove_one(left[i], least)) {
        ++removed;
      } else {
        next.push_back(left[i]);
      }
    }
    if (next.size() == left.size()) {
      if (least == kNever) break;
      least = kNever;
    }
    left.swap(next);
  }
  // What is still there may be held by edges between its neighbours: it lets go of these one by one.
  std::erase_if(left, [&](std::uint32_t v) {
    bool is_gone = false;
    while (removed < most && !context.cancelled() && !(is_gone = remove_one(v, kNever)) && loosen(v)) {
    }
    removed += is_gone ? 1 : 0;
    return is_gone;
  });
  return left;
}

}  // namespace curvecast
