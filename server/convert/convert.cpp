#include "server/convert/convert.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "core/sample/move_apart.h"
#include "server/base/hash.h"
#include "server/base/protocol.h"
#include "server/base/status_payload.h"
#include "server/convert/convert_density.h"
#include "server/convert/field_validator.h"

namespace curvecast::server {
namespace {

constexpr double kMaxOmega = 1000;
constexpr std::uint64_t kMinChartFaces = 1000, kMaxChartFaces = std::uint64_t{1} << 32;
// More than 5 GB of curve: what the two options may ask for together.
constexpr double kMaxCurveVertices = 1e8;
constexpr double kMaxPixelError = 10'000;

std::optional<DracoOptions> to_core(FieldValidator& check, const v1::Encoding& in) {
  if (in.has_raw()) return std::nullopt;
  DracoOptions draco{.position_bits = kAutomaticBits};
  if (const auto bits = in.draco().position_bits(); bits != 0) {
    draco.position_bits = static_cast<int>(check.in_range("sample.encoding.draco.position_bits", bits, 1u, 30u));
  }
  if (const auto bits = in.draco().normal_bits(); bits != 0) {
    draco.normal_bits = static_cast<int>(check.in_range("sample.encoding.draco.normal_bits", bits, 2u, 30u));
  }
  return draco;
}

Sequence to_core(FieldValidator& check, v1::Sequence in) {
  switch (in) {
    case v1::SEQUENCE_UNSPECIFIED:
    case v1::SEQUENCE_JITTERED:
      return Sequence::kJittered;
    case v1::SEQUENCE_REGULAR:
      return Sequence::kRegular;
    case v1::SEQUENCE_VAN_DER_CORPUT:
      return Sequence::kVanDerCorput;
    case v1::SEQUENCE_GOLDEN_RATIO:
      return Sequence::kGoldenRatio;
    default:
      check.fail("sample.sequence", absl::StrCat("has the unknown value ", static_cast<int>(in)));
      return Sequence::kJittered;
  }
}

Sampler to_core(FieldValidator& check, v1::Sampler in) {
  switch (in) {
    case v1::SAMPLER_UNSPECIFIED:
    case v1::SAMPLER_EQUALISED:
      return Sampler::kEqualised;
    case v1::SAMPLER_PROGRESSIVE:
      return Sampler::kProgressive;
    default:
      check.fail("sample.sampler", absl::StrCat("has the unknown value ", static_cast<int>(in)));
      return Sampler::kEqualised;
  }
}

Mapper to_core(FieldValidator& check, v1::Mapper in) {
  switch (in) {
    case v1::MAPPER_UNSPECIFIED:
    case v1::MAPPER_EXACT:
      return Mapper::kExact;
    case v1::MAPPER_ID_BUFFER:
      return Mapper::kIdBuffer;
    default:
      check.fail("options.mapper", absl::StrCat("has the unknown value ", static_cast<int>(in)));
      return Mapper::kExact;
  }
}

AreaElement to_core(FieldValidator& check, v1::AreaElement in) {
  switch (in) {
    case v1::AREA_ELEMENT_UNSPECIFIED:
    case v1::AREA_ELEMENT_EXACT:
      return AreaElement::kExact;
    case v1::AREA_ELEMENT_VORONOI:
      return AreaElement::kVoronoi;
    default:
      check.fail("options.area_element", absl::StrCat("has the unknown value ", static_cast<int>(in)));
      return AreaElement::kExact;
  }
}

v1::SessionOptions to_proto(const PreprocessOptions& options) {
  v1::SessionOptions out;
  out.set_max_points(options.points);
  out.set_omega(options.omega);
  out.set_parameteriser(options.parameteriser == Parameteriser::kCgal ? v1::PARAMETERISER_CGAL : v1::PARAMETERISER_OWN);
  out.set_mapper(options.mapper == Mapper::kIdBuffer ? v1::MAPPER_ID_BUFFER : v1::MAPPER_EXACT);
  out.set_area_element(options.area_element == AreaElement::kVoronoi ? v1::AREA_ELEMENT_VORONOI : v1::AREA_ELEMENT_EXACT);
  for (const DensityTerm& term : options.density) *out.add_density() = server::to_proto(term);
  out.set_seed(options.seed);
  out.set_chart_faces(options.chart_faces);
  if (options.crease_degrees) out.set_crease_degrees(*options.crease_degrees);
  return out;
}

v1::PreprocessReport to_proto(const PreprocessReport& report, const std::string& mesh_name, std::uint64_t peak_bytes) {
  v1::PreprocessReport out;
  *out.mutable_mesh() = server::to_proto(report.mesh, mesh_name);
  out.set_discs(report.discs);
  out.set_curve_vertices(report.curve_vertices);
  out.set_max_level(report.max_level);
  out.set_flipped_triangles(report.flipped_triangles);
  out.set_area_error(report.area_error);
  *out.mutable_distortion() = server::to_proto(report.distortion);
  out.set_fallback_discs(report.fallback_discs);
  v1::StageSeconds& seconds = *out.mutable_seconds();
  seconds.set_read(report.seconds.read);
  seconds.set_repair(report.seconds.repair);
  seconds.set_cut(report.seconds.cut);
  seconds.set_parameterise(report.seconds.parameterise);
  seconds.set_curve(report.seconds.curve);
  seconds.set_map(report.seconds.map);
  seconds.set_area(report.seconds.area);
  seconds.set_total(report.seconds.total);
  out.set_curve_bytes(report.curve_bytes);
  out.set_peak_bytes(peak_bytes);
  return out;
}

v1::SessionState to_proto(SessionState state) {
  switch (state) {
    case SessionState::kQueued:
      return v1::SESSION_STATE_QUEUED;
    case SessionState::kPreprocessing:
      return v1::SESSION_STATE_PREPROCESSING;
    case SessionState::kReady:
      return v1::SESSION_STATE_READY;
  }
  return v1::SESSION_STATE_UNSPECIFIED;
}

void read_budget(FieldValidator& check, const v1::SampleRequest& request, PointSetRequest& out) {
  switch (request.budget_case()) {
    case v1::SampleRequest::kPixelError:
      out.pixel_error = request.pixel_error();
      if (!(out.pixel_error > 0 && out.pixel_error <= kMaxPixelError)) {
        check.fail("sample.pixel_error",
                   absl::StrCat("is ", out.pixel_error, "; it must be above 0 and at most ", kMaxPixelError));
      }
      if (request.cameras().empty()) check.fail("sample.pixel_error", "needs a camera in sample.cameras");
      break;
    case v1::SampleRequest::kMaxBytes:
      out.max_bytes = request.max_bytes();
      if (out.max_bytes < kMinBudgetBytes) {
        check.fail("sample.max_bytes", absl::StrCat("is ", out.max_bytes, "; it must be at least ", kMinBudgetBytes));
      }
      break;
    case v1::SampleRequest::kAutomatic: {
      AutomaticBudget& budget = out.automatic.emplace();
      const v1::AutomaticBudget& in = request.automatic();
      if (in.frame_seconds() != 0) {
        budget.frame_seconds = check.in_range("sample.automatic.frame_seconds", in.frame_seconds(), 0.001, 10.0);
      }
      if (in.max_points() != 0) {
        budget.max_points = check.in_range("sample.automatic.max_points", in.max_points(), std::uint64_t{1}, kMaxPoints);
      }
      break;
    }
    case v1::SampleRequest::kPoints:
    case v1::SampleRequest::BUDGET_NOT_SET:
      out.options.points = request.points();
      if (request.points() == 0) check.fail("sample.points", "is 0; ask for at least one");
  }
}

}  // namespace

absl::StatusOr<PointSetRequest> to_point_set_request(const v1::SampleRequest& request) {
  FieldValidator check;
  PointSetRequest out;
  read_budget(check, request, out);
  check_viewport(check, "sample.viewport", request.has_viewport() ? &request.viewport() : nullptr);
  out.options.density =
      to_density(check, "sample.density", request.density(),
                 to_cameras(check, "sample.cameras", request.cameras(), request.viewport()), "needs a camera in sample.cameras");
  out.sampler = to_core(check, request.sampler());
  for (const int attribute : request.attributes()) {
    out.attributes.curvatures |= attribute == v1::POINT_ATTRIBUTE_CURVATURES;
    out.attributes.rank |= attribute == v1::POINT_ATTRIBUTE_RANK;
    out.attributes.surface |= attribute == v1::POINT_ATTRIBUTE_SURFACE;
    out.attributes.directions |= attribute == v1::POINT_ATTRIBUTE_DIRECTIONS;
    out.attributes.scalars |= attribute == v1::POINT_ATTRIBUTE_SCALARS;
    if (attribute == v1::POINT_ATTRIBUTE_UNSPECIFIED || !v1::PointAttribute_IsValid(attribute)) {
      check.fail("sample.attributes", absl::StrCat("holds the unknown value ", attribute));
    }
  }
  if (out.attributes.rank && out.sampler != Sampler::kProgressive) {
    check.fail("sample.attributes", "asks for ranks; only the progressive sampler has them");
  }
  out.options.sequence = to_core(check, request.sequence());
  out.options.seed = request.seed();
  out.relaxation_rounds = static_cast<int>(check.in_range("sample.relaxation_rounds", request.relaxation_rounds(),
                                                          std::uint32_t{0}, std::uint32_t{kMaxRelaxationRounds}));
  if (out.relaxation_rounds > 0 && out.sampler == Sampler::kProgressive) {
    check.fail("sample.relaxation_rounds", "is for the equalised sampler: ranked points stay where they are");
  }
  out.draco = to_core(check, request.encoding());
  if (!check.ok()) return check.status();
  out.fingerprint = hash_of(request.SerializeAsString());
  return out;
}

absl::StatusOr<PointSetRequest> to_streamed_request(const v1::SampleRequest& request) {
  if (request.relaxation_rounds() > 0) {
    return absl::InvalidArgumentError("sample.relaxation_rounds is not for streams: points would jump from view to view");
  }
  return to_point_set_request(request);
}

absl::StatusOr<PreprocessOptions> to_preprocess_options(const v1::SessionOptions& options) {
  FieldValidator check;
  PreprocessOptions out;
  if (options.max_points() != 0) {
    out.points = check.in_range<std::uint64_t>("options.max_points", options.max_points(), 1, kMaxPoints);
  }
  if (options.omega() != 0) out.omega = check.in_range("options.omega", options.omega(), 1.0, kMaxOmega);
  const auto parameteriser = to_parameteriser("options.parameteriser", options.parameteriser());
  if (!parameteriser.ok()) return parameteriser.status();
  out.parameteriser = *parameteriser;
  out.mapper = to_core(check, options.mapper());
  out.area_element = to_core(check, options.area_element());
  out.density = to_density(check, "options.density", options.density(), {}, "depends on a camera; a base density cannot").terms;
  out.seed = options.seed();
  out.chart_faces = to_chart_faces(check, "options.chart_faces", options.chart_faces());
  if (options.has_crease_degrees()) {
    out.crease_degrees = check.in_range("options.crease_degrees", options.crease_degrees(), 0.0, 180.0);
  }
  if (const double vertices = static_cast<double>(out.points) * out.omega; vertices > kMaxCurveVertices) {
    check.fail("options.max_points",
               absl::StrFormat("times omega makes %.0f curve vertices; at most %.0f are made", vertices, kMaxCurveVertices));
  }
  if (!check.ok()) return check.status();
  return out;
}

std::uint64_t to_chart_faces(FieldValidator& check, const std::string& field, std::uint64_t faces) {
  return faces == 0 ? 0 : check.in_range(field, faces, kMinChartFaces, kMaxChartFaces);
}

absl::StatusOr<Parameteriser> to_parameteriser(const std::string& field, v1::Parameteriser parameteriser) {
  switch (parameteriser) {
    case v1::PARAMETERISER_UNSPECIFIED:
    case v1::PARAMETERISER_OWN:
      return Parameteriser::kLeastStretch;
    case v1::PARAMETERISER_CGAL:
      return Parameteriser::kCgal;
    default:
      return absl::InvalidArgumentError(absl::StrCat(field, " has the unknown value ", static_cast<int>(parameteriser)));
  }
}

v1::Vec3 to_proto(const Vec3d& v) {
  v1::Vec3 out;
  out.set_x(v.x());
  out.set_y(v.y());
  out.set_z(v.z());
  return out;
}

v1::Distortion to_proto(const Distortion& distortion) {
  v1::Distortion out;
  out.set_p50(distortion.p50);
  out.set_p99(distortion.p99);
  out.set_p999(distortion.p999);
  out.set_max(distortion.max);
  out.set_density_p999(distortion.density_p999);
  out.set_extra_levels_mean(distortion.extra_levels_mean);
  out.set_extra_levels_max(distortion.extra_levels_max);
  return out;
}

v1::MeshInfo to_proto(const MeshInfo& info, const std::string& name) {
  v1::MeshInfo out;
  out.set_name(name);
  out.set_format(info.format);
  out.set_file_vertices(info.file_vertices);
  out.set_file_polygons(info.file_polygons);
  out.set_vertices(info.vertices);
  out.set_faces(info.faces);
  out.set_components(info.components);
  out.set_genus(info.genus);
  out.set_boundary_loops(info.boundary_loops);
  out.set_area(info.area);
  *out.mutable_box_min() = to_proto(info.box.min);
  *out.mutable_box_max() = to_proto(info.box.max);
  v1::Repairs& repairs = *out.mutable_repairs();
  repairs.set_triangulated_polygons(info.repairs.triangulated_polygons);
  repairs.set_degenerate_faces(info.repairs.degenerate_faces);
  repairs.set_duplicate_faces(info.repairs.duplicate_faces);
  repairs.set_welded_vertices(info.repairs.welded_vertices);
  repairs.set_unused_vertices(info.repairs.unused_vertices);
  repairs.set_flipped_faces(info.repairs.flipped_faces);
  repairs.set_nonmanifold_edges(info.repairs.nonmanifold_edges);
  repairs.set_split_vertices(info.repairs.split_vertices);
  for (const std::string& attribute : info.attributes) out.add_attributes(attribute);
  if (info.crease_degrees) out.set_crease_degrees(*info.crease_degrees);
  for (const std::string& warning : info.warnings) out.add_warnings(warning);
  return out;
}

v1::Session to_proto(const Session& session) {
  v1::Session out;
  out.set_session_id(session.id);
  out.set_mesh_id(session.mesh_id);
  out.set_state(v1::SESSION_STATE_READY);
  *out.mutable_options() = to_proto(session.options);
  const std::shared_ptr<const SurfaceCurve> curve = session.curve();
  PreprocessReport report = session.preprocessed.report;
  report.curve_vertices = curve->size();
  report.curve_bytes = curve->byte_size();
  if (curve->revision > 1 && curve->size() > 0) report.max_level = *std::max_element(curve->level.begin(), curve->level.end());
  *out.mutable_report() = to_proto(report, session.mesh_name, session.peak_bytes);
  out.set_curve_revision(curve->revision);
  out.set_refining(session.revisions->refining());
  out.set_memory_bytes(session.memory_bytes());
  return out;
}

v1::Session to_proto(const SessionInfo& info) {
  v1::Session out;
  if (info.session != nullptr) {
    out = to_proto(*info.session);
    out.set_pinned(info.pinned);
    out.set_time_to_live(info.time_to_live);
    return out;
  }
  out.set_session_id(info.id);
  out.set_mesh_id(info.mesh_id);
  out.set_state(to_proto(info.state));
  *out.mutable_options() = to_proto(info.options);
  return out;
}

v1::FrameError to_proto(const absl::Status& status) {
  v1::FrameError error;
  error.set_code(static_cast<std::uint32_t>(status.code()));
  error.set_message(std::string(status.message()));
  if (absl::IsResourceExhausted(status)) error.set_retry_after(kRetryAfter);
  return error;
}

}  // namespace curvecast::server
