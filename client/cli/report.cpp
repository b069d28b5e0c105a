#include "client/cli/report.h"

#include <absl/strings/str_cat.h>
#include <absl/strings/str_format.h>
#include <absl/strings/str_join.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <utility>

#include "client/cli/camera_option.h"
#include "client/cli/session_flags.h"

namespace curvecast::cli {
namespace {

std::array<std::pair<const char*, double>, 8> stages(const v1::StageSeconds& seconds) {
  return {{{"read", seconds.read()},
           {"repair", seconds.repair()},
           {"cut", seconds.cut()},
           {"parameterise", seconds.parameterise()},
           {"curve", seconds.curve()},
           {"map", seconds.map()},
           {"area", seconds.area()},
           {"total", seconds.total()}}};
}

std::array<std::pair<const char*, std::uint64_t>, 8> counts(const v1::Repairs& repairs) {
  return {{{"triangulated_polygons", repairs.triangulated_polygons()},
           {"degenerate_faces", repairs.degenerate_faces()},
           {"duplicate_faces", repairs.duplicate_faces()},
           {"welded_vertices", repairs.welded_vertices()},
           {"unused_vertices", repairs.unused_vertices()},
           {"flipped_faces", repairs.flipped_faces()},
           {"nonmanifold_edges", repairs.nonmanifold_edges()},
           {"split_vertices", repairs.split_vertices()}}};
}

/// With a comma between thousands.
std::string grouped(std::uint64_t number) {
  std::string text = absl::StrCat(number);
  for (std::size_t i = text.size(); i > 3; i -= 3) text.insert(i - 3, 1, ',');
  return text;
}

const char* reason(v1::PointLimit limit) {
  switch (limit) {
    case v1::POINT_LIMIT_BYTES:
      return "more would not fit into the bytes";
    case v1::POINT_LIMIT_DENSITY:
      return "the view has no more places for points";
    case v1::POINT_LIMIT_SERVER:
      return "the server makes no more of them for this view";
    case v1::POINT_LIMIT_COMING:
      return "more are being made";
    default:
      return "the server does not say why";
  }
}

}  // namespace

double crease_degrees(const v1::Session& session) {
  if (session.options().has_crease_degrees()) return session.options().crease_degrees();
  const v1::MeshInfo& mesh = session.report().mesh();
  return mesh.has_crease_degrees() ? mesh.crease_degrees() : 40;
}

Json mesh_json(const v1::MeshInfo& mesh) {
  return {{"vertices", mesh.vertices()},
          {"faces", mesh.faces()},
          {"components", mesh.components()},
          {"genus", mesh.genus()},
          {"boundary_loops", mesh.boundary_loops()},
          {"crease_degrees", mesh.has_crease_degrees() ? Json(mesh.crease_degrees()) : Json()}};
}

Json repairs_json(const v1::Repairs& repairs) {
  Json json = Json::object();
  for (const auto& [name, count] : counts(repairs)) json[name] = count;
  return json;
}

Json strings_json(const google::protobuf::RepeatedPtrField<std::string>& strings) {
  Json json = Json::array();
  for (const std::string& text : strings) json.push_back(text);
  return json;
}

Json preprocess_json(const v1::Session& session) {
  const v1::PreprocessReport& report = session.report();
  Json seconds = Json::object();
  for (const auto& [name, value] : stages(report.seconds())) seconds[name] = value;
  return {{"mesh", mesh_json(report.mesh())},
          {"repairs", repairs_json(report.mesh().repairs())},
          {"attributes", strings_json(report.mesh().attributes())},
          {"warnings", strings_json(report.mesh().warnings())},
          {"discs", report.discs()},
          {"curve_vertices", report.curve_vertices()},
          {"omega", session.options().omega()},
          {"crease_degrees", crease_degrees(session)},
          {"points", session.options().max_points()},
          {"max_level", report.max_level()},
          {"flipped_triangles", report.flipped_triangles()},
          {"area_error", report.area_error()},
          {"distortion",
           {{"p50", report.distortion().p50()},
            {"p99", report.distortion().p99()},
            {"p999", report.distortion().p999()},
            {"density_p999", report.distortion().density_p999()},
            {"max", report.distortion().max()},
            {"extra_levels_mean", report.distortion().extra_levels_mean()},
            {"extra_levels_max", report.distortion().extra_levels_max()}}},
          {"parameteriser", session.options().parameteriser() == v1::PARAMETERISER_CGAL ? "cgal" : "own"},
          {"mapper", mapper_name(session.options().mapper())},
          {"area_element", area_name(session.options().area_element())},
          {"fallback_discs", report.fallback_discs()},
          {"seconds", seconds},
          {"curve_bytes", report.curve_bytes()},
          {"peak_bytes", report.peak_bytes()},
          {"cached", session.cached()},
          {"session_id", session.session_id()},
          {"mesh_id", session.mesh_id()}};
}

std::string mesh_text(const v1::MeshInfo& mesh) {
  const Vec3d size = to_vec(mesh.box_max()) - to_vec(mesh.box_min());
  std::string text = absl::StrFormat("%s (%s): %d vertices, %d polygons in the file\n", mesh.name(), mesh.format(),
                                     mesh.file_vertices(), mesh.file_polygons());
  absl::StrAppendFormat(&text, "after repair   %d vertices, %d triangles\n", mesh.vertices(), mesh.faces());
  absl::StrAppendFormat(&text, "topology       components %d, genus %d, boundary loops %d\n", mesh.components(), mesh.genus(),
                        mesh.boundary_loops());
  absl::StrAppendFormat(&text, "area           %g\nbox            %g x %g x %g\n", mesh.area(), size.x(), size.y(), size.z());
  std::string repairs;
  for (const auto& [name, count] : counts(mesh.repairs())) {
    if (count > 0) absl::StrAppend(&repairs, repairs.empty() ? "" : ", ", name, " ", count);
  }
  absl::StrAppend(&text, "repairs        ", repairs.empty() ? "none" : repairs, "\n");
  absl::StrAppend(&text, "attributes     ", mesh.attributes().empty() ? "none" : absl::StrJoin(mesh.attributes(), ", "), "\n");
  if (mesh.has_crease_degrees()) {
    const double degrees = mesh.crease_degrees();
    const std::string edges = degrees <= 0     ? "every edge"
                              : degrees >= 180 ? "no edge"
                                               : absl::StrFormat("edges of more than %.3g degrees", degrees);
    absl::StrAppend(&text, "creases        ", edges, ", as the file's normals or groups mean\n");
  }
  for (const std::string& warning : mesh.warnings()) absl::StrAppend(&text, "warning        ", warning, "\n");
  return text;
}

std::string preprocess_text(const v1::Session& session) {
  const v1::PreprocessReport& report = session.report();
  std::string text = mesh_text(report.mesh());
  const double total = report.seconds().total();
  for (const auto& [name, value] : stages(report.seconds())) {
    absl::StrAppendFormat(&text, "%-14s %.3f s %5.1f %%\n", name, value, total > 0 ? 100 * value / total : 0);
  }
  absl::StrAppendFormat(&text, "curve          %d vertices, discs %d, deepest level %d, %.1f MB, for %d points\n",
                        report.curve_vertices(), report.discs(), report.max_level(),
                        1e-6 * static_cast<double>(report.curve_bytes()), session.options().max_points());
  const v1::Distortion& distortion = report.distortion();
  absl::StrAppendFormat(&text,
                        "distortion     p50 %.3g, p99 %.3g, p99.9 %.3g, max %.3g; costs %.2f quadtree levels on average, %.1f at "
                        "most; flipped triangles %d\n",
                        distortion.p50(), distortion.p99(), distortion.p999(), distortion.max(), distortion.extra_levels_mean(),
                        distortion.extra_levels_max(), report.flipped_triangles());
  absl::StrAppendFormat(&text, "area error     %.2e\nsession        %s\n", report.area_error(), session.session_id());
  return text;
}

std::string point_limit_text(std::uint64_t points, const v1::FrameStatistics& statistics) {
  if (points >= statistics.wanted_points()) return {};
  return absl::StrCat(grouped(points), " of ", grouped(statistics.wanted_points()), " points: ", reason(statistics.limit()));
}

const char* point_limit_name(v1::PointLimit limit) {
  switch (limit) {
    case v1::POINT_LIMIT_BYTES:
      return "bytes";
    case v1::POINT_LIMIT_DENSITY:
      return "density";
    case v1::POINT_LIMIT_SERVER:
      return "server";
    case v1::POINT_LIMIT_COMING:
      return "coming";
    default:
      return "none";
  }
}

void print_note(const std::string& text) { std::fprintf(stderr, "note: %s\n", text.c_str()); }

Box3d box_of(const v1::MeshInfo& mesh) { return {to_vec(mesh.box_min()), to_vec(mesh.box_max())}; }

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0;
  const auto rank = static_cast<std::size_t>(std::ceil(q * static_cast<double>(values.size())));
  const std::size_t index = std::min(std::max<std::size_t>(rank, 1), values.size()) - 1;
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(index), values.end());
  return values[index];
}

}  // namespace curvecast::cli
