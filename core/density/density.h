// Density terms and their product, evaluated on the curve (paper, sections 3.4 and 4.3).
#pragma once

#include <absl/status/status.h>

#include <initializer_list>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/base/execution_context.h"
#include "core/base/vec.h"
#include "core/curve/surface_curve.h"
#include "core/density/camera.h"

namespace curvecast {

struct UniformTerm {
  bool operator==(const UniformTerm&) const = default;
};

/// (floor + (1 - floor) min(|k| / k_ref, 1))^exponent, where k_ref is the curve's reference_curvature: only a twentieth of
/// the area is curved more. 1 everywhere on a flat surface.
struct CurvatureTerm {
  CurvatureKind kind = CurvatureKind::kGauss;
  double exponent = 1;  // >= 0
  double floor = 0.05;  // in [0, 1], relative to k_ref: flat regions keep this density

  bool operator==(const CurvatureTerm&) const = default;
};

inline constexpr double kMaxS0 = 1e6;

/// Silhouette enhancement: with c the cosine between normal and direction to the camera, 1 - c + s0 where c > 0, else 0.
struct ViewTerm {
  double s0 = 0.1;  // in (0, kMaxS0]: density of what faces the camera squarely

  bool operator==(const ViewTerm&) const = default;
};

/// How the number of points falls with the distance d of the box's centre, clamped to near .. far.
enum class DistanceFall {
  kInverseSquare,  // (near / d)^2: as many points for each pixel
  kInverse,        // near / d
  kLinear,         // (far - d) / (far - near)
};

/// Level of detail by the distance d to the eye: (near / clamp(d, near, far))^2. 1 for an orthographic camera.
struct DistanceTerm {
  /// In the file's units. 0: the distance from the eye to the mesh's box, but at least a thousandth of the box's diagonal; of a
  /// global term, the box's diagonal, from where the mesh about fills a picture.
  double near = 0;
  double far = std::numeric_limits<double>::infinity();  // at least `near`; finite for DistanceFall::kLinear
  bool global = false;                                   // not the density but the number of points falls: see scaled_points()
  DistanceFall fall = DistanceFall::kInverseSquare;      // of a global term; no other may be asked of a local one

  bool operator==(const DistanceTerm&) const = default;
};

/// 1 in the camera's picture, else 0. A perspective camera sees nothing nearer than kNearPlane.
struct FrustumTerm {
  bool operator==(const FrustumTerm&) const = default;
};
inline constexpr double kNearPlane = 1e-4;  // diagonals of the box before the eye

/// Even spacing on the screen: pixels' area per area of the surface, 0 for what faces away or lies behind the eye. What is seen
/// at a slant counts as if the cosine were kLeastSlant at least.
struct ScreenTerm {
  bool operator==(const ScreenTerm&) const = default;
};
inline constexpr double kLeastSlant = 0.05;

/// Points where the picture is wrong without them: in it and just beside it, a ScreenTerm, and more where the surface turns away
/// from the eye, bends, or changes its colour; see picture_detail.h. What faces away counts beside creases whose other side is
/// seen; see crease_band.h.
struct PictureTerm {
  bool operator==(const PictureTerm&) const = default;
};

/// The mesh's named number at each vertex, in any unit; negative ones and NaN count as 0.
struct AttributeTerm {
  std::string name;  // one of the curve's scalars

  bool operator==(const AttributeTerm&) const = default;
};

inline constexpr double kMaxBrushFactor = 1e6;

/// Moves the paint beneath it toward `factor`: all the way within (1 - falloff) radius of the centre, then smoothly less, not at
/// all from the radius on.
struct Dab {
  Vec3d centre = Vec3d::Zero();  // absolute coordinates, in the file's units
  double radius = 1;             // above 0, in the file's units
  double factor = 0;             // in [0, kMaxBrushFactor]; 0 takes points away, 1 takes paint away
  double falloff = 0.5;          // in [0, 1]; 0 = a hard edge

  bool operator==(const Dab&) const = default;
};

/// Paint, 1 where there is none: dabs in the order in which they were painted.
struct BrushTerm {
  std::vector<Dab> dabs;

  bool operator==(const BrushTerm&) const = default;
};

/// A formula's value; negative ones and NaN count as 0, infinite ones are an error. See expression.h.
struct ExpressionTerm {
  std::string text;

  bool operator==(const ExpressionTerm&) const = default;
};

using DensityTerm = std::variant<UniformTerm, CurvatureTerm, ViewTerm, DistanceTerm, FrustumTerm, ScreenTerm, AttributeTerm,
                                 BrushTerm, ExpressionTerm, PictureTerm>;

/// The fixed terms are multiplied, and so are those of a camera (view, distance, frustum, screen, picture) for each camera: the
/// density is the fixed product times the largest of the cameras'. What a picture term sees of the surface alone is one of the
/// fixed ones. No terms mean uniform.
struct Density {
  Density() = default;
  Density(std::initializer_list<DensityTerm> some) : terms(some) {}
  Density(std::vector<DensityTerm> some, std::vector<Camera> from = {}) : terms(std::move(some)), cameras(std::move(from)) {}

  std::vector<DensityTerm> terms;
  std::vector<Camera> cameras;  // at most kMaxCameras; at least one where there is a camera term
};

/// Says whether a term looks from a camera.
bool is_camera_term(const DensityTerm& term);

/// Checks a density. InvalidArgument names the term, or the camera, and the field that is out of range or not finite.
absl::Status check_density(const Density& density);

/// Say whether a term, or any, is fixed, or a picture term: differs over the surface in a way that is the same for all cameras.
bool is_fixed_term(const DensityTerm& term);
bool has_fixed_terms(std::span<const DensityTerm> terms);

/// Writes the product of the fixed terms at every curve vertex (L entries, relative values). InvalidArgument: the curve has no
/// such attribute, an expression is wrong, takes too many operations or is infinite somewhere. Cancelled; DeadlineExceeded: the
/// context's limit does not suffice. Precondition: check_density() finds nothing.
absl::Status evaluate_fixed_terms(const SurfaceCurve& curve, std::span<const DensityTerm> terms, std::span<float> density,
                                  const ExecutionContext& context = {});

/// Writes the whole density at every curve vertex to `values` (L entries, relative values: only ratios matter). Errors as of
/// check_density() and evaluate_fixed_terms().
absl::Status evaluate_density(const SurfaceCurve& curve, const Density& density, std::span<float> values,
                              const ExecutionContext& context = {});

}  // namespace curvecast
