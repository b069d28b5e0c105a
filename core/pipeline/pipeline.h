// Composes the stages from a mesh file to the curve on its surface, and says what each is to do: how many vertices of the curve
// each face wants, how many leaves a disc may have at most, how far a chart may squeeze the surface, where floats are relative
// to.
#pragma once

#include <absl/status/statusor.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/base/execution_context.h"
#include "core/curve/area_element.h"
#include "core/curve/surface_curve.h"
#include "core/curve/surface_map.h"
#include "core/density/density.h"
#include "core/flatten/distortion.h"
#include "core/flatten/flatten.h"
#include "core/mesh/crease_normals.h"
#include "core/mesh/curvature.h"
#include "core/mesh/repair.h"
#include "core/mesh_io/reading/mesh_file.h"
#include "core/sample/point_set.h"

namespace curvecast {

/// Grows whenever preprocessing or sampling gives other bytes than before for the same files and options: sessions of other
/// versions are others. tests/core/pipeline/golden_test.cpp guards it.
inline constexpr int kAlgorithmVersion = 14;

struct PreprocessOptions {
  std::uint64_t points = 65'536;  // N for which the curve is made fine enough, 1 .. kMaxPoints
  double omega = 10;              // curve vertices per point (paper, section 3.2), 1 .. 1000
  Parameteriser parameteriser = Parameteriser::kLeastStretch;
  Mapper mapper = Mapper::kExact;
  AreaElement area_element = AreaElement::kExact;
  std::vector<DensityTerm> density;  // base density for which the curve is made, without camera terms; none = uniform
  std::uint64_t seed = 0;            // of the ranked points
  std::uint64_t chart_faces = 0;     // about how many a chart may have; 0: as FlattenOptions says
  // Faces whose normals are further apart meet at a crease, 0 .. 180; nothing: as the file means, see crease_degrees().
  std::optional<double> crease_degrees;
};

/// What a file holds and what repair made of it.
struct MeshInfo {
  std::string format;  // "ply", "obj", "off", "stl", "gltf" (GLB too) or "3mf"
  std::uint64_t file_vertices = 0;
  std::uint64_t file_polygons = 0;
  std::uint64_t vertices = 0;  // after repair
  std::uint64_t faces = 0;     // after repair
  std::uint32_t components = 0;
  std::uint32_t genus = 0;  // sum over the components
  std::uint32_t boundary_loops = 0;
  double area = 0;  // squared units of the file
  Box3d box;
  RepairReport repairs;
  std::vector<std::string> attributes;   // what the mesh carries: "colours", "normals", "uv", "scalar quality" ...
  std::optional<double> crease_degrees;  // which the file means, see own_crease_angle(); nothing where it does not tell
  std::vector<std::string> warnings;     // what was left out and why; whole sentences
};

/// InvalidArgument where there is an angle that is not 0 .. 180.
absl::Status check_crease_degrees(std::optional<double> degrees);
/// The angle at which faces meet at a crease: what is asked for, else what the file means, else kCreaseDegrees.
inline double crease_degrees(const PreprocessOptions& options, std::optional<double> own) {
  return options.crease_degrees.value_or(own.value_or(kCreaseDegrees));
}

struct StageSeconds {
  double read = 0, repair = 0, cut = 0, parameterise = 0, curve = 0, map = 0, area = 0, total = 0;
};

struct PreprocessReport {
  MeshInfo mesh;
  std::uint32_t discs = 0;
  std::uint64_t curve_vertices = 0;
  std::uint32_t max_level = 0;          // deepest quadtree level used
  std::uint64_t flipped_triangles = 0;  // in the parameter mesh; always 0, counted all the same
  double area_error = 0;                // |sum of area elements / surface area - 1| before normalisation
  Distortion distortion;
  std::uint32_t fallback_discs = 0;  // discs whose least-stretch map failed, see Parameterisation
  std::uint64_t curve_bytes = 0;
  StageSeconds seconds;
};

struct LoadedMesh {
  TriangleMesh mesh;  // repaired
  MeshAttributes attributes;
  FaceSources sources;  // the file's polygons that the faces are
  MeshInfo info;
};

/// The mesh and its charts: half of the way.
struct FlattenedMesh {
  LoadedMesh loaded;
  std::vector<Chart> charts;
  PreprocessReport report;               // of the stages so far
  std::vector<VertexGeometry> geometry;  // of the loaded mesh
  CreaseNormals creases;                 // of the loaded mesh
  std::vector<std::uint32_t> borders;    // its halfedges without a twin, ascending
};

struct Preprocessed {
  std::shared_ptr<const SurfaceCurve> curve;
  PreprocessReport report;
  std::shared_ptr<const FlattenedMesh> flattened;  // what the curve lies on: refinement starts from it
};

/// Repairs a mesh of no file, and no more. `name`: of errors, such as "the mesh". InvalidArgument as repair() has it; Cancelled.
absl::StatusOr<LoadedMesh> load_mesh(PolygonSoup soup, std::string_view name, const ExecutionContext& context = {});
/// Reads and repairs a mesh, and no more.
absl::StatusOr<LoadedMesh> load_mesh(const MeshFile& file, const ExecutionContext& context = {});
absl::StatusOr<MeshInfo> inspect_mesh(const MeshFile& file, const ExecutionContext& context = {});

/// Reads, repairs, cuts and parameterises a mesh: the first half of preprocess(), with its errors.
absl::StatusOr<FlattenedMesh> flatten_mesh(const MeshFile& file, const PreprocessOptions& options,
                                           const ExecutionContext& context = {});
/// Cuts and parameterises a mesh that has been repaired.
absl::StatusOr<FlattenedMesh> flatten_mesh(LoadedMesh loaded, const PreprocessOptions& options,
                                           const ExecutionContext& context = {});
/// Lays the curve over a flattened mesh: the second half of preprocess(), with the same base density.
absl::StatusOr<Preprocessed> lay_curve(std::shared_ptr<const FlattenedMesh> flattened, const PreprocessOptions& options,
                                       const ExecutionContext& context = {});

/// A mesh of more polygons than this has a preview.
inline constexpr std::size_t kMostWithoutPreview = 1'000'000;
/// Is called once a great mesh has been read, long before the rest is done. Where somebody wants to see something already,
/// `make` makes a coarse stand-in, which takes a while: see cluster_vertices(). It must not be called later.
using MakePreview = std::function<absl::StatusOr<Preprocessed>()>;
using OnPreview = std::function<void(const MakePreview& make)>;

/// Makes the curve of a mesh file. InvalidArgument for a bad file (see read_mesh, repair) or options out of range; Cancelled.
/// `on_preview`, if not empty, is called once at most: not where the mesh is small.
absl::StatusOr<Preprocessed> preprocess(const MeshFile& file, const PreprocessOptions& options,
                                        const ExecutionContext& context = {}, const OnPreview& on_preview = {});

}  // namespace curvecast
