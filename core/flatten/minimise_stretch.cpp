#include "core/flatten/minimise_stretch.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <span>

#include "core/flatten/parameterise.h"
#include "core/flatten/square_border.h"
#include "core/flatten/vertex_stretch.h"

namespace curvecast {
namespace {

bool is_end(double x) { return x == 0 || x == 1; }

using Improvement = VertexStretch::Improvement;

class Unfolding {
 public:
  Unfolding(const DiscMesh& disc, std::vector<Vec2d> border)
      : disc_(disc),
        surface_(surface_area(disc)),
        uv_(std::move(border)),
        hierarchy_(disc, corners(disc, uv_)),
        fall_(disc.vertex_count(), 0.0) {}

  absl::Status solve(const MinimiseStretchOptions& options, const ExecutionContext& context) {
    hierarchy_.coarsen_like(options.levels, context);
    hierarchy_.coarsen(options.coarsest, context);
    if (absl::Status status = context.check(); !status.ok()) return status;
    if (absl::Status status = solve_base(); !status.ok()) return status;
    independent_.resize(hierarchy_.level_count());
    std::size_t there = hierarchy_.base().size();
    relax(sweeps(there, options), options.good_enough);
    std::size_t relaxed = there;
    for (std::size_t l = hierarchy_.level_count(); l-- > 0;) {
      if (absl::Status status = context.check(); !status.ok()) return status;
      independent_[l] = hierarchy_.level(l);
      hierarchy_.restore_level();
      there += independent_[l].size();
      if (absl::Status status = insert(independent_[l]); !status.ok()) return status;
      const bool is_last = l == 0 && sweeps(there, options) > 1;
      if (!is_last && static_cast<double>(there) < options.growth * static_cast<double>(relaxed)) continue;
      relax(sweeps(there, options), options.good_enough);
      relaxed = there;
    }
    if (relaxed < there) touch_up();
    return absl::OkStatus();
  }

  std::vector<Vec2d> take() { return std::move(uv_); }

 private:
  static constexpr std::size_t kGrain = 256;  // vertices to a task

  static std::vector<std::uint32_t> corners(const DiscMesh& disc, const std::vector<Vec2d>& uv) {
    std::vector<std::uint32_t> found;
    for (const std::uint32_t v : disc.border) {
      if (is_end(uv[v].x()) && is_end(uv[v].y())) found.push_back(v);
    }
    return found;
  }

  static int sweeps(std::size_t vertices, const MinimiseStretchOptions& options) {
    return 1 + static_cast<int>(std::min(options.most_sweeps - 1.0, options.work / static_cast<double>(vertices)));
  }

  /// The coarsest level is small: the barycentric map is valid, and all that matters.
  absl::Status solve_base() {
    const std::vector<std::uint32_t>& base = hierarchy_.base();
    std::vector<std::uint32_t> index(disc_.vertex_count(), kNone);
    DiscMesh coarse{hierarchy_.base_mesh()};
    std::vector<Vec2d> uv;
    for (const std::uint32_t v : base) {
      index[v] = static_cast<std::uint32_t>(uv.size());
      uv.push_back(uv_[v]);
    }
    for (const std::uint32_t v : disc_.border) {
      if (index[v] != kNone) coarse.border.push_back(index[v]);
    }
    absl::StatusOr<std::vector<Vec2d>> solved =
        parameterise_inside(coarse, std::move(uv), {.weights = ParameterWeights::kUniform});
    if (!solved.ok()) return solved.status();
    for (std::size_t i = 0; i < base.size(); ++i) uv_[base[i]] = (*solved)[i];
    return absl::OkStatus();
  }

  void gather(std::uint32_t v, VertexStretch& stretch) const {
    stretch.reset(disc_.positions[v], !hierarchy_.on_border(v));
    hierarchy_.for_each_neighbour(v, [&](std::uint32_t x) { stretch.add_neighbour(disc_.positions[x], uv_[x]); });
    stretch.finish();
  }

  /// Calls visit(v, stretch) for vertices no two of which are neighbours, on all threads.
  template <typename Visit>
  void for_independent(std::span<const std::uint32_t> vertices, Visit&& visit) const {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, vertices.size(), kGrain), [&](const auto& range) {
      VertexStretch stretch(surface_);
      for (std::size_t i = range.begin(); i < range.end(); ++i) visit(vertices[i], stretch);
    });
  }

  absl::Status insert(std::span<const std::uint32_t> level) {
    std::atomic<bool> failed = false;
    for_independent(level, [&](std::uint32_t v, VertexStretch& stretch) {
      gather(v, stretch);
      if (const std::optional<Vec2d> place = stretch.place()) {
        uv_[v] = *place;
        fall_[v] = stretch.improve(uv_[v], slide(v)).fall;
      } else {
        failed = true;
      }
    });
    if (failed) return absl::InternalError("a vertex has no valid place in the parameter square");
    return absl::OkStatus();
  }

  /// The direction in which a border vertex may move.
  std::optional<Vec2d> slide(std::uint32_t v) const {
    if (!hierarchy_.on_border(v)) return std::nullopt;
    return is_end(uv_[v].y()) ? Vec2d::UnitX() : Vec2d::UnitY();
  }

  Improvement improve(std::uint32_t v, VertexStretch& stretch) {
    fall_[v] = 0;
    const bool border = hierarchy_.on_border(v);
    if (border && is_end(uv_[v].x()) && is_end(uv_[v].y())) return {};
    gather(v, stretch);
    const Improvement improvement = stretch.improve(uv_[v], slide(v));
    fall_[v] = improvement.fall;
    return improvement;
  }

  Improvement improve_independent(std::span<const std::uint32_t> vertices) {
    return tbb::parallel_deterministic_reduce(
        tbb::blocked_range<std::size_t>(0, vertices.size(), kGrain), Improvement{},
        [&](const auto& range, Improvement sum) {
          VertexStretch stretch(surface_);
          for (std::size_t i = range.begin(); i < range.end(); ++i) sum = sum + improve(vertices[i], stretch);
          return sum;
        },
        std::plus<>());
  }

  void relax(int most_sweeps, double good_enough) {
    for (int sweep = 0; sweep < most_sweeps; ++sweep) {
      Improvement sum;
      VertexStretch stretch(surface_);
      for (const std::uint32_t v : hierarchy_.base()) sum = sum + improve(v, stretch);
      for (std::size_t l = independent_.size(); l-- > 0;) sum = sum + improve_independent(independent_[l]);
      // Every triangle counts at three vertices.
      if (sum.fall < good_enough * sum.energy / 3) return;
    }
  }

  /// One more sweep over the finest level, but only where the last step still lowered the energy by a good part of a vertex's
  /// share of the least that there can be, which is about the surface's area squared: a tenth of the vertices, more or less.
  void touch_up() {
    constexpr double kGoodPart = 1e-3;
    const double worth = kGoodPart * surface_ * surface_ / static_cast<double>(disc_.vertex_count());
    for (std::size_t l = independent_.size(); l-- > 0;) {
      for_independent(independent_[l], [&](std::uint32_t v, VertexStretch& own) {
        if (fall_[v] > worth) improve(v, own);
      });
    }
  }

  const DiscMesh& disc_;
  const double surface_;  // area
  std::vector<Vec2d> uv_;
  VertexHierarchy hierarchy_;
  std::vector<double> fall_;                             // per vertex: by how much its last step lowered the energy
  std::vector<std::vector<std::uint32_t>> independent_;  // the vertices of the levels that are back
};

}  // namespace

absl::StatusOr<std::vector<Vec2d>> minimise_stretch(const DiscMesh& disc, const MinimiseStretchOptions& options,
                                                    const ExecutionContext& context) {
  Unfolding unfolding(disc, square_border(disc, options.corner_play));
  if (absl::Status status = unfolding.solve(options, context); !status.ok()) return status;
  return unfolding.take();
}

}  // namespace curvecast
