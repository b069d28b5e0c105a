#include "core/flatten/extremities.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/flatten/cut_to_disc.h"
#include "core/flatten/distortion.h"
#include "core/flatten/edge_paths.h"
#include "core/flatten/minimise_stretch.h"
#include "core/mesh/topology.h"

namespace curvecast {
namespace {

// Faces below which cuts cost more border than they spare stretch.
constexpr std::size_t kSmallest = 64;
// A trial shows which cut is better long before its map is as good as can be.
constexpr MinimiseStretchOptions kTrial{.good_enough = 0.02, .most_sweeps = 25};
// The search costs no more than the map of a small piece does: its coarse mesh has this part of its vertices.
constexpr std::size_t kProxyShare = 48;
constexpr std::size_t kSmallestProxy = 64;

/// The map of a mesh with some cuts.
struct Trial {
  std::vector<std::uint32_t> extremities;
  double stretch = std::numeric_limits<double>::infinity();
  std::uint32_t most_stretched = kNone;  // vertex, far enough from the cut
  std::uint32_t farthest = kNone;        // vertex, from the cut
};

class Search {
 public:
  Search(const TriangleMesh& mesh, const ExtremityOptions& options)
      : mesh_(mesh), options_(options), reach_(options.least_reach * std::sqrt(surface_area(mesh))) {}

  Trial run(const ExecutionContext& context) {
    Trial best = attempt(opening());
    Trial last = best;
    int in_vain = 0;
    while (in_vain < options_.patience && static_cast<int>(last.extremities.size()) < options_.most &&
           best.stretch > options_.good_stretch && !context.cancelled()) {
      Trial next = attempt_both(last);
      if (next.extremities.empty()) break;
      last = std::move(next);
      const auto cuts = static_cast<double>(last.extremities.size() - best.extremities.size());
      if (last.stretch < std::pow(1 - options_.least_gain, cuts) * best.stretch) {
        best = last;
        in_vain = 0;
      } else {
        ++in_vain;
      }
    }
    return best;
  }

 private:
  /// The ends of the cut that opens a closed surface of genus 0: far from each other.
  std::vector<std::uint32_t> opening() const {
    const Topology topology = analyse_topology(mesh_);
    if (topology.genus > 0 || topology.boundary_loops > 0) return {};
    EdgePaths paths(mesh_);
    const std::uint32_t first = paths.farthest_from(0);
    return {first, paths.farthest_from(first)};
  }

  /// The better of the two ways to go on; without extremities where there is none.
  Trial attempt_both(const Trial& last) const {
    const auto go_on = [&](std::uint32_t v) {
      if (v == kNone) return Trial{};
      std::vector<std::uint32_t> longer = last.extremities;
      longer.push_back(v);
      return attempt(std::move(longer));
    };
    Trial first, second;
    tbb::parallel_invoke([&] { first = go_on(last.most_stretched); },
                         [&] {
                           if (last.farthest != last.most_stretched) second = go_on(last.farthest);
                         });
    Trial& better = second.stretch < first.stretch ? second : first;
    return std::isfinite(better.stretch) ? std::move(better) : Trial{};
  }

  Trial attempt(std::vector<std::uint32_t> extremities) const {
    Trial trial;
    trial.extremities = std::move(extremities);
    const absl::StatusOr<DiscMesh> disc = cut_to_disc(mesh_, trial.extremities);
    if (!disc.ok()) return trial;
    const absl::StatusOr<std::vector<Vec2d>> uv = minimise_stretch(*disc, kTrial);
    if (!uv.ok()) return trial;
    const Stretch stretch = measure_stretch(*disc, *uv);
    trial.stretch = stretch.total;

    EdgePaths paths(*disc);
    paths.add_sources(disc->border);
    double largest = 0;
    double longest = reach_;
    for (std::uint32_t f = 0; f < mesh_.face_count(); ++f) {
      for (int i = 0; i < 3; ++i) {
        const std::uint32_t v = disc->triangles[f][i];
        const std::uint32_t original = mesh_.triangles[f][i];
        if (paths.distance(v) < reach_ || disc->positions[v] != mesh_.positions[original]) continue;
        if (stretch.vertex[v] > largest) {
          largest = stretch.vertex[v];
          trial.most_stretched = original;
        }
        if (paths.distance(v) > longest) {
          longest = paths.distance(v);
          trial.farthest = original;
        }
      }
    }
    return trial;
  }

  const TriangleMesh& mesh_;
  const ExtremityOptions& options_;
  const double reach_;
};

}  // namespace

Extremities find_extremities(const TriangleMesh& piece, const ExtremityOptions& options, const ExecutionContext& context) {
  if (piece.face_count() < kSmallest || options.most == 0) return {};
  VertexHierarchy hierarchy(piece, {});
  hierarchy.coarsen(std::clamp(piece.vertex_count() / kProxyShare, kSmallestProxy, options.proxy_vertices), context);
  if (context.cancelled()) return {};
  const TriangleMesh proxy = hierarchy.base_mesh();
  Trial best = Search(proxy, options).run(context);
  Extremities found{.vertices = std::move(best.extremities), .stretch = best.stretch};
  for (std::uint32_t& v : found.vertices) v = hierarchy.base()[v];
  found.levels = std::move(hierarchy).take_levels();
  return found;
}

}  // namespace curvecast
