// Point sets of every sampler and of its peers, on one surface.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <optional>
#include <vector>

#include "client/bench/points/progressive_points.h"
#include "core/base/execution_context.h"
#include "core/density/density.h"
#include "core/measure/random_surface_points.h"
#include "core/pipeline/pipeline.h"
#include "core/sample/point_set.h"
#include "core/sample/sequence.h"

namespace curvecast::cli::bench {

struct Sampling {
  enum Kind { kEqualised, kProgressive, kRandom, kTriangleRandom, kFarthest, kElimination };

  const char* name;
  Kind kind;
  Sequence sequence = Sequence::kJittered;
};

inline constexpr Sampling kJitteredSampling = {"equalised jittered", Sampling::kEqualised, Sequence::kJittered};
inline constexpr Sampling kProgressiveSampling = {"progressive", Sampling::kProgressive};
inline constexpr Sampling kRandomSampling = {"random", Sampling::kRandom};
inline constexpr Sampling kTriangleRandomSampling = {"random in each triangle", Sampling::kTriangleRandom};
inline constexpr Sampling kSamplings[] = {kJitteredSampling,
                                          {"equalised regular", Sampling::kEqualised, Sequence::kRegular},
                                          {"equalised vandercorput", Sampling::kEqualised, Sequence::kVanDerCorput},
                                          {"equalised golden", Sampling::kEqualised, Sequence::kGoldenRatio},
                                          kProgressiveSampling,
                                          kRandomSampling,
                                          kTriangleRandomSampling,
                                          {"farthest point", Sampling::kFarthest},
                                          {"sample elimination", Sampling::kElimination}};

/// Says whether points of this kind follow a density. Those of the others are uniform, whatever it is.
constexpr bool follows_density(Sampling::Kind kind) { return kind == Sampling::kEqualised || kind == Sampling::kProgressive; }

/// Points, and the faces on which they lie; no faces for farthest points.
struct SampleSet {
  PointSet points;
  std::vector<std::uint32_t> faces;
};

/// Makes sets of points of all samplings. Keeps what made the curve, and what it once made for a sampling. Not thread-safe.
class Sampler {
 public:
  /// `most_points`: of the largest set that will be asked for. Precondition: `made` comes of preprocess() or lay_curve().
  Sampler(Preprocessed made, Density density, std::uint64_t most_points, std::uint64_t seed);

  /// Returns n points. Random ones are others for every n. Errors as of resample() and sample_ranked(); Cancelled.
  absl::StatusOr<SampleSet> sample(const Sampling& sampling, std::uint64_t n, const ExecutionContext& context);

  const Preprocessed& preprocessed() const { return made_; }
  std::uint64_t seed() const { return seed_; }
  /// Returns one of the same curve and density.
  Sampler with_seed(std::uint64_t seed) const { return {made_, density_, most_points_, seed}; }

 private:
  absl::StatusOr<PointSet> ranked(std::uint64_t n, const ExecutionContext& context);
  absl::StatusOr<SampleSet> farthest(std::uint64_t n);
  absl::StatusOr<SampleSet> elimination(std::size_t n, std::uint64_t seed, const ExecutionContext& context) const;
  absl::StatusOr<SampleSet> on_curve(absl::StatusOr<PointSet> points) const;
  SampleSet on_mesh(SurfacePoints from) const;

  Preprocessed made_;
  Density density_;
  std::uint64_t most_points_, seed_;
  std::optional<ProgressivePoints> progressive_;
  PointSet candidates_;  // of farthest()
  std::vector<std::uint32_t> order_;
};

}  // namespace curvecast::cli::bench
