#include "core/sample/move_apart.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include "core/base/for_all.h"
#include "core/base/memory_claim.h"
#include "core/base/packed_distance.h"
#include "core/base/work_limit.h"
#include "core/curve/place_attributes.h"
#include "core/mesh/surface_mesh.h"
#include "core/mesh/surface_walk.h"
#include "core/sample/repulsion.h"
#include "core/sample/splat_radius.h"

namespace curvecast {
namespace {

constexpr char kStage[] = "relax";
constexpr std::size_t kGrain = 32;  // blocks
// Tried on a square with 16,384 jittered points: longer steps begin to swing, shorter ones take more rounds.
constexpr double kStep = 0.5;         // of the push, in spacings
constexpr double kDamping = 2;        // in the second half of the rounds they shrink, so that nothing swings on ridges
constexpr float kPoor = 0.7F;         // spacings: points that have a neighbour so near are moved once more,
constexpr int kSweeps = 5;            // so often,
constexpr double kMostBeside = 0.02;  // of the points, below kPoor only because of the surface's other side
constexpr int kPlaces = 32;           // to the best of so many places, on a spiral
constexpr double kGoldenCosine = -0.7373688780783197, kGoldenSine = 0.6754902942615238;
constexpr double kMostStep = 0.3;  // spacings
// A point beside a border is pushed away from it as by its own picture in a mirror; so hard, that as many points are beside the
// border as elsewhere. Without it a row of them would stand on the border itself.
constexpr double kMirror = 1.3;
constexpr std::uint64_t kBytesPerPoint = 176;

/// The length of steps in a round, of the push.
double step_of(int round, int rounds) {
  const double left = static_cast<double>(rounds - round) / rounds;
  return kStep * std::min(1.0, kDamping * left);
}

class Relaxation {
 public:
  Relaxation(const SurfaceWalk& surface, bool has_borders, const PointSet& points, const ExecutionContext& context)
      : surface_(surface),
        has_borders_(has_borders),
        context_(context),
        origin_(points.origin),
        repulsion_(points.size()),
        places_(points.size()),
        first_(points.size()),
        normal_(points.size()),
        spacing_(points.size()) {
    for_blocks(context, points.size(), kGrain * Repulsion::kBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const FacePlace& place = points.places[i];
        places_[i] = surface.place(place.face, static_cast<double>(place.weight_1), static_cast<double>(place.weight_2));
        first_[i] = places_[i].position;
        spacing_[i] = static_cast<float>(packed_distance(SplatRadius::area_of_point(points.radii[i]), 1));
      }
    });
  }

  /// `step`: of a push, in spacings.
  absl::Status move_all(double step) {
    set_all();
    for_blocks(context_, repulsion_.block_count(), kGrain, [&](std::size_t begin, std::size_t end) {
      WorkLimit::Meter meter(context_.limit);
      Repulsion::Scratch scratch;
      for (std::size_t b = begin; b < end; ++b) {
        if (!context_.check_limit().ok()) return;
        const std::array<Vec3f, Repulsion::kBlock> pushes = repulsion_.find(b, scratch);
        // Nobody else reads or writes these before all are done: forces are those of repulsion_.
        for (std::size_t i = b * Repulsion::kBlock; i < std::min(places_.size(), (b + 1) * Repulsion::kBlock); ++i) {
          move(i, step, pushes[i - b * Repulsion::kBlock]);
        }
        meter.settle();
      }
    });
    return context_.check_limit();
  }

  /// Moves points that are too near to others all the same, as there are some where the surface bends within a spacing, one by
  /// one to the best of some places around.
  absl::Status keep_apart() {
    set_all();
    std::vector<std::uint8_t> is_poor(places_.size());  // 1: because of others on the other side; 2: on the same
    for_blocks(context_, places_.size(), kGrain * Repulsion::kBlock, [&](std::size_t begin, std::size_t end) {
      if (!context_.check_limit().ok()) return;
      WorkLimit::Meter meter(context_.limit);
      Repulsion::Scratch scratch;
      for (std::size_t i = begin; i < end; ++i) {
        const Repulsion::Nearest near = nearest(i, places_[i], scratch);
        is_poor[i] = near.on_side < kPoor ? 2 : near.at_all < kPoor ? 1 : 0;
      }
      meter.settle();
    });
    // Sheets thinner than the spacing have others on their other side everywhere: there is no place without.
    const auto beside = static_cast<double>(std::count(is_poor.begin(), is_poor.end(), 1));
    const bool is_thin = beside > kMostBeside * static_cast<double>(places_.size());
    WorkLimit::Meter meter(context_.limit);
    Repulsion::Scratch scratch;
    for (int sweep = 0; sweep < kSweeps; ++sweep) {
      for (std::size_t i = 0; i < places_.size(); ++i) {
        if (is_poor[i] <= (is_thin ? 1 : 0)) continue;
        if (absl::Status status = context_.check_limit(); !status.ok()) return status;
        if (move_to_best(i, is_thin, scratch)) is_poor[i] = 0;
        meter.settle();
      }
    }
    return context_.check_limit();
  }

  const WalkPlace& place(std::size_t i) const { return places_[i]; }

 private:
  Vec3f local(const WalkPlace& place) const { return (place.position - origin_).cast<float>(); }

  void set_all() {
    for (std::size_t i = 0; i < places_.size(); ++i) {
      normal_[i] = surface_.normal(places_[i].face);
      repulsion_.set(i, local(places_[i]), normal_[i].cast<float>(), spacing_[i]);
    }
    repulsion_.fill_boxes();
  }

  Repulsion::Nearest nearest(std::size_t i, const WalkPlace& place, Repulsion::Scratch& scratch) const {
    return repulsion_.nearest(i, local(place), surface_.normal(place.face).cast<float>(), scratch);
  }

  /// Returns whether the point is far enough from others now. Those on its side count first.
  bool move_to_best(std::size_t i, bool only_on_side, Repulsion::Scratch& scratch) {
    constexpr std::pair kEnough(kPoor, kPoor);
    const auto worth = [&](const WalkPlace& place) {
      const Repulsion::Nearest near = nearest(i, place, scratch);
      return std::pair(std::min(near.on_side, kPoor), only_on_side ? kPoor : std::min(near.at_all, kPoor));
    };
    const WalkPlace from = places_[i];
    std::pair<float, float> best = worth(from);
    const auto spacing = static_cast<double>(spacing_[i]);
    const Vec3d normal = surface_.normal(from.face), first = normal.unitOrthogonal(), second = normal.cross(first);
    double x = 1, y = 0;
    for (int k = 0; k < kPlaces && best < kEnough; ++k) {
      const double distance = kMostMove * spacing * std::sqrt((k + 1.0) / kPlaces);
      const SurfaceWalk::End end = surface_.straight(from, distance * (x * first + y * second));
      std::tie(x, y) = std::pair(kGoldenCosine * x - kGoldenSine * y, kGoldenSine * x + kGoldenCosine * y);
      if (end.is_on_border || (end.place.position - first_[i]).norm() > kMostMove * spacing) continue;
      if (const std::pair<float, float> there = worth(end.place); there > best) best = there, places_[i] = end.place;
    }
    repulsion_.move(i, local(places_[i]), surface_.normal(places_[i].face).cast<float>());
    return best >= kEnough;
  }

  void move(std::size_t i, double length, const Vec3f& push) {
    WalkPlace& place = places_[i];
    const auto spacing = static_cast<double>(spacing_[i]);
    const Vec3d& normal = normal_[i];
    Vec3d along = push.cast<double>();
    along -= along.dot(normal) * normal;
    if (has_borders_) along += mirrored(place, along, spacing);
    Vec3d step = length * spacing * along;
    step *= std::min(1.0, kMostStep * spacing / std::max(step.norm(), 1e-300));
    // No farther from where it was at first. Where the surface bends, the walk may end farther from there than its aim.
    const double most = kMostMove * spacing;
    const Vec3d away = place.position + step - first_[i];
    if (const double distance = away.norm(); distance > most) step += (most / distance - 1) * away;
    const SurfaceWalk::End end = surface_.straight(place, step);
    if (!end.is_on_border && (end.place.position - first_[i]).norm() <= most) place = end.place;
  }

  /// What a point's picture beyond the border does to it, where it is pushed towards one.
  Vec3d mirrored(const WalkPlace& place, const Vec3d& along, double spacing) const {
    const double length = along.norm();
    if (!(length > 0)) return Vec3d::Zero();
    const SurfaceWalk::End ahead = surface_.straight(place, spacing / length * along);
    if (!ahead.is_on_border) return Vec3d::Zero();
    const Vec3d back = place.position - ahead.place.position;
    const double distance = back.norm(), near = 1 - distance / spacing;  // of the picture: twice as far
    if (!(near > 0 && distance > 0)) return Vec3d::Zero();
    return kMirror * near * near / distance * back;
  }

  const SurfaceWalk& surface_;
  const bool has_borders_;
  const ExecutionContext& context_;
  const Vec3d origin_;
  Repulsion repulsion_;
  std::vector<WalkPlace> places_;
  std::vector<Vec3d> first_;   // where they were
  std::vector<Vec3d> normal_;  // of their faces, when set_all() was called
  std::vector<float> spacing_;
};

/// Writes where points are, and what is there.
void write(const Relaxation& moved, const SurfaceData& data, PointSet& points, const ExecutionContext& context) {
  for_blocks(context, points.size(), kGrain * Repulsion::kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const WalkPlace& place = moved.place(i);
      const std::array<float, 2> weights{static_cast<float>(place.weight_1), static_cast<float>(place.weight_2)};
      points.places[i] = {place.face, weights[0], weights[1]};
      points.positions[i] = (place.position - points.origin).cast<float>();
      points.normals[i] = normal_at(data, place.face, weights);
      if (points.colours.empty()) continue;
      const Vec3f all(1 - weights[0] - weights[1], weights[0], weights[1]);
      points.colours[i] = data.colour->at(place.face, all, SplatRadius::area_of_point(points.radii[i]));
    }
  });
  points.has_moved = true;
}

}  // namespace

absl::Status move_apart(const CurveBase& base, int rounds, PointSet& points, const ExecutionContext& context) {
  if (rounds == 0 || points.size() < 2) return absl::OkStatus();
  MemoryClaim claim(context);
  const MeshView& mesh = base.data.mesh;
  const std::uint64_t bytes = 32 * mesh.positions.size() + 32 * mesh.triangles.size() + kBytesPerPoint * points.size();
  const std::string what = absl::StrFormat("moving %d points apart on %d triangles takes %s of memory", points.size(),
                                           mesh.triangles.size(), describe_bytes(static_cast<double>(bytes)));
  if (absl::Status status = claim.set(bytes, what); !status.ok()) return status;
  if (!base.is_all_sound()) return base.status();
  const absl::StatusOr<TriangleMesh> joined = surface_mesh(mesh, base.data.borders, context);
  if (!joined.ok()) return joined.status();
  const SurfaceWalk surface(*joined);
  Relaxation relaxation(surface, !base.data.borders.empty(), points, context);
  for (int round = 0; round < rounds; ++round) {
    context.progress(kStage, static_cast<double>(round) / rounds);
    if (absl::Status status = relaxation.move_all(step_of(round, rounds)); !status.ok()) return status;
  }
  if (absl::Status status = relaxation.keep_apart(); !status.ok()) return status;
  write(relaxation, base.data, points, context);
  return context.check();
}

}  // namespace curvecast
