// The places in a leaf of the curve, on the surface itself. Below a leaf the Hilbert curve goes on, as deep as one likes, and the
// surface's area along it is measured triangle by triangle. So points that are closer together than the curve's vertices lie
// where the surface is, and evenly.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <vector>

#include "core/base/colour.h"
#include "core/curve/curve_base.h"
#include "core/curve/locate_triangle.h"
#include "core/curve/surface_curve.h"
#include "core/curve/surface_map.h"

namespace curvecast {

/// A place on the curve: where it has passed a part, in [0, 1], of a leaf's area.
struct LeafPart {
  std::uint32_t leaf;
  double part;
};

/// A curve and what it lies on. What it says of a leaf depends on the leaf alone, not on what was asked before. Any number of
/// threads may ask. Who has asked looks at status() before the answers are used.
class LeafSurface {
 public:
  /// Precondition: the curve was made on the base.
  LeafSurface(std::shared_ptr<const CurveBase> base, std::shared_ptr<const SurfaceCurve> curve);

  const SurfaceCurve& curve() const { return *curve_; }
  const std::shared_ptr<const SurfaceCurve>& shared_curve() const { return curve_; }

  /// Finds the places at which the curve has passed the parts (ascending, in [0, 1]) of leaf l's area, as many as `places`,
  /// relative to the curve's origin. Within pieces of the leaf that have at most `grain` of its area or lie in one triangle, area
  /// is taken to be even, as in the latter it is.
  void find(std::size_t l, std::span<const double> parts, double grain, std::span<SurfacePlace> places) const;

  /// Finds places in leaves whose area is taken to be even, as many as `at`: much faster, and as good where there are only a few
  /// places in each leaf. The order is free; quickest is that of the curve.
  void find_even(std::span<const LeafPart> at, std::span<SurfacePlace> places) const;

  /// OK, or how the file is damaged in which a leaf lies that was asked for; what was found there means nothing.
  absl::Status status() const { return base_->status(); }

  /// Returns what is known of the surface, for a face in the disc of leaf l; null where that cannot be used: see status().
  const SurfaceData* data_of(std::size_t l, std::uint32_t face) const;

  /// Returns what is known of the surface, for any face; null where some of it cannot be used: see status().
  const SurfaceData* data() const { return base_->is_all_sound() ? &base_->data : nullptr; }

  bool has_colour() const { return base_->data.colour != nullptr; }
  /// Returns the surface's colour at a place in leaf l, averaged over about a share of the whole surface, and over no more than
  /// the leaf. `weights`: of the face's second and third corner. Precondition: has_colour().
  Rgba8 colour(std::size_t l, std::uint32_t face, std::array<float, 2> weights, double share) const;

 private:
  class Finder;
  std::size_t disc_of(std::size_t l) const;
  /// What a thread uses again.
  struct Memory {
    std::map<std::size_t, TouchingTriangles> touching;  // by disc
    std::vector<std::uint32_t> numbers;                 // of the triangles that touch a leaf
    std::vector<ParameterTriangle> triangles;           // these
    std::vector<std::vector<std::uint32_t>> lists;      // which of them touch the pieces on the way down, by depth
    LeafBatch batch;
  };

  std::shared_ptr<const CurveBase> base_;
  std::shared_ptr<const SurfaceCurve> curve_;
  mutable tbb::enumerable_thread_specific<Memory> memory_;
};

}  // namespace curvecast
