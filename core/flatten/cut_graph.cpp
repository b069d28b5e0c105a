#include "core/flatten/cut_graph.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/flatten/edge_paths.h"
#include "core/flatten/union_find.h"
#include "core/mesh/topology.h"

namespace curvecast {
namespace {

struct WeightedEdge {
  double length;  // of the shortest loop through the edge
  std::uint32_t halfedge;
};

class CutGraph {
 public:
  explicit CutGraph(const TriangleMesh& mesh) : mesh_(mesh), paths_(mesh), cut_(mesh.twins.size(), false) {}

  std::vector<bool> build(const Topology& topology, std::span<const std::uint32_t> extremities) {
    if (topology.genus > 0 || topology.boundary_loops > 1) {
      open_handles(topology);
    } else if (topology.boundary_loops == 0) {
      open_sphere(extremities);
    }
    reach(extremities);
    return std::move(cut_);
  }

 private:
  /// Cuts a surface with handles, or several borders, into one with one border.
  void open_handles(const Topology& topology) {
    std::vector<std::uint32_t> roots = border_vertices();
    // A closed surface is opened from one of its extremities.
    if (roots.empty()) {
      roots = {paths_.farthest_from(0)};
      paths_.clear();
    }
    paths_.add_sources(roots);
    std::vector<bool> tree = tree_edges();
    if (topology.boundary_loops > 1) join_loops(tree);
    if (topology.genus == 0) return;
    cut_handles(tree);
    if (topology.boundary_loops == 0) prune();
  }

  /// Cuts a closed surface without handles from one vertex to another: the first extremities, or two that are far apart.
  void open_sphere(std::span<const std::uint32_t> extremities) {
    const std::uint32_t first = extremities.empty() ? paths_.farthest_from(0) : extremities[0];
    if (extremities.size() > 1) {
      paths_.add_sources({&first, 1}, extremities.subspan(1, 1));
      cut_path(extremities[1]);
    } else {
      cut_path(paths_.farthest_from(first));
    }
  }

  std::vector<std::uint32_t> border_vertices() const {
    std::vector<std::uint32_t> vertices;
    for (std::uint32_t h = 0; h < mesh_.twins.size(); ++h) {
      if (mesh_.twins[h] == kNone) vertices.push_back(mesh_.from(h));
    }
    return vertices;
  }

  void cut_edge(std::uint32_t h) {
    if (mesh_.twins[h] != kNone) cut_[h] = cut_[mesh_.twins[h]] = true;
  }

  /// Cuts along the shortest path from v to the sources.
  void cut_path(std::uint32_t v) {
    for (; paths_.parent_edge(v) != kNone; v = paths_.parent(v)) cut_edge(paths_.parent_edge(v));
  }

  void cut_loop(std::uint32_t h) {
    cut_edge(h);
    cut_path(mesh_.from(h));
    cut_path(mesh_.to(h));
  }

  std::vector<bool> tree_edges() const {
    std::vector<bool> tree(mesh_.twins.size(), false);
    for (std::uint32_t v = 0; v < mesh_.vertex_count(); ++v) {
      const std::uint32_t h = paths_.parent_edge(v);
      if (h == kNone) continue;
      tree[h] = true;
      if (mesh_.twins[h] != kNone) tree[mesh_.twins[h]] = true;
    }
    return tree;
  }

  std::vector<WeightedEdge> edges_off(const std::vector<bool>& tree) const {
    std::vector<WeightedEdge> edges;
    for (std::uint32_t h = 0; h < mesh_.twins.size(); ++h) {
      if (mesh_.twins[h] == kNone || mesh_.twins[h] < h || tree[h]) continue;
      const std::uint32_t a = mesh_.from(h);
      const std::uint32_t b = mesh_.to(h);
      edges.push_back({paths_.distance(a) + paths_.distance(b) + (mesh_.positions[b] - mesh_.positions[a]).norm(), h});
    }
    std::sort(edges.begin(), edges.end(), [](const WeightedEdge& a, const WeightedEdge& b) {
      return a.length != b.length ? a.length < b.length : a.halfedge < b.halfedge;
    });
    return edges;
  }

  /// Joins the border loops by the shortest paths that do (Kruskal over the loops' regions of influence).
  void join_loops(std::vector<bool>& tree) {
    UnionFind joined(mesh_.vertex_count());  // border loops first, then every vertex with its source
    for (std::uint32_t h = 0; h < mesh_.twins.size(); ++h) {
      if (mesh_.twins[h] == kNone) joined.unite(mesh_.from(h), mesh_.to(h));
    }
    for (std::uint32_t v = 0; v < mesh_.vertex_count(); ++v) {
      if (paths_.parent_edge(v) != kNone) joined.unite(v, paths_.parent(v));
    }
    for (const WeightedEdge& edge : edges_off(tree)) {
      const std::uint32_t h = edge.halfedge;
      if (!joined.unite(mesh_.from(h), mesh_.to(h))) continue;
      tree[h] = tree[mesh_.twins[h]] = true;
      cut_loop(h);
    }
  }

  /// Cuts the 2 g loops that open the handles: the edges that neither the tree nor the dual tree of longest loops takes.
  void cut_handles(const std::vector<bool>& tree) {
    UnionFind joined(mesh_.face_count());
    const std::vector<WeightedEdge> edges = edges_off(tree);
    for (auto edge = edges.rbegin(); edge != edges.rend(); ++edge) {
      if (!joined.unite(edge->halfedge / 3, mesh_.twins[edge->halfedge] / 3)) cut_loop(edge->halfedge);
    }
  }

  /// Takes loose ends back: the way to the root that no loop needs.
  void prune() {
    std::vector<std::uint32_t> degree(mesh_.vertex_count(), 0);
    for (std::uint32_t h = 0; h < cut_.size(); ++h) degree[mesh_.from(h)] += cut_[h];
    for (std::uint32_t start = 0; start < cut_.size(); ++start) {
      std::uint32_t h = start;
      while (h != kNone && cut_[h] && degree[mesh_.from(h)] == 1) {
        const std::uint32_t end = mesh_.to(h);
        cut_[h] = cut_[mesh_.twins[h]] = false;
        --degree[mesh_.from(h)];
        --degree[end];
        h = degree[end] == 1 ? cut_edge_at(next_halfedge(h)) : kNone;
      }
    }
  }

  /// A cut halfedge that leaves the start of h, turning around it; kNone when there is none. The mesh is closed.
  std::uint32_t cut_edge_at(std::uint32_t h) const {
    for (std::uint32_t out = mesh_.twins[previous_halfedge(h)]; out != h; out = mesh_.twins[previous_halfedge(out)]) {
      if (cut_[out]) return out;
    }
    return cut_[h] ? h : kNone;
  }

  void reach(std::span<const std::uint32_t> extremities) {
    if (extremities.empty()) return;
    std::vector<std::uint32_t> sources = border_vertices();
    for (std::uint32_t h = 0; h < cut_.size(); ++h) {
      if (cut_[h]) sources.push_back(mesh_.from(h));
    }
    paths_.clear();
    paths_.add_sources(sources, extremities);
    for (const std::uint32_t tip : extremities) {
      sources.clear();
      for (std::uint32_t v = tip; paths_.parent_edge(v) != kNone; v = paths_.parent(v)) sources.push_back(v);
      cut_path(tip);
      paths_.add_sources(sources, extremities);
    }
  }

  const TriangleMesh& mesh_;
  EdgePaths paths_;
  std::vector<bool> cut_;
};

}  // namespace

absl::StatusOr<std::vector<bool>> cut_graph(const TriangleMesh& mesh, std::span<const std::uint32_t> extremities) {
  Topology topology;
  std::optional<CutGraph> graph;
  tbb::parallel_invoke([&] { topology = analyse_topology(mesh); }, [&] { graph.emplace(mesh); });
  if (topology.components != 1) return absl::InvalidArgumentError("the faces to cut are not connected");
  return graph->build(topology, extremities);
}

}  // namespace curvecast
