// The progressive sampler's points. Each ranked point has a fixed position and a fixed rank. The rank of a point is its number in
// one order of all points of the surface: 0, 1, 2 ..., and every prefix of that order is spread evenly. A view shows a point when
// the view's density there affords its rank. So raising the density only adds points, lowering it only removes some, and no point
// moves. README.md in this folder explains the method.
#pragma once

#include <absl/status/statusor.h>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/base/execution_context.h"
#include "core/curve/leaf_surface.h"
#include "core/curve/surface_curve.h"
#include "core/progressive/curve_strata.h"
#include "core/progressive/find_ranked_points.h"
#include "core/progressive/group_order.h"
#include "core/progressive/stratum_group.h"

namespace curvecast {

/// The deepest level: 10^12 points. Deeper, they would be nearer to each other than floats can tell.
inline constexpr int kMaxRankLevel = 20;
/// The deepest level that is made for the whole surface at once: 4^11 = 4 million points.
inline constexpr int kMaxLevelAtOnce = 11;
/// The most points that one deepen() makes.
inline constexpr std::uint64_t kMaxDeepened = 4'000'000;

struct ProgressiveOptions {
  int level = 9;           // 4^level points are made at once, 0 .. kMaxLevelAtOnce
  std::uint64_t seed = 0;  // of the points' positions
};

/// The strata [first, last) of a level.
struct StrataRange {
  std::uint64_t first, last;
};

/// Groups of deep levels that deepen() made around the points asked for. The next deepen() nearby needs most of them again.
/// Belongs to one ProgressiveRanks.
struct DeepGroups {
  struct Filled {
    std::vector<RankedPoint> points;
    std::uint64_t used = 0;  // by which deepen() last
  };
  GroupMap<Filled> filled;
  GroupMap<std::vector<std::uint64_t>> near;  // see GroupOrder::near()
  GroupShapes shapes;
  std::size_t points = 0;   // in `filled`
  std::uint64_t calls = 0;  // of deepen()

  /// Forgets what was not used for longest, until at most about `max_points` are left, and shapes that take more than half as
  /// much memory as so many points.
  void shrink(std::size_t max_points);
  std::size_t byte_size() const;
};

/// Ranked points of a whole curve down to a level, made at once, and of parts of it as deep as one likes. For every l the points
/// of the 4^l lowest ranks have one in each stratum of level l. Any number of threads gives the same points. Immutable but for
/// extend() and move_to(): any number of threads may ask.
class ProgressiveRanks {
 public:
  /// InvalidArgument: the level is out of range, the curve has no area. Cancelled.
  static absl::StatusOr<ProgressiveRanks> make(std::shared_ptr<const LeafSurface> surface, const ProgressiveOptions& options,
                                               const ExecutionContext& context = {});

  /// Returns what make() gave before on the same surface with the same options, from where its points lay: in much less
  /// time. Errors as of find_ranked_points(), and InvalidArgument: the curve has no area.
  static absl::StatusOr<ProgressiveRanks> restore(std::shared_ptr<const LeafSurface> surface, const ProgressiveOptions& options,
                                                  std::span<const RankedPosition> points, const ExecutionContext& context = {});

  /// Makes all points down to a deeper level, at most kMaxLevelAtOnce; the points that there are stay. No other thread may ask
  /// meanwhile. InvalidArgument: the level is not deeper. Cancelled, and nothing has changed.
  absl::Status extend(int level, const ExecutionContext& context = {});

  /// From now on, the same surface, with the same curve, is taken from there. No other thread may ask meanwhile.
  void move_to(std::shared_ptr<const LeafSurface> surface);

  const SurfaceCurve& curve() const { return surface_->curve(); }
  int level() const { return options_.level; }
  /// Returns 4^level() points in curve order: the i-th lies in stratum i of that level.
  std::span<const RankedPoint> points() const { return points_; }

  /// Returns the points of some strata of a deeper level, one for each stratum, range by range, each in curve order. They are the
  /// points that make() would give for that level. Points around the ranges have to be made too, unless they are in `made`, to
  /// which they are added; so one call for many ranges costs less than many calls. InvalidArgument: a level not in level() ..
  /// kMaxRankLevel, strata that there are not, more than kMaxDeepened points. Cancelled.
  absl::StatusOr<std::vector<RankedPoint>> deepen(int level, std::span<const StrataRange> ranges, DeepGroups& made,
                                                  const ExecutionContext& context = {}) const;

 private:
  /// Has no points yet. Precondition: the curve has an area.
  ProgressiveRanks(std::shared_ptr<const LeafSurface> surface, std::uint64_t seed);
  absl::Status fill(int level, const ExecutionContext& context);

  std::shared_ptr<const LeafSurface> surface_;
  ProgressiveOptions options_;
  std::unique_ptr<CurveStrata> strata_;
  std::unique_ptr<const GroupOrder> order_;
  std::vector<RankedPoint> points_;
};

}  // namespace curvecast
