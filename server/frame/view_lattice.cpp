#include "server/frame/view_lattice.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/codec/position_bits.h"

namespace curvecast::server {
namespace {

constexpr double kFloatError = 0.5 * std::numeric_limits<float>::epsilon();  // of a length, relative to it

/// The nearest of some points to a place.
struct Nearest {
  Vec3f place;
  Vec3f position = Vec3f::Zero();
  float square = std::numeric_limits<float>::infinity();  // of the distance
  float distance = std::numeric_limits<float>::infinity();

  void add(const Vec3f& p) {
    const float d = (p - place).squaredNorm();
    if (d < square) square = d, distance = std::sqrt(d), position = p;
  }
  bool is_found() const { return std::isfinite(square); }
};

void find(const PointSet& points, Nearest& nearest) {
  for (const Vec3f& position : points.positions) nearest.add(position);
}

void find(const RankSelection& selection, Nearest& nearest) {
  // From the deepest chunks on, which are near: the others are farther then, as a rule.
  for (auto part = selection.parts.rbegin(); part != selection.parts.rend(); ++part) {
    const RankChunk& chunk = *part->chunk;
    const RunBounds& bounds = chunk.bounds;
    const std::uint64_t* const words = &selection.shown[part->first_bit / RankSelection::kWord];
    for (std::size_t run = 0; run < kChunkRuns; ++run) {
      const Vec3f middle(bounds.x[run], bounds.y[run], bounds.z[run]);
      const float reach = nearest.distance + bounds.radius[run];
      if ((middle - nearest.place).squaredNorm() >= reach * reach) continue;
      for (std::size_t layer = 0; layer < chunk.layers(); ++layer) {
        const std::size_t first = layer * kLayerStrata + run * kRunPoints;
        for (std::size_t i = first; i < first + kRunPoints; ++i) {
          if ((words[i / RankSelection::kWord] >> i % RankSelection::kWord & 1) == 0) continue;
          nearest.add(Vec3f(chunk.x[i], chunk.y[i], chunk.z[i]));
        }
      }
    }
  }
}

/// `origin`: from where the positions count.
template <typename Points>
LatticeNeed need_of(const PointSetRequest& request, const Box3d& box, const Vec3d& origin, const Points& points) {
  LatticeNeed need;
  if (!request.draco) return need;
  need.is_open = request.draco->position_bits == kAutomaticBits;
  need.best.bits = request.draco->position_bits;
  if (!need.is_open) return need;
  const Vec3d size = box.max - box.min;
  for (const Camera& camera : request.options.density.cameras) {
    Nearest nearest{((camera.is_orthographic() ? camera.target : camera.eye) - origin).cast<float>()};
    find(points, nearest);
    if (!nearest.is_found()) continue;
    const double pixels = pixels_per_length(camera, std::sqrt(static_cast<double>(nearest.square)), size.norm());
    if (pixels <= need.pixels) continue;
    need.pixels = pixels;
    need.nearest = nearest.position.cast<double>() + origin;
  }
  need.best.bits = need.pixels > 0 ? position_bits_for(need.pixels, size.maxCoeff()) : kPlainPositionBits;
  if (need.best.bits > kMostCornerBits) need.best.centre = need.nearest;
  return need;
}

}  // namespace

bool LatticeNeed::is_met_by(const ViewLattice& held) const {
  if (!is_open) return held == best;
  if (held.bits + kMostMissingBits < best.bits) return false;
  if (!held.centre) return best.bits <= kMostCornerBits;
  return (nearest - *held.centre).cwiseAbs().maxCoeff() * kFloatError * pixels <= kMostFloatPixels;
}

ViewLattice LatticeNeed::beside(const ViewLattice& held) const {
  return is_open ? ViewLattice{.bits = best.bits, .centre = held.centre} : held;
}

LatticeNeed lattice_need(const PointSetRequest& request, const Box3d& box, const PointSet& points) {
  return need_of(request, box, points.origin, points);
}

LatticeNeed lattice_need(const PointSetRequest& request, const SurfaceCurve& curve, const RankSelection& selection) {
  return need_of(request, curve.box, curve.origin, selection);
}

void move_origin(const ViewLattice& lattice, PointSet& points) {
  if (!lattice.centre || points.origin == *lattice.centre) return;
  const Vec3d shift = points.origin - *lattice.centre;
  for (Vec3f& position : points.positions) position = (position.cast<double>() + shift).cast<float>();
  points.origin = *lattice.centre;
}

std::optional<DracoOptions> draco_options(const PointSetRequest& request, const ViewLattice& lattice) {
  std::optional<DracoOptions> options = request.draco;
  if (options) {
    options->position_bits = lattice.bits;
    options->is_centred = lattice.centre.has_value();
  }
  return options;
}

}  // namespace curvecast::server
