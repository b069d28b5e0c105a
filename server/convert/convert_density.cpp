#include "server/convert/convert_density.h"

#include <absl/strings/str_cat.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <variant>

#include "core/density/expression.h"
#include "server/base/protocol.h"
#include "server/convert/convert.h"

namespace curvecast::server {
namespace {

CurvatureTerm to_core(FieldValidator& check, const std::string& field, const v1::CurvatureDensity& in) {
  CurvatureTerm term;
  switch (in.kind()) {
    case v1::CURVATURE_KIND_UNSPECIFIED:
    case v1::CURVATURE_KIND_GAUSS:
      term.kind = CurvatureKind::kGauss;
      break;
    case v1::CURVATURE_KIND_MEAN:
      term.kind = CurvatureKind::kMean;
      break;
    case v1::CURVATURE_KIND_MAX:
      term.kind = CurvatureKind::kMax;
      break;
    default:
      check.fail(field + ".kind", absl::StrCat("has the unknown value ", static_cast<int>(in.kind())));
  }
  if (in.has_exponent()) {
    term.exponent = check.finite(field + ".exponent", in.exponent());
    if (term.exponent < 0) check.fail(field + ".exponent", absl::StrCat("is ", term.exponent, "; it must not be negative"));
  }
  if (in.has_floor()) term.floor = check.in_range(field + ".floor", in.floor(), 0.0, 1.0);
  return term;
}

ViewTerm to_core(FieldValidator& check, const std::string& field, const v1::ViewDensity& in) {
  ViewTerm term;
  if (in.has_s0()) {
    term.s0 = check.finite(field + ".s0", in.s0());
    if (term.s0 <= 0 || term.s0 > kMaxS0) {
      check.fail(field + ".s0", absl::StrCat("is ", term.s0, "; it must be above 0 and at most ", kMaxS0));
    }
  }
  return term;
}

double not_negative(FieldValidator& check, const std::string& field, double value) {
  check.finite(field, value);
  if (value < 0) check.fail(field, absl::StrCat("is ", value, "; it must not be negative"));
  return value;
}

DistanceTerm to_core(FieldValidator& check, const std::string& field, const v1::DistanceDensity& in) {
  DistanceTerm term;
  term.near = not_negative(check, field + ".near", in.near());
  if (const double far = not_negative(check, field + ".far", in.far()); far != 0) {
    if (far < term.near) check.fail(field + ".far", absl::StrCat("is ", far, ", less than near, ", term.near));
    term.far = far;
  }
  term.global = in.global();
  switch (in.fall()) {
    case v1::DISTANCE_FALL_UNSPECIFIED:
    case v1::DISTANCE_FALL_INVERSE_SQUARE:
      break;
    case v1::DISTANCE_FALL_INVERSE:
      term.fall = DistanceFall::kInverse;
      break;
    case v1::DISTANCE_FALL_LINEAR:
      term.fall = DistanceFall::kLinear;
      if (!std::isfinite(term.far)) check.fail(field + ".fall", "is LINEAR, which needs a far");
      break;
    default:
      check.fail(field + ".fall", absl::StrCat("has the unknown value ", static_cast<int>(in.fall())));
  }
  if (in.fall() != v1::DISTANCE_FALL_UNSPECIFIED && !term.global) check.fail(field + ".fall", "is of global terms only");
  return term;
}

AttributeTerm to_core(FieldValidator& check, const std::string& field, const v1::AttributeDensity& in) {
  if (in.name().empty()) check.fail(field + ".name", "is empty");
  return {in.name()};
}

/// Adds a stroke's dabs.
void add_stroke(FieldValidator& check, const std::string& field, const v1::BrushStroke& in, std::vector<Dab>& dabs) {
  Dab dab;
  const Vec3d first = check.vector(field + ".centre", in.centre());
  dab.radius = check.finite(field + ".radius", in.radius());
  if (dab.radius <= 0) check.fail(field + ".radius", absl::StrCat("is ", dab.radius, "; it must be above 0"));
  dab.factor = check.in_range(field + ".factor", in.factor(), 0.0, kMaxBrushFactor);
  if (in.has_falloff()) dab.falloff = check.in_range(field + ".falloff", in.falloff(), 0.0, 1.0);
  dab.centre = first;
  dabs.push_back(dab);
  if (in.path_size() % 3 != 0) {
    check.fail(field + ".path", absl::StrCat("has ", in.path_size(), " numbers, not three for each dab"));
    return;
  }
  for (int i = 0; i < in.path_size(); i += 3) {
    const auto coordinate = [&](int k) { return check.finite(field + ".path", static_cast<double>(in.path(i + k))); };
    dab.centre = first + Vec3d(coordinate(0), coordinate(1), coordinate(2));
    dabs.push_back(dab);
  }
}

BrushTerm to_core(FieldValidator& check, const std::string& field, const v1::BrushDensity& in) {
  BrushTerm term;
  for (int i = 0; i < in.strokes_size() && check.ok(); ++i) {
    add_stroke(check, absl::StrCat(field, ".strokes[", i, "]"), in.strokes(i), term.dabs);
  }
  return term;
}

std::size_t dabs_of(const DensityTerms& terms) {
  std::size_t count = 0;
  for (const v1::DensityTerm& term : terms) {
    for (const v1::BrushStroke& stroke : term.brush().strokes()) count += 1 + static_cast<std::size_t>(stroke.path_size()) / 3;
  }
  return count;
}

ExpressionTerm to_core(FieldValidator& check, const std::string& field, const v1::ExpressionDensity& in) {
  if (const absl::Status status = check_expression(in.text()); !status.ok()) {
    check.fail(field + ".text:", std::string(status.message()));
  }
  return {in.text()};
}

DensityTerm to_core(FieldValidator& check, const std::string& field, const v1::DensityTerm& in) {
  switch (in.term_case()) {
    case v1::DensityTerm::kUniform:
      return UniformTerm{};
    case v1::DensityTerm::kCurvature:
      return to_core(check, field + ".curvature", in.curvature());
    case v1::DensityTerm::kView:
      return to_core(check, field + ".view", in.view());
    case v1::DensityTerm::kAttribute:
      return to_core(check, field + ".attribute", in.attribute());
    case v1::DensityTerm::kBrush:
      return to_core(check, field + ".brush", in.brush());
    case v1::DensityTerm::kDistance:
      return to_core(check, field + ".distance", in.distance());
    case v1::DensityTerm::kFrustum:
      return FrustumTerm{};
    case v1::DensityTerm::kScreen:
      return ScreenTerm{};
    case v1::DensityTerm::kPicture:
      return PictureTerm{};
    case v1::DensityTerm::kExpression:
      return to_core(check, field + ".expression", in.expression());
    case v1::DensityTerm::TERM_NOT_SET:
      break;
  }
  check.fail(field, "holds no term that this server knows");
  return UniformTerm{};
}

Camera to_core(FieldValidator& check, const std::string& field, const v1::Camera& in, const v1::Viewport& viewport) {
  Camera camera;
  camera.eye = check.vector(field + ".eye", in.eye());
  camera.target = check.vector(field + ".target", in.target());
  if (in.has_up()) camera.up = check.vector(field + ".up", in.up());
  if (const double fov = in.vertical_fov_degrees(); fov != 0) {
    if (!(fov > 0 && fov < 180)) {
      check.fail(field + ".vertical_fov_degrees", absl::StrCat("is ", fov, "; it must lie between 0 and 180, or be 0 for 45"));
    }
    camera.fov = fov * std::numbers::pi / 180;
  }
  camera.height = not_negative(check, field + ".orthographic_height", in.orthographic_height());
  if (viewport.width() > 0 && viewport.height() > 0) {
    camera.aspect = static_cast<double>(viewport.width()) / viewport.height();
    camera.pixels = viewport.height();
  }
  if (!check.ok()) return camera;
  if (const absl::Status status = check_camera(camera); !status.ok()) check.fail(field + ":", std::string(status.message()));
  return camera;
}

// Of each kind of term, with the same fields.
void fill(const UniformTerm&, v1::DensityTerm& out) { out.mutable_uniform(); }

void fill(const CurvatureTerm& term, v1::DensityTerm& out) {
  out.mutable_curvature()->set_kind(term.kind == CurvatureKind::kMean  ? v1::CURVATURE_KIND_MEAN
                                    : term.kind == CurvatureKind::kMax ? v1::CURVATURE_KIND_MAX
                                                                       : v1::CURVATURE_KIND_GAUSS);
  out.mutable_curvature()->set_exponent(term.exponent);
  out.mutable_curvature()->set_floor(term.floor);
}

void fill(const ViewTerm& term, v1::DensityTerm& out) { out.mutable_view()->set_s0(term.s0); }

void fill(const DistanceTerm& term, v1::DensityTerm& out) {
  out.mutable_distance()->set_near(term.near);
  if (std::isfinite(term.far)) out.mutable_distance()->set_far(term.far);
  out.mutable_distance()->set_global(term.global);
  if (!term.global) return;
  out.mutable_distance()->set_fall(term.fall == DistanceFall::kInverse  ? v1::DISTANCE_FALL_INVERSE
                                   : term.fall == DistanceFall::kLinear ? v1::DISTANCE_FALL_LINEAR
                                                                        : v1::DISTANCE_FALL_INVERSE_SQUARE);
}

void fill(const FrustumTerm&, v1::DensityTerm& out) { out.mutable_frustum(); }
void fill(const ScreenTerm&, v1::DensityTerm& out) { out.mutable_screen(); }
void fill(const PictureTerm&, v1::DensityTerm& out) { out.mutable_picture(); }
void fill(const AttributeTerm& term, v1::DensityTerm& out) { out.mutable_attribute()->set_name(term.name); }

void fill(const BrushTerm& term, v1::DensityTerm& out) {
  for (const Dab& dab : term.dabs) {
    v1::BrushStroke& stroke = *out.mutable_brush()->add_strokes();
    *stroke.mutable_centre() = to_proto(dab.centre);
    stroke.set_radius(dab.radius);
    stroke.set_factor(dab.factor);
    stroke.set_falloff(dab.falloff);
  }
}

void fill(const ExpressionTerm& term, v1::DensityTerm& out) { out.mutable_expression()->set_text(term.text); }

}  // namespace

void check_viewport(FieldValidator& check, const std::string& field, const v1::Viewport* viewport) {
  if (viewport == nullptr) return;
  if (viewport->width() == 0) check.fail(field + ".width", "is 0");
  if (viewport->height() == 0) check.fail(field + ".height", "is 0");
}

std::vector<Camera> to_cameras(FieldValidator& check, const std::string& field, const Cameras& cameras,
                               const v1::Viewport& viewport) {
  std::vector<Camera> out;
  if (cameras.size() > static_cast<int>(kMaxCameras)) {
    check.fail(field, absl::StrCat("has ", cameras.size(), " cameras; at most ", kMaxCameras, " are taken"));
  }
  for (int i = 0; check.ok() && i < cameras.size(); ++i) {
    out.push_back(to_core(check, absl::StrCat(field, "[", i, "]"), cameras[i], viewport));
  }
  return out;
}

Density to_density(FieldValidator& check, const std::string& field, const DensityTerms& terms, std::vector<Camera> cameras,
                   const std::string& why) {
  Density out;
  if (terms.size() > kMaxDensityTerms) {
    check.fail(field, absl::StrCat("has ", terms.size(), " terms; at most ", kMaxDensityTerms, " are taken"));
  }
  if (const std::size_t dabs = dabs_of(terms); dabs > kMaxDabs) {
    check.fail(field, absl::StrCat("has ", dabs, " dabs of the brush; at most ", kMaxDabs, " are taken"));
  }
  for (int i = 0; check.ok() && i < terms.size(); ++i) {
    const std::string name = absl::StrCat(field, "[", i, "]");
    out.terms.push_back(to_core(check, name, terms[i]));
    if (cameras.empty() && is_camera_term(out.terms.back())) check.fail(name, why);
  }
  out.cameras = std::move(cameras);
  return out;
}

v1::DensityTerm to_proto(const DensityTerm& term) {
  v1::DensityTerm out;
  std::visit([&](const auto& t) { fill(t, out); }, term);
  return out;
}

}  // namespace curvecast::server
