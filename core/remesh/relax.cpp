#include "core/remesh/relax.h"

#include <cmath>
#include <utility>
#include <vector>

#include "core/base/for_all.h"
#include "core/remesh/angle_flips.h"
#include "core/remesh/unfold.h"
#include "core/remesh/valence_flips.h"

namespace curvecast {
namespace {

constexpr char kStage[] = "relax";
constexpr std::size_t kGrain = 1024;  // vertices

class Relaxer {
 public:
  Relaxer(HalfedgeMesh& mesh, const SurfaceWalk& surface, std::span<WalkPlace> places, const ExecutionContext& context)
      : mesh_(mesh), surface_(surface), places_(places), context_(context), weight_(mesh.vertex_count()) {
    for (std::uint32_t v = 0; v < mesh.vertex_count(); ++v) {
      if (mesh.has_vertex(v)) vertices_.push_back(v);
    }
    next_.resize(vertices_.size());
  }

  void move_all() {
    for_each_vertex([&](std::size_t i) { weight_[vertices_[i]] = weight_of(vertices_[i]); });
    for_each_vertex([&](std::size_t i) { next_[i] = next_place(vertices_[i]); });
    if (context_.cancelled()) return;
    std::vector<Vec3d> after = mesh_.positions;
    for (std::size_t i = 0; i < vertices_.size(); ++i) after[vertices_[i]] = next_[i].position;
    const std::vector<bool> back = unfold(mesh_.triangles, mesh_.positions, after);
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
      if (!back[vertices_[i]]) places_[vertices_[i]] = next_[i];
    }
    mesh_.positions = std::move(after);
  }

 private:
  template <typename Work>
  void for_each_vertex(const Work& work) {
    for_blocks(context_, vertices_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) work(i);
    });
  }

  double weight_of(std::uint32_t v) const {
    double twice_area = 0;
    mesh_.for_each_outgoing(v, [&](std::uint32_t h) { twice_area += area_vector(h).norm(); });
    return std::sqrt(twice_area);
  }

  Vec3d area_vector(std::uint32_t h) const {
    const Vec3d& a = mesh_.positions[mesh_.from(h)];
    return (mesh_.positions[mesh_.to(h)] - a).cross(mesh_.positions[mesh_.apex(h)] - a);
  }

  WalkPlace next_place(std::uint32_t v) const {
    if (mesh_.on_line(v)) return places_[v];
    Vec3d normal = Vec3d::Zero(), sum = Vec3d::Zero();
    double weights = 0;
    const Vec3d& p = mesh_.positions[v];
    mesh_.for_each_outgoing(v, [&](std::uint32_t h) {
      normal += area_vector(h);
      const std::uint32_t w = mesh_.to(h);
      sum += weight_[w] * (mesh_.positions[w] - p);
      weights += weight_[w];
    });
    const double square = normal.squaredNorm();
    if (!(weights > 0 && square > 0)) return places_[v];
    const Vec3d step = sum / weights;
    return surface_.nearest(places_[v].face, p + (step - step.dot(normal) / square * normal));
  }

  HalfedgeMesh& mesh_;
  const SurfaceWalk& surface_;
  const std::span<WalkPlace> places_;
  const ExecutionContext& context_;
  std::vector<std::uint32_t> vertices_;
  std::vector<double> weight_;   // of each vertex
  std::vector<WalkPlace> next_;  // of each of vertices_
};

}  // namespace

void relax(HalfedgeMesh& mesh, const SurfaceWalk& surface, std::span<WalkPlace> places, int rounds,
           const ExecutionContext& context) {
  Relaxer relaxer(mesh, surface, places, context);
  AngleFlips flips(mesh);
  for (int round = 0; round < rounds && !context.cancelled(); ++round) {
    context.progress(kStage, static_cast<double>(round) / rounds);
    // Vertices with six neighbours first, so that there is something to be gained by moving; angles have the last word.
    if (2 * round < rounds) flip_to_valence(mesh);
    relaxer.move_all();
    flips.add_all();
    flips.run();
  }
}

}  // namespace curvecast
