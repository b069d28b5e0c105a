#include "core/flatten/edge_paths.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <queue>

namespace curvecast {

EdgePaths::EdgePaths(const TriangleMesh& mesh) : mesh_(mesh), begin_(mesh.vertex_count() + 1, 0) {
  const auto for_each_end = [&](auto&& visit) {
    for (std::uint32_t h = 0; h < mesh.twins.size(); ++h) {
      visit(mesh.from(h), h);
      if (mesh.twins[h] == kNone) visit(mesh.to(h), h);
    }
  };
  for_each_end([&](std::uint32_t v, std::uint32_t) { ++begin_[v + 1]; });
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  halfedges_.resize(begin_.back());
  std::vector<std::uint32_t> cursor(begin_.begin(), begin_.end() - 1);
  for_each_end([&](std::uint32_t v, std::uint32_t h) { halfedges_[cursor[v]++] = h; });
  clear();
}

void EdgePaths::clear() {
  distance_.assign(mesh_.vertex_count(), std::numeric_limits<double>::infinity());
  parent_.assign(mesh_.vertex_count(), kNone);
}

void EdgePaths::add_sources(std::span<const std::uint32_t> vertices) {
  grow(
      vertices, [](std::uint32_t) { return 0.0; }, [](double) { return false; });
}

void EdgePaths::add_sources(std::span<const std::uint32_t> vertices, std::span<const std::uint32_t> targets) {
  const auto left = [&](std::uint32_t v) {
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t t : targets) least = std::min(least, (mesh_.positions[t] - mesh_.positions[v]).squaredNorm());
    // Rounding must not make the line longer than the path.
    return (1 - 1e-12) * std::sqrt(least);
  };
  const auto is_over = [&](double shortest) {
    return std::ranges::all_of(targets, [&](std::uint32_t t) { return distance_[t] <= shortest; });
  };
  grow(vertices, left, is_over);
}

/// Grows from new sources, those vertices first where the path so far and `left(v)`, the least that is to come, are shortest;
/// until no path can be shortened, or `is_over(shortest)` of that sum.
template <typename Left, typename IsOver>
void EdgePaths::grow(std::span<const std::uint32_t> sources, const Left& left, const IsOver& is_over) {
  struct Entry {
    double sum;
    double distance;
    std::uint32_t vertex;
    bool operator>(const Entry& other) const { return sum != other.sum ? sum > other.sum : vertex > other.vertex; }
  };
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (const std::uint32_t v : sources) {
    distance_[v] = 0;
    parent_[v] = kNone;
    queue.push({left(v), 0, v});
  }
  while (!queue.empty()) {
    const Entry next = queue.top();
    if (is_over(next.sum)) return;
    queue.pop();
    const std::uint32_t v = next.vertex;
    if (next.distance > distance_[v]) continue;
    for (std::uint32_t i = begin_[v]; i < begin_[v + 1]; ++i) {
      const std::uint32_t h = halfedges_[i];
      const std::uint32_t w = mesh_.from(h) == v ? mesh_.to(h) : mesh_.from(h);
      const double through = next.distance + (mesh_.positions[w] - mesh_.positions[v]).norm();
      if (through < distance_[w]) {
        distance_[w] = through;
        parent_[w] = h;
        queue.push({through + left(w), through, w});
      }
    }
  }
}

std::uint32_t EdgePaths::parent(std::uint32_t v) const {
  const std::uint32_t h = parent_[v];
  return mesh_.from(h) == v ? mesh_.to(h) : mesh_.from(h);
}

std::uint32_t EdgePaths::source(std::uint32_t v) const {
  while (parent_[v] != kNone) v = parent(v);
  return v;
}

std::uint32_t EdgePaths::farthest() const {
  std::uint32_t best = 0;
  double largest = -1;
  for (std::uint32_t v = 0; v < distance_.size(); ++v) {
    if (std::isfinite(distance_[v]) && distance_[v] > largest) {
      largest = distance_[v];
      best = v;
    }
  }
  return best;
}

std::uint32_t EdgePaths::farthest_from(std::uint32_t v) {
  clear();
  add_sources({&v, 1});
  return farthest();
}

}  // namespace curvecast
