#include "client/bench/peers/samplings.h"

#include <algorithm>
#include <span>
#include <utility>

#include "client/bench/peers/farthest_points.h"
#include "client/bench/peers/sample_elimination.h"
#include "client/bench/peers/triangle_random.h"
#include "core/base/random.h"
#include "core/measure/point_cloud.h"
#include "core/mesh/curvature.h"
#include "core/sample/resample.h"

namespace curvecast::cli::bench {
namespace {

constexpr std::uint64_t kFarthestCandidates = 262'144;
constexpr std::size_t kEliminationCandidates = 5;  // for each point that stays: Yuksel's

}  // namespace

Sampler::Sampler(Preprocessed made, Density density, std::uint64_t most_points, std::uint64_t seed)
    : made_(std::move(made)), density_(std::move(density)), most_points_(most_points), seed_(seed) {}

absl::StatusOr<SampleSet> Sampler::sample(const Sampling& sampling, std::uint64_t n, const ExecutionContext& context) {
  const TriangleMesh& mesh = made_.flattened->loaded.mesh;
  const auto count = static_cast<std::size_t>(n);
  // Sets of other sizes have other random numbers, and none those that measures choose by.
  const std::uint64_t random_seed = mix_bits(mix_bits(seed_) + n);
  switch (sampling.kind) {
    case Sampling::kEqualised:
      return on_curve(resample(*made_.curve, {.points = n, .density = density_, .sequence = sampling.sequence, .seed = seed_}));
    case Sampling::kProgressive:
      return on_curve(ranked(n, context));
    case Sampling::kRandom:
      return on_mesh(random_surface_points(mesh, count, random_seed));
    case Sampling::kTriangleRandom:
      return on_mesh(triangle_random_points(mesh, count, random_seed));
    case Sampling::kFarthest:
      return farthest(n);
    case Sampling::kElimination:
      return elimination(count, random_seed, context);
  }
  return absl::InternalError("a kind of sampling that nobody knows");
}

absl::StatusOr<PointSet> Sampler::ranked(std::uint64_t n, const ExecutionContext& context) {
  if (!progressive_) {
    absl::StatusOr<ProgressivePoints> made = ProgressivePoints::make(made_, most_points_, 0, context);
    if (!made.ok()) return made.status();
    progressive_ = *std::move(made);
  }
  return progressive_->sample(density_, n, context);
}

/// The first n in farthest-point order of even candidates, four or more for each point of the largest set.
absl::StatusOr<SampleSet> Sampler::farthest(std::uint64_t n) {
  if (order_.empty()) {
    const std::uint64_t count = std::max(kFarthestCandidates, std::min(4 * most_points_, kMaxPoints));
    absl::StatusOr<PointSet> candidates = resample(*made_.curve, {.points = count, .seed = seed_});
    if (!candidates.ok()) return candidates.status();
    candidates_ = *std::move(candidates);
    order_ = farthest_points(candidates_.positions, static_cast<std::size_t>(most_points_));
  }
  SampleSet set;
  set.points.origin = candidates_.origin;
  for (const std::uint32_t i : std::span(order_).first(static_cast<std::size_t>(n))) {
    set.points.positions.push_back(candidates_.positions[i]);
    set.points.normals.push_back(candidates_.normals[i]);
  }
  return set;
}

absl::StatusOr<SampleSet> Sampler::elimination(std::size_t n, std::uint64_t seed, const ExecutionContext& context) const {
  const SurfacePoints candidates = random_surface_points(made_.flattened->loaded.mesh, kEliminationCandidates * n, seed);
  const absl::StatusOr<std::vector<std::uint32_t>> rest =
      eliminate_samples(PointCloud(candidates.positions, made_.curve->box), made_.curve->total_area, n, context);
  if (!rest.ok()) return rest.status();
  SurfacePoints left;
  for (const std::uint32_t i : *rest) {
    left.positions.push_back(candidates.positions[i]);
    left.faces.push_back(candidates.faces[i]);
  }
  return on_mesh(std::move(left));
}

absl::StatusOr<SampleSet> Sampler::on_curve(absl::StatusOr<PointSet> points) const {
  if (!points.ok()) return points.status();
  SampleSet set{*std::move(points), {}};
  for (const std::uint32_t l : set.points.vertices) set.faces.push_back(made_.curve->triangle[l]);
  return set;
}

SampleSet Sampler::on_mesh(SurfacePoints from) const {
  const TriangleMesh& mesh = made_.flattened->loaded.mesh;
  SampleSet set{{}, std::move(from.faces)};
  set.points.origin = made_.curve->origin;
  for (std::size_t i = 0; i < from.positions.size(); ++i) {
    set.points.positions.emplace_back((from.positions[i] - set.points.origin).cast<float>());
    set.points.normals.push_back(face_normal(mesh, set.faces[i]));
  }
  return set;
}

}  // namespace curvecast::cli::bench
