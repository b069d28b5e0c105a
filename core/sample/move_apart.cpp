#include "core/sample/move_apart.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <vector>

#include "core/base/for_all.h"
#include "core/base/memory_claim.h"
#include "core/base/packed_distance.h"
#include "core/base/work_limit.h"
#include "core/curve/place_attributes.h"
#include "core/mesh/surface_mesh.h"
#include "core/mesh/surface_walk.h"
#include "core/sample/overlap.h"
#include "core/sample/point_blocks.h"
#include "core/sample/splat_radius.h"
#include "core/sample/voronoi_cell.h"

namespace curvecast {
namespace {

constexpr char kStage[] = "relax";
constexpr std::size_t kGrain = 32;  // blocks
// Of the way to the centres of cells. Tried on ten models: 1.9 gains nothing, by less it takes more rounds.
constexpr double kRate = 1.8;
constexpr int kSweeps = 6, kMostSweeps = 48;  // a round, and in all: over points that are too near to others
// Sheets thinner than the spacing have others behind all points. Where those keep the whole distance, those on the same side
// cannot, and the set is less even: more than twice as uneven on two squares.
constexpr float kApartInSheets = 0.55F;  // spacings
constexpr double kMostBehind = 0.02;     // of the points that are looked at are too near to others behind, but in sheets
constexpr std::size_t kLookAt = 8;       // every one of so many blocks
constexpr double kMostCentred = 1;       // spacings: the rest of kMostMove is for parting
constexpr int kAttempts = 3;
// What is met of a border at a smaller angle is met in another direction, too, or only beside the cell.
constexpr double kLeastSine = 0.8;
constexpr std::uint64_t kBytesPerPoint = 152, kBytesPerBorder = 40;

/// Finds what is far from a surface's borders, by the middles of their edges.
class Borders {
 public:
  /// How many edges they have.
  static std::size_t count(const TriangleMesh& mesh) {
    return static_cast<std::size_t>(std::count(mesh.twins.begin(), mesh.twins.end(), kNone));
  }

  /// Positions are relative to `origin` from then on.
  Borders(const TriangleMesh& mesh, const Vec3d& origin) : middles_(count(mesh)) {
    std::size_t i = 0;
    for (std::uint32_t h = 0; h < mesh.twins.size(); ++h) {
      if (mesh.twins[h] != kNone) continue;
      const Vec3d &from = mesh.positions[mesh.from(h)], &to = mesh.positions[mesh.to(h)];
      middles_.set(i++, (0.5 * (from + to) - origin).cast<float>(), Vec3f::Zero(), std::numeric_limits<float>::max());
      half_ = std::max(half_, static_cast<float>(0.5 * (to - from).norm()));
    }
    middles_.fill_boxes();
  }

  /// Whether a border may be within kCellRadius spacings of the box's from what is in the box.
  bool may_be_near(PointBlocks::Box box, PointBlocks::Scratch& scratch) const {
    constexpr float kRounding = 1.001F;
    box.spacing = kCellRadius * box.spacing + half_;
    middles_.list_near(box, kRounding, scratch);
    return !scratch.near.empty();
  }

 private:
  PointBlocks middles_;
  float half_ = 0;  // of the longest edge
};

class Relaxation {
 public:
  Relaxation(const TriangleMesh& mesh, const PointSet& points, const ExecutionContext& context)
      : mesh_(mesh),
        surface_(mesh),
        borders_(mesh, points.origin),
        context_(context),
        origin_(points.origin),
        points_(points.size()),
        places_(points.size()),
        first_(points.size()),
        spacing_(points.size()) {
    for_blocks(context, points.size(), kGrain * PointBlocks::kBlock, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const FacePlace& place = points.places[i];
        places_[i] = surface_.place(place.face, static_cast<double>(place.weight_1), static_cast<double>(place.weight_2));
        first_[i] = places_[i].position;
        spacing_[i] = static_cast<float>(packed_distance(SplatRadius::area_of_point(points.radii[i]), 1));
      }
    });
  }

  /// Moves all points over the centres of their cells.
  absl::Status centre() {
    set_all();
    for_all_blocks([&](std::size_t b, PointBlocks::Scratch& scratch) {
      const bool has_borders = borders_.may_be_near(points_.box(b), scratch);
      points_.list_near(points_.box(b), kCellReach, scratch, kCellLeast);
      for (std::size_t i = b * PointBlocks::kBlock; i < b * PointBlocks::kBlock + points_.size_of(b); ++i) {
        VoronoiCell cell = voronoi_cell(points_, i, scratch);
        if (has_borders) cut_at_borders(i, cell);
        go(i, kRate * cell.centre().cast<double>(), kMostCentred * static_cast<double>(spacing_[i]));
      }
    });
    return context_.check_limit();
  }

  /// Parts points that are too near to others all the same, in sweeps. Only those are looked at again that were so, and what they
  /// came near.
  absl::Status part(int sweeps) {
    set_all();
    const float apart_behind = has_sheets() ? kApartInSheets : kApart;
    std::vector<std::uint8_t> is_awake(places_.size(), 1), wakes(places_.size());
    for (int sweep = 0; sweep < sweeps && std::find(is_awake.begin(), is_awake.end(), 1) != is_awake.end(); ++sweep) {
      for_all_blocks([&](std::size_t b, PointBlocks::Scratch& scratch) {
        const Overlap overlap = find_overlap(points_, b, apart_behind, is_awake, wakes, scratch);
        for (std::size_t k = 0; k < PointBlocks::kBlock; ++k) {
          const std::size_t i = b * PointBlocks::kBlock + k;
          if (overlap.is_found[k]) go(i, overlap.steps[k].cast<double>(), kMostMove * static_cast<double>(spacing_[i]));
        }
      });
      if (absl::Status status = context_.check_limit(); !status.ok()) return status;
      for (std::size_t i = 0; i < places_.size(); ++i) {
        if (wakes[i] != 0) points_.move(i, local(places_[i]), surface_.normal(places_[i].face).cast<float>());
      }
      is_awake.swap(wakes);
      std::fill(wakes.begin(), wakes.end(), 0);
    }
    return absl::OkStatus();
  }

  const WalkPlace& place(std::size_t i) const { return places_[i]; }

 private:
  Vec3f local(const WalkPlace& place) const { return (place.position - origin_).cast<float>(); }

  void set_all() {
    for (std::size_t i = 0; i < places_.size(); ++i) {
      points_.set(i, local(places_[i]), surface_.normal(places_[i].face).cast<float>(), spacing_[i]);
    }
    points_.fill_boxes();
  }

  /// Whether the surface is thinner than the spacing over much of it.
  bool has_sheets() {
    std::atomic<std::size_t> behind = 0, all = 0;
    for_all_blocks([&](std::size_t b, PointBlocks::Scratch& scratch) {
      if (b % kLookAt != 0) return;
      behind += count_too_near_behind(points_, b, scratch);
      all += points_.size_of(b);
    });
    return static_cast<double>(behind) > kMostBehind * static_cast<double>(all);
  }

  /// Calls work(block, scratch), which may move the block's own points: what it reads of others is how they were before.
  template <typename Work>
  void for_all_blocks(const Work& work) {
    for_blocks(context_, points_.block_count(), kGrain, [&](std::size_t begin, std::size_t end) {
      if (!context_.check_limit().ok()) return;
      WorkLimit::Meter meter(context_.limit);
      PointBlocks::Scratch scratch;
      for (std::size_t b = begin; b < end; ++b) work(b, scratch);
      meter.settle();
    });
  }

  /// Walks on, but no farther than `most` from where the point was at first. Where the surface bends, a walk may end farther from
  /// there than its aim: then a part of it has to do.
  void go(std::size_t i, Vec3d step, double most) {
    WalkPlace& place = places_[i];
    const Vec3d away = place.position + step - first_[i];
    if (const double distance = away.norm(); distance > most) step += (most / distance - 1) * away;
    for (int attempt = 0; attempt < kAttempts; ++attempt, step /= 2) {
      const SurfaceWalk::End end = surface_.straight(place, step);
      if (end.border != kNone || (end.place.position - first_[i]).norm() > most) continue;
      place = end.place;
      return;
    }
  }

  /// Takes off what is beyond the borders around a point.
  void cut_at_borders(std::size_t i, VoronoiCell& cell) const {
    const double radius = kCellRadius * static_cast<double>(spacing_[i]);
    for (std::size_t k = 0; k < VoronoiCell::kDirections; ++k) {
      const Vec3d aim = radius * cell.direction(k).cast<double>();
      const SurfaceWalk::End end = surface_.straight(places_[i], aim);
      if (end.border == kNone) continue;
      const Vec3d way = end.place.position - places_[i].position;
      const Vec3d along = (mesh_.positions[mesh_.to(end.border)] - mesh_.positions[mesh_.from(end.border)]).normalized();
      const Vec3d across = way - way.dot(along) * along;
      if (across.squaredNorm() > kLeastSine * kLeastSine * way.squaredNorm()) cell.cut(across.cast<float>(), 1);
    }
  }

  const TriangleMesh& mesh_;
  const SurfaceWalk surface_;
  const Borders borders_;
  const ExecutionContext& context_;
  const Vec3d origin_;
  PointBlocks points_;
  std::vector<WalkPlace> places_;
  std::vector<Vec3d> first_;  // where they were
  std::vector<float> spacing_;
};

/// Writes where points are, and what is there.
void write(const Relaxation& moved, const SurfaceData& data, PointSet& points, const ExecutionContext& context) {
  for_blocks(context, points.size(), kGrain * PointBlocks::kBlock, [&](std::size_t begin, std::size_t end) {
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
  const MeshView& mesh = base.data.mesh;
  const std::uint64_t bytes = 32 * mesh.positions.size() + 32 * mesh.triangles.size();
  MemoryClaim claim(context);
  const std::string what = absl::StrFormat("finding the neighbours of %d triangles takes %s of memory", mesh.triangles.size(),
                                           describe_bytes(static_cast<double>(bytes)));
  if (absl::Status status = claim.set(bytes, what); !status.ok()) return status;
  if (!base.is_all_sound()) return base.status();
  const absl::StatusOr<TriangleMesh> joined = surface_mesh(mesh, base.data.borders, context);
  if (!joined.ok()) return joined.status();
  return move_apart(*joined, base.data, rounds, points, context);
}

absl::Status move_apart(const TriangleMesh& mesh, const SurfaceData& data, int rounds, PointSet& points,
                        const ExecutionContext& context) {
  if (rounds == 0 || points.size() < 2) return absl::OkStatus();
  const std::uint64_t bytes = kBytesPerBorder * Borders::count(mesh) + kBytesPerPoint * points.size();
  MemoryClaim claim(context);
  const std::string what = absl::StrFormat("moving %d points apart on %d triangles takes %s of memory", points.size(),
                                           mesh.triangles.size(), describe_bytes(static_cast<double>(bytes)));
  if (absl::Status status = claim.set(bytes, what); !status.ok()) return status;
  Relaxation relaxation(mesh, points, context);
  for (int round = 0; round < rounds; ++round) {
    context.progress(kStage, static_cast<double>(round) / rounds);
    if (absl::Status status = relaxation.centre(); !status.ok()) return status;
  }
  if (absl::Status status = relaxation.part(std::min(kSweeps * rounds, kMostSweeps)); !status.ok()) return status;
  write(relaxation, data, points, context);
  return context.check();
}

}  // namespace curvecast
