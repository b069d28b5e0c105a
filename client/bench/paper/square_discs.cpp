#include "client/bench/paper/square_discs.h"

#include <algorithm>
#include <span>
#include <utility>

#include "client/bench/peers/sample_elimination.h"
#include "client/bench/peers/square_points.h"
#include "core/base/random.h"
#include "core/measure/disc_cover.h"
#include "core/measure/spacing.h"
#include "core/measure/star_discrepancy.h"
#include "core/render/stroke_text.h"
#include "core/render/tile_grid.h"

namespace curvecast::cli::bench {
namespace {

using Points = std::vector<Vec2d>;

Points random_points(std::size_t n, std::uint64_t seed) {
  Points points;
  for (std::uint64_t i = 0; i < n; ++i) points.emplace_back(random_unit(seed, 2 * i), random_unit(seed, 2 * i + 1));
  return points;
}

/// Far apart out of five times as many random ones.
absl::StatusOr<Points> eliminated_points(std::size_t n, std::uint64_t seed, const ExecutionContext& context) {
  const Points candidates = random_points(5 * n, seed);
  std::vector<Vec3d> places;
  for (const Vec2d& p : candidates) places.emplace_back(p.x(), p.y(), 0);
  const Box3d box{Vec3d(0, 0, 0), Vec3d(1, 1, 0)};
  const absl::StatusOr<std::vector<std::uint32_t>> rest = eliminate_samples(PointCloud(places, box), 1, n, context);
  if (!rest.ok()) return rest.status();
  Points points;
  for (const std::uint32_t i : *rest) points.push_back(candidates[i]);
  return points;
}

absl::StatusOr<Points> our_points(const HostedMesh& square, std::size_t n, const char* sampler) {
  SampleFlags flags;
  flags.points = n;
  flags.sampler = sampler;
  const absl::StatusOr<client::Points> points = square.sample({}, flags);
  if (!points.ok()) return points.status();
  Points places;
  for (const auto& [x, y, z] : points->positions) {
    places.emplace_back(std::clamp(points->origin[0] + x, 0.0, 1.0), std::clamp(points->origin[1] + y, 0.0, 1.0));
  }
  return places;
}

Image draw_discs(const Points& points, double radius, int side) {
  constexpr Rgb8 kInk = {29, 53, 87};
  Image image = blank_image(side, side, {255, 255, 255});
  for (const Vec2d& p : points) {
    const Vec2d middle(side * p.x(), side * (1 - p.y()));
    draw_line(image, middle, middle, 2 * side * radius, kInk);
  }
  return image;
}

}  // namespace

double disc_radius(std::size_t n) { return 1.5 * packing_radius(1, n); }

absl::StatusOr<std::vector<DiscsPicture>> draw_square_discs(const HostedMesh& square, std::size_t n, int side,
                                                            const ExecutionContext& context) {
  const std::uint64_t random_seed = mix_bits(square.options().seed);
  std::vector<std::pair<const char*, absl::StatusOr<Points>>> sets;
  sets.emplace_back("random", random_points(n, random_seed));
  sets.emplace_back("Niederreiter, base 2", niederreiter_points(n));
  sets.emplace_back("Hammersley", hammersley_points(n));
  sets.emplace_back("sample elimination", eliminated_points(n, random_seed, context));
  sets.emplace_back("ours, jittered", our_points(square, n, "equalised"));
  sets.emplace_back("ours, progressive", our_points(square, n, "progressive"));
  std::vector<DiscsPicture> pictures;
  for (const auto& [name, points] : sets) {
    if (!points.ok()) return points.status();
    const double radius = disc_radius(n);
    pictures.push_back({{name, star_discrepancy(*points), disc_cover(*points, radius)}, draw_discs(*points, radius, side)});
  }
  return pictures;
}

}  // namespace curvecast::cli::bench
