#include "server/convert_density.h"

#include <absl/strings/str_cat.h>
#include <Eigen/Geometry>

#include <type_traits>
#include <variant>

namespace curvecast::server {
namespace {

constexpr int kMaxTerms = 16;

// Of the same direction; lengths from the smallest to the largest doubles neither vanish nor overflow.
Vec3d direction(const Vec3d& v) { return (v / v.cwiseAbs().maxCoeff()).normalized(); }

CurvatureTerm to_core(Checker& check, const std::string& field, const v1::CurvatureDensity& in) {
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

ViewTerm to_core(Checker& check, const std::string& field, const v1::ViewDensity& in, const absl::StatusOr<Vec3d>& eye) {
  ViewTerm term;
  if (!eye.ok()) {
    check.fail(field, std::string(eye.status().message()));
  } else {
    term.eye = *eye;
  }
  if (in.has_s0()) {
    term.s0 = check.finite(field + ".s0", in.s0());
    if (term.s0 <= 0 || term.s0 > kMaxS0) {
      check.fail(field + ".s0", absl::StrCat("is ", term.s0, "; it must be above 0 and at most ", kMaxS0));
    }
  }
  return term;
}

}  // namespace

Vec3d check_camera(Checker& check, const std::string& field, const v1::Camera& camera) {
  const Vec3d eye = check.vector(field + ".eye", camera.eye());
  const Vec3d target = check.vector(field + ".target", camera.target());
  const Vec3d up = camera.has_up() ? check.vector(field + ".up", camera.up()) : Vec3d::UnitY();
  const double fov = camera.vertical_fov_degrees();
  if (!(fov == 0 || (fov > 0 && fov < 180))) {
    check.fail(field + ".vertical_fov_degrees", absl::StrCat("is ", fov, "; it must lie between 0 and 180, or be 0 for 45"));
  }
  if (!check.ok()) return eye;
  const Vec3d view = 0.5 * target - 0.5 * eye;
  if (view.isZero(0)) {
    check.fail(field, "looks nowhere: eye and target are the same point");
  } else if (up.isZero(0)) {
    check.fail(field + ".up", "has no length");
  } else if (direction(view).cross(direction(up)).norm() < 1e-9) {
    check.fail(field + ".up", "is along the view; choose another direction");
  }
  return eye;
}

std::vector<DensityTerm> to_density(Checker& check, const std::string& field, const DensityTerms& terms,
                                    const absl::StatusOr<Vec3d>& eye) {
  std::vector<DensityTerm> out;
  if (terms.size() > kMaxTerms) {
    check.fail(field, absl::StrCat("has ", terms.size(), " terms; at most ", kMaxTerms, " are taken"));
  }
  for (int i = 0; check.ok() && i < terms.size(); ++i) {
    const std::string name = absl::StrCat(field, "[", i, "]");
    switch (terms[i].term_case()) {
      case v1::DensityTerm::kUniform:
        out.emplace_back(UniformTerm{});
        break;
      case v1::DensityTerm::kCurvature:
        out.emplace_back(to_core(check, name + ".curvature", terms[i].curvature()));
        break;
      case v1::DensityTerm::kView:
        out.emplace_back(to_core(check, name + ".view", terms[i].view(), eye));
        break;
      case v1::DensityTerm::TERM_NOT_SET:
        check.fail(name, "holds no term that this server knows");
        break;
    }
  }
  return out;
}

v1::DensityTerm to_proto(const DensityTerm& term) {
  v1::DensityTerm out;
  if (std::holds_alternative<UniformTerm>(term)) {
    out.mutable_uniform();
  } else if (const auto* curvature = std::get_if<CurvatureTerm>(&term)) {
    out.mutable_curvature()->set_kind(curvature->kind == CurvatureKind::kMean  ? v1::CURVATURE_KIND_MEAN
                                      : curvature->kind == CurvatureKind::kMax ? v1::CURVATURE_KIND_MAX
                                                                               : v1::CURVATURE_KIND_GAUSS);
    out.mutable_curvature()->set_exponent(curvature->exponent);
    out.mutable_curvature()->set_floor(curvature->floor);
  } else {
    out.mutable_view()->set_s0(std::get<ViewTerm>(term).s0);
  }
  return out;
}

}  // namespace curvecast::server
