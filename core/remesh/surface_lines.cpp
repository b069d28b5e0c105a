#include "core/remesh/surface_lines.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "core/mesh/crease_normals.h"
#include "core/mesh/topology.h"
#include "core/mesh/vertex_fans.h"

namespace curvecast {
namespace {

void list_borders(const TriangleMesh& mesh, const ExecutionContext& context, std::vector<SurfaceLine>& out) {
  std::vector<bool> seen(mesh.twins.size(), false);
  for (std::uint32_t start = 0; start < mesh.twins.size() && !context.cancelled(); ++start) {
    if (mesh.twins[start] != kNone || seen[start]) continue;
    SurfaceLine& line = out.emplace_back();
    line.is_border = line.is_closed = true;
    std::uint32_t h = start;
    do {
      seen[h] = true;
      line.halfedges.push_back(h);
      h = next_on_border(mesh.twins, h);
    } while (h != start);
  }
}

class FeatureTracer {
 public:
  FeatureTracer(const TriangleMesh& mesh, std::vector<bool> features, const ExecutionContext& context)
      : mesh_(mesh), fans_(mesh, context), open_(std::move(features)), count_(mesh.vertex_count(), 0) {
    for (std::uint32_t h = 0; h < open_.size(); ++h) {
      if (open_[h]) ++count_[mesh.from(h)];
    }
  }

  void list(std::vector<SurfaceLine>& out) {
    for (std::uint32_t v = 0; v < mesh_.vertex_count(); ++v) {
      if (count_[v] > 0 && is_end(v)) trace_all(v, out);
    }
    for (std::uint32_t v = 0; v < mesh_.vertex_count(); ++v) {
      if (count_[v] > 0) trace_all(v, out);
    }
  }

 private:
  bool is_end(std::uint32_t v) const { return count_[v] != 2 || fans_.on_border(v); }

  std::uint32_t open_halfedge(std::uint32_t v) const {
    std::uint32_t found = kNone;
    fans_.visit(v, [&](std::uint32_t h) {
      if (found == kNone && open_[h]) found = h;
    });
    return found;
  }

  void trace_all(std::uint32_t start, std::vector<SurfaceLine>& out) {
    for (std::uint32_t h = open_halfedge(start); h != kNone; h = open_halfedge(start)) {
      SurfaceLine& line = out.emplace_back();
      for (std::uint32_t v = start; h != kNone; h = is_end(v) || v == start ? kNone : open_halfedge(v)) {
        line.halfedges.push_back(h);
        open_[h] = open_[mesh_.twins[h]] = false;
        v = mesh_.to(h);
      }
      const std::uint32_t last = mesh_.to(line.halfedges.back());
      line.is_closed = last == start && !is_end(start);
      const auto is_loose = [&](std::uint32_t v) { return count_[v] == 1 && !fans_.on_border(v); };
      line.has_loose_end = is_loose(start) || is_loose(last);
    }
  }

  const TriangleMesh& mesh_;
  const VertexFans fans_;
  std::vector<bool> open_;            // per halfedge: a feature that no line has yet
  std::vector<std::uint32_t> count_;  // per vertex: features that end there
};

}  // namespace

std::vector<bool> sharp_edges(const TriangleMesh& mesh, double degrees, const ExecutionContext& context) {
  const std::vector<std::uint8_t> creases = find_creases(mesh, std::cos(degrees * std::numbers::pi / 180), context);
  return {creases.begin(), creases.end()};
}

std::vector<SurfaceLine> surface_lines(const TriangleMesh& mesh, std::vector<bool> features, const ExecutionContext& context) {
  std::vector<SurfaceLine> lines;
  list_borders(mesh, context, lines);
  if (!features.empty()) FeatureTracer(mesh, std::move(features), context).list(lines);
  return lines;
}

}  // namespace curvecast
