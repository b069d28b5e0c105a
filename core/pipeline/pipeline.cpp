#include "core/pipeline/pipeline.h"

#include <absl/strings/str_format.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

#include "core/base/origin.h"
#include "core/base/stopwatch.h"
#include "core/base/with_threads.h"
#include "core/curve/adaptive_quadtree.h"
#include "core/curve/area_element.h"
#include "core/curve/crease_band.h"
#include "core/curve/surface_colour.h"
#include "core/curve/surface_map.h"
#include "core/density/face_density.h"
#include "core/mesh/cluster_vertices.h"
#include "core/mesh/curvature.h"
#include "core/mesh/topology.h"
#include "core/mesh_io/mesh_io.h"
#include "core/pipeline/memory_estimate.h"
#include "core/reference/id_buffer.h"
#include "core/reference/voronoi_area.h"

namespace curvecast {
namespace {

constexpr double kMaxOmega = 1000;
// Leaves to allow for each vertex wanted: powers of four and mixed neighbourhoods cost a factor of 3 or so.
constexpr double kLeavesPerVertex = 64;
constexpr double kMostLeaves = 1e9;

absl::Status check(const PreprocessOptions& options) {
  if (options.points < 1 || options.points > kMaxPoints) {
    return absl::InvalidArgumentError(absl::StrFormat("max_points = %d; it must lie in 1 .. %d", options.points, kMaxPoints));
  }
  if (!(options.omega >= 1 && options.omega <= kMaxOmega)) {
    return absl::InvalidArgumentError(absl::StrFormat("omega = %g; it must lie in 1 .. %g", options.omega, kMaxOmega));
  }
  if (absl::Status status = check_crease_degrees(options.crease_degrees); !status.ok()) return status;
  return options.mapper == Mapper::kIdBuffer ? IdBuffer::check() : absl::OkStatus();
}

/// A message that says which file it is about.
absl::Status about(std::string_view name, const absl::Status& status) {
  return absl::Status(status.code(), absl::StrFormat("%s: %s", name, status.message()));
}

/// What there is, in words.
std::vector<std::string> names_of(const MeshAttributes& attributes) {
  std::vector<std::string> names;
  if (!attributes.colours.empty()) names.emplace_back("colours");
  if (!attributes.face_colours.empty()) names.emplace_back("face colours");
  if (!attributes.normals.empty()) names.emplace_back("normals");
  if (!attributes.uv.empty()) names.emplace_back("uv");
  if (!attributes.materials.empty()) names.emplace_back("materials");
  const auto has_texture = [](const Material& material) { return material.texture != nullptr; };
  if (std::any_of(attributes.materials.begin(), attributes.materials.end(), has_texture)) names.emplace_back("textures");
  for (const ScalarAttribute& scalar : attributes.scalars) names.push_back("scalar " + scalar.name);
  return names;
}

/// What a soup becomes by repair. Its `info` lacks what repair knows nothing of.
absl::StatusOr<LoadedMesh> repair_and_inspect(PolygonSoup soup, const ExecutionContext& context) {
  const std::size_t file_vertices = soup.positions.size(), file_polygons = soup.polygon_count();
  const std::optional<double> crease_degrees = soup.crease_degrees;
  std::vector<std::string> warnings = std::move(soup.warnings);
  absl::StatusOr<RepairedMesh> repaired = repair(std::move(soup), context);
  if (!repaired.ok()) return repaired.status();
  LoadedMesh loaded;
  loaded.mesh = std::move(repaired->mesh);
  loaded.attributes = std::move(repaired->attributes);
  loaded.sources = std::move(repaired->sources);
  if (absl::Status status = context.check(); !status.ok()) return status;
  Topology topology;
  double area = 0;
  tbb::parallel_invoke([&] { topology = analyse_topology(loaded.mesh, context); },
                       [&] { area = surface_area(loaded.mesh, context); });
  if (absl::Status status = context.check(); !status.ok()) return status;
  loaded.info = {.format = {},
                 .file_vertices = file_vertices,
                 .file_polygons = file_polygons,
                 .vertices = loaded.mesh.vertex_count(),
                 .faces = loaded.mesh.face_count(),
                 .components = topology.components,
                 .genus = topology.genus,
                 .boundary_loops = topology.boundary_loops,
                 .area = area,
                 .box = bounding_box(loaded.mesh),
                 .repairs = repaired->report,
                 .attributes = names_of(loaded.attributes),
                 .crease_degrees = crease_degrees,
                 .warnings = std::move(warnings)};
  return loaded;
}

/// `on_read` sees what the file holds, and claims the memory for what follows.
absl::StatusOr<LoadedMesh> load(const MeshFile& file, const ExecutionContext& context, StageSeconds& seconds, MemoryClaim& claim,
                                const std::function<absl::Status(const PolygonSoup& soup)>& on_read) {
  Stopwatch watch;
  context.progress("read", 0);
  if (absl::Status status = claim_reading(file, claim); !status.ok()) return status;
  absl::StatusOr<PolygonSoup> soup = read_mesh(file, context);
  if (!soup.ok()) return soup.status();
  const absl::StatusOr<MeshFormat> format = detect_mesh_format(file.name, file.bytes);
  if (!format.ok()) return format.status();
  context.progress("read", 1);
  seconds.read = watch.lap();
  if (absl::Status status = on_read(*soup); !status.ok()) return status;
  absl::StatusOr<LoadedMesh> loaded = repair_and_inspect(*std::move(soup), context);
  if (!loaded.ok()) return absl::IsCancelled(loaded.status()) ? loaded.status() : about(file.name, loaded.status());
  constexpr const char* kFormatNames[] = {"ply", "obj", "off", "stl", "gltf", "3mf"};
  loaded->info.format = kFormatNames[static_cast<int>(*format)];
  seconds.repair = watch.lap();
  return loaded;
}

/// omega N: what the curve is to have of vertices.
double wanted_vertices(const PreprocessOptions& options) { return options.omega * static_cast<double>(options.points); }

/// The vertices of the curve that each face wants, for each unit of its area.
class Demand {
 public:
  static absl::StatusOr<Demand> of(const FlattenedMesh& flattened, const PreprocessOptions& options,
                                   const ExecutionContext& context) {
    const LoadedMesh& loaded = flattened.loaded;
    Demand demand;
    if (options.density.empty()) {
      demand.even_ = wanted_vertices(options) / loaded.info.area;
      return demand;
    }
    absl::StatusOr<std::vector<double>> of_faces = face_demand(loaded.mesh, flattened.geometry, loaded.attributes.scalars,
                                                               options.density, wanted_vertices(options), kFewPlaces, context);
    if (!of_faces.ok()) return of_faces.status();
    demand.of_faces_ = *std::move(of_faces);
    return demand;
  }

  double operator[](std::uint32_t face) const { return of_faces_.empty() ? even_ : of_faces_[face]; }
  double highest() const { return of_faces_.empty() ? even_ : *std::max_element(of_faces_.begin(), of_faces_.end()); }

 private:
  double even_ = 0;
  std::vector<double> of_faces_;  // empty: all faces want the same
};

/// Divides a chart's square until its triangles have the leaves that their faces want, and a few more at most.
absl::StatusOr<QuadtreeLeaves> divide_chart(const Chart& chart, const Column<ParameterTriangle>& triangles,
                                            const Demand& demand_of_face, const ExecutionContext& context,
                                            const LeavesClaim& claim) {
  std::vector<double> demand(chart.disc.face_count());
  double share = 0;
  for (std::size_t t = 0; t < demand.size(); ++t) {
    demand[t] = demand_of_face[chart.disc.face_of[t]] * triangles[t].area_ratio;
    share += triangles[t].uv_area() * demand[t];
  }
  const auto most = static_cast<std::size_t>(std::min(kLeavesPerVertex * share + 1e6, kMostLeaves));
  return build_quadtree(triangles, demand, most, context, claim);
}

absl::Status build_curve(const FlattenedMesh& flattened, const PreprocessOptions& options, const Demand& demand_of_face,
                         const ExecutionContext& context, SurfaceCurve& curve, PreprocessReport& report) {
  Stopwatch watch;
  const LoadedMesh& loaded = flattened.loaded;
  const std::vector<Chart>& charts = flattened.charts;
  std::vector<QuadtreeLeaves> leaves;
  curve.disc_begin.assign(1, 0);
  std::size_t count = 0;
  MemoryClaim more(context);
  for (const Chart& chart : charts) {
    context.progress("curve", static_cast<double>(leaves.size()) / static_cast<double>(charts.size()));
    // Triangles are made again for the map: those of all charts at once would take much memory.
    const auto claim = [&](std::size_t of_chart) { return claim_more_leaves(count + of_chart, options, more); };
    absl::StatusOr<QuadtreeLeaves> built = divide_chart(chart, parameter_triangles(chart), demand_of_face, context, claim);
    if (!built.ok()) return built.status();
    leaves.push_back(*std::move(built));
    count += leaves.back().size();  // of which there may have been more at first
    if (absl::Status status = claim_more_leaves(count, options, more); !status.ok()) return status;
    if (count >= kNone) return absl::ResourceExhaustedError("the curve would need more than 2^32 vertices: ask for fewer points");
    curve.disc_begin.push_back(static_cast<std::uint32_t>(count));
  }
  report.seconds.curve = watch.lap();

  context.progress("map", 0);
  std::optional<SurfaceColour> colour;
  if (has_colour(loaded.attributes)) colour.emplace(loaded.mesh, loaded.attributes);
  for (const ScalarAttribute& scalar : loaded.attributes.scalars) curve.scalars.push_back({scalar.name, {}});
  curve.resize(count, colour.has_value());
  const SurfaceData data{loaded.mesh, flattened.geometry, flattened.creases, loaded.attributes, colour ? &*colour : nullptr};
  std::unique_ptr<IdBuffer> id_buffer;
  if (options.mapper == Mapper::kIdBuffer) {
    absl::StatusOr<std::unique_ptr<IdBuffer>> made = IdBuffer::create();
    if (!made.ok()) return made.status();
    id_buffer = *std::move(made);
  }
  double sum = 0;
  for (std::size_t d = 0; d < charts.size(); ++d) {
    context.progress("map", static_cast<double>(d) / static_cast<double>(charts.size()));
    if (absl::Status status = context.check(); !status.ok()) return status;
    const Column<ParameterTriangle> triangles = parameter_triangles(charts[d]);
    Column<std::uint32_t> under;
    under.resize(leaves[d].size());
    if (id_buffer != nullptr) {
      absl::Status status = id_buffer->locate(charts[d], triangles, leaves[d], under, context);
      if (!status.ok()) return status;
    } else {
      locate_centres(triangles, leaves[d], under, context);
    }
    const Column<std::uint8_t> kinds = triangle_kinds(data, charts[d]);
    map_to_surface(SurfaceMapper(data, charts[d], kinds), leaves[d], under, curve.disc_begin[d], curve, context);
    if (absl::Status status = context.check(); !status.ok()) return status;
    report.seconds.map += watch.lap();
    const auto of_disc = [&](Column<float>& column) { return std::span(column).subspan(curve.disc_begin[d], leaves[d].size()); };
    if (options.area_element == AreaElement::kVoronoi) {
      const LeafVertices vertices{of_disc(curve.x), of_disc(curve.y), of_disc(curve.z), under, curve.origin};
      sum += voronoi_areas(charts[d], triangles, leaves[d], vertices, of_disc(curve.area));
    } else {
      sum += area_elements(triangles, leaves[d], of_disc(curve.area));
    }
    leaves[d] = {};
    report.seconds.area += watch.lap();
  }
  report.max_level = *std::max_element(curve.level.begin(), curve.level.end());
  context.progress("area", 0);
  report.area_error = std::abs(sum / curve.total_area - 1);
  normalise_areas(curve.total_area, curve.area);
  if (absl::Status status = context.check(); !status.ok()) return status;
  curve.reference_curvature =
      reference_curvatures(loaded.mesh, flattened.geometry, loaded.info.area, loaded.info.box.diagonal(), context);
  if (absl::Status status = context.check(); !status.ok()) return status;
  fill_crease_band(data, curve, context);
  if (absl::Status status = context.check(); !status.ok()) return status;
  curve.finish();
  context.progress("area", 1);
  report.seconds.area += watch.lap();
  return absl::OkStatus();
}

/// Keys hold kMaxLevel levels. Has discs divided where the map squeezes together what wants vertices until it would need more.
void limit_levels(const Demand& demand, double area, FlattenOptions& options) {
  const double highest = area * demand.highest();  // per uv area, where the map is even
  const double most = std::ldexp(1.0, 2 * kMaxLevel);
  options.max_area_ratio = std::clamp(most / highest, 2.0, options.max_area_ratio);
}

/// Leaves in `demand` what was found, if it was asked: for a base density.
absl::StatusOr<FlattenedMesh> flatten_here(LoadedMesh loaded, const StageSeconds& seconds, const PreprocessOptions& options,
                                           const ExecutionContext& context, std::optional<Demand>& demand) {
  Stopwatch watch;
  FlattenedMesh flattened{std::move(loaded)};
  const TriangleMesh& mesh = flattened.loaded.mesh;
  // Beside cutting, which keeps only one thread busy for most of its time.
  tbb::task_group beside;
  beside.run([&] {
    const VertexFans fans(mesh, context);
    flattened.geometry = differential_geometry(mesh, fans, context);
    flattened.creases = crease_normals(mesh, crease_degrees(options, flattened.loaded.info.crease_degrees), fans, context);
    for (std::uint32_t h = 0; h < mesh.twins.size(); ++h) {
      if (mesh.twins[h] == kNone) flattened.borders.push_back(h);
    }
  });
  FlattenOptions flatten_options{.parameteriser = options.parameteriser};
  if (options.chart_faces > 0) flatten_options.most_whole_faces = flatten_options.chart_faces = options.chart_faces;
  if (!options.density.empty()) {
    beside.wait();
    if (absl::Status status = context.check(); !status.ok()) return status;
    absl::StatusOr<Demand> found = Demand::of(flattened, options, context);
    if (!found.ok()) return found.status();
    demand = *std::move(found);
    limit_levels(*demand, flattened.loaded.info.area, flatten_options);
  }
  FlattenTimes times;
  absl::StatusOr<std::vector<Chart>> charts = flatten(mesh, flatten_options, context, times);
  if (!charts.ok()) beside.cancel();
  beside.wait();
  if (!charts.ok()) return charts.status();
  if (absl::Status status = context.check(); !status.ok()) return status;
  flattened.charts = *std::move(charts);
  PreprocessReport& report = flattened.report;
  report.mesh = flattened.loaded.info;
  report.discs = static_cast<std::uint32_t>(flattened.charts.size());
  std::vector<std::uint64_t> flipped(flattened.charts.size());
  tbb::parallel_for(std::size_t{0}, flipped.size(),
                    [&](std::size_t d) { flipped[d] = count_flipped(flattened.charts[d].disc, flattened.charts[d].uv); });
  report.flipped_triangles = std::accumulate(flipped.begin(), flipped.end(), std::uint64_t{0});
  for (const Chart& chart : flattened.charts) {
    report.fallback_discs +=
        chart.parameterisation != Parameterisation::kLeastStretch && chart.parameterisation != Parameterisation::kCgal;
  }
  report.distortion = measure_distortion(flattened.charts, context);
  if (absl::Status status = context.check(); !status.ok()) return status;
  report.seconds = seconds;
  report.seconds.cut = times.cut;
  report.seconds.parameterise = times.parameterise;
  report.seconds.total = seconds.read + seconds.repair + watch.lap();
  return flattened;
}

/// `claim`: for all that follows, the curve too. `on_read`, if not empty, sees what the file holds.
absl::StatusOr<FlattenedMesh> load_and_flatten(const MeshFile& file, const PreprocessOptions& options,
                                               const ExecutionContext& context, std::optional<Demand>& demand, MemoryClaim& claim,
                                               const std::function<void(const PolygonSoup& soup)>& on_read = {}) {
  StageSeconds seconds;
  absl::StatusOr<LoadedMesh> loaded = load(file, context, seconds, claim, [&](const PolygonSoup& soup) {
    absl::Status status = claim_preprocessing(file, soup, options, context, claim);
    if (status.ok() && on_read) on_read(soup);
    return status;
  });
  if (!loaded.ok()) return loaded.status();
  return flatten_here(*std::move(loaded), seconds, options, context, demand);
}

/// `demand`: nullopt if it has not been asked yet.
absl::StatusOr<Preprocessed> lay_curve_here(std::shared_ptr<const FlattenedMesh> flattened, const PreprocessOptions& options,
                                            const ExecutionContext& context, std::optional<Demand> demand = std::nullopt) {
  Stopwatch watch;
  if (!demand) {
    absl::StatusOr<Demand> found = Demand::of(*flattened, options, context);
    if (!found.ok()) return found.status();
    demand = *std::move(found);
  }
  PreprocessReport report = flattened->report;
  auto curve = std::make_shared<SurfaceCurve>();
  curve->total_area = report.mesh.area;
  curve->box = report.mesh.box;
  curve->origin = choose_origin(report.mesh.box);
  curve->max_points = options.points;
  curve->face_sources = flattened->loaded.sources;
  const absl::Status built = build_curve(*flattened, options, *demand, context, *curve, report);
  if (!built.ok()) return built;
  report.curve_vertices = curve->size();
  report.curve_bytes = curve->byte_size();
  report.seconds.total += watch.lap();
  return Preprocessed{std::move(curve), report, std::move(flattened)};
}

/// All stages for a coarse stand-in.
absl::StatusOr<Preprocessed> make_preview(const PolygonSoup& soup, PreprocessOptions options, const ExecutionContext& context) {
  constexpr std::size_t kVertices = 30'000;
  constexpr std::uint64_t kPoints = 16'384;  // more are made if views want them
  options.points = std::min(options.points, kPoints);
  PolygonSoup coarse = cluster_vertices(soup, kVertices);
  coarse.crease_degrees = soup.crease_degrees;
  absl::StatusOr<LoadedMesh> loaded = repair_and_inspect(std::move(coarse), context);
  if (!loaded.ok()) return loaded.status();
  std::optional<Demand> demand;
  absl::StatusOr<FlattenedMesh> flattened = flatten_here(*std::move(loaded), {}, options, context, demand);
  if (!flattened.ok()) return flattened.status();
  return lay_curve_here(std::make_shared<const FlattenedMesh>(*std::move(flattened)), options, context, std::move(demand));
}

}  // namespace

absl::Status check_crease_degrees(std::optional<double> degrees) {
  if (!degrees || (*degrees >= 0 && *degrees <= 180)) return absl::OkStatus();  // written so that a NaN fails
  return absl::InvalidArgumentError(absl::StrFormat("crease_degrees = %g; it must lie in 0 .. 180", *degrees));
}

absl::StatusOr<LoadedMesh> load_mesh(PolygonSoup soup, std::string_view name, const ExecutionContext& context) {
  return with_threads(context, [&]() -> absl::StatusOr<LoadedMesh> {
    absl::StatusOr<LoadedMesh> loaded = repair_and_inspect(std::move(soup), context);
    if (!loaded.ok() && !absl::IsCancelled(loaded.status())) return about(name, loaded.status());
    return loaded;
  });
}

absl::StatusOr<LoadedMesh> load_mesh(const MeshFile& file, const ExecutionContext& context) {
  StageSeconds seconds;
  MemoryClaim claim(context);
  return load(file, context, seconds, claim, [&](const PolygonSoup& soup) { return claim_repair(file, soup, claim); });
}

absl::StatusOr<MeshInfo> inspect_mesh(const MeshFile& file, const ExecutionContext& context) {
  absl::StatusOr<LoadedMesh> loaded = load_mesh(file, context);
  if (!loaded.ok()) return loaded.status();
  return loaded->info;
}

absl::StatusOr<FlattenedMesh> flatten_mesh(const MeshFile& file, const PreprocessOptions& options,
                                           const ExecutionContext& context) {
  if (absl::Status status = check(options); !status.ok()) return status;
  std::optional<Demand> demand;
  MemoryClaim claim(context);
  return with_threads(context, [&] { return load_and_flatten(file, options, context, demand, claim); });
}

absl::StatusOr<FlattenedMesh> flatten_mesh(LoadedMesh loaded, const PreprocessOptions& options, const ExecutionContext& context) {
  if (absl::Status status = check(options); !status.ok()) return status;
  std::optional<Demand> demand;
  return with_threads(context, [&] { return flatten_here(std::move(loaded), {}, options, context, demand); });
}

absl::StatusOr<Preprocessed> lay_curve(std::shared_ptr<const FlattenedMesh> flattened, const PreprocessOptions& options,
                                       const ExecutionContext& context) {
  if (absl::Status status = check(options); !status.ok()) return status;
  return with_threads(context, [&] { return lay_curve_here(std::move(flattened), options, context); });
}

absl::StatusOr<Preprocessed> preprocess(const MeshFile& file, const PreprocessOptions& options, const ExecutionContext& context,
                                        const OnPreview& on_preview) {
  if (absl::Status status = check(options); !status.ok()) return status;
  return with_threads(context, [&]() -> absl::StatusOr<Preprocessed> {
    std::optional<Demand> demand;
    MemoryClaim claim(context);
    const auto preview = [&](const PolygonSoup& soup) {
      if (!on_preview || soup.polygon_count() <= kMostWithoutPreview) return;
      const ExecutionContext quiet{.on_progress = {}, .cancel = context.cancel};
      on_preview([&] { return make_preview(soup, options, quiet); });
    };
    absl::StatusOr<FlattenedMesh> flattened = load_and_flatten(file, options, context, demand, claim, preview);
    if (!flattened.ok()) return flattened.status();
    return lay_curve_here(std::make_shared<const FlattenedMesh>(*std::move(flattened)), options, context, std::move(demand));
  });
}

}  // namespace curvecast
