#include "core/pipeline/memory_estimate.h"

#include <absl/strings/str_format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/base/capacity.h"
#include "core/base/machine.h"
#include "core/mesh_io/unpacking_bytes.h"
#include "core/pipeline/pipeline.h"

namespace curvecast {
namespace {

// Bytes of a file become so many of a soup, with what its reader holds besides, at most: see
// tests/core/mesh_io/hostile_files_test. What is compressed in it comes on top.
constexpr double kReadingPerByte = 3;
constexpr double kReading = 1 << 20;
// To repair: times the soup, and for each of its corners and vertices.
constexpr double kRepairSoup = 1.5, kRepairPerCorner = 18, kRepairPerVertex = 30;
// At a smaller angle most edges of a mesh may be creases, whose normals take so much for each corner.
constexpr double kFewCreases = 20;  // degrees
constexpr double kCreasesPerCorner = 24;
// To cut and parameterise; then for each chart at work, up to so much.
constexpr double kFlattenPerCorner = 20, kFlattenPerVertex = 40;
constexpr double kFlattenPerThread = 64 << 20, kFlattenPerChartTriangle = 180;
// Of the curve, with the leaves of which it is made and the first ranked points.
constexpr double kCurve = 32 << 20, kPerLeaf = 100;
// Leaves come in powers of four: between one and four for each vertex wanted where the surface is mapped evenly.
constexpr double kLeavesPerWanted = 2.3, kMostLeavesPerWanted = 4;

struct Counts {
  double vertices, corners, triangles;
};

Counts count(const PolygonSoup& soup) {
  const auto corners = static_cast<double>(soup.indices.size());
  return {static_cast<double>(soup.positions.size()), corners, corners - 2 * static_cast<double>(soup.polygon_count())};
}

double wanted_leaves(const PreprocessOptions& options) {
  return kLeavesPerWanted * options.omega * static_cast<double>(options.points);
}

double scalar_bytes(const PolygonSoup& soup) { return sizeof(float) * static_cast<double>(soup.attributes.scalars.size()); }

double repair_bytes(const Counts& counts, const PolygonSoup& soup) {
  return kRepairSoup * soup_bytes(soup) + kRepairPerCorner * counts.corners + kRepairPerVertex * counts.vertices;
}

double mesh_bytes(const Counts& counts, const PolygonSoup& soup, const PreprocessOptions& options,
                  const ExecutionContext& context) {
  const int threads = context.threads > 0 ? context.threads : machine_cores();
  const double per_corner =
      kFlattenPerCorner + (crease_degrees(options, soup.crease_degrees) < kFewCreases ? kCreasesPerCorner : 0);
  const double flattened = soup_bytes(soup) + per_corner * counts.corners + kFlattenPerVertex * counts.vertices +
                           std::min(threads * kFlattenPerThread, kFlattenPerChartTriangle * counts.triangles);
  return std::max(repair_bytes(counts, soup), flattened);
}

/// How many points would fit.
double fitting_points(double mesh, double per_leaf, double omega, double most) {
  return std::floor((most - kCurve - mesh) / (per_leaf * kMostLeavesPerWanted * omega));
}

/// What would fit instead, as an error tells it.
std::string what_fits(const Counts& counts, double mesh, double per_leaf, double omega, double most) {
  const double points = fitting_points(mesh, per_leaf, omega, most);
  if (points >= 1) return absl::StrFormat(", and %.0f points would fit", points);
  const double triangles = std::floor(counts.triangles * (most - kCurve) / mesh);
  return triangles >= 1 ? absl::StrFormat(", and about %.0f triangles would fit", triangles) : "";
}

absl::Status set(MemoryClaim& claim, double bytes, const std::string& what) {
  constexpr double kMost = 1e18;
  return claim.set(static_cast<std::uint64_t>(std::min(std::ceil(bytes), kMost)), what);
}

}  // namespace

double soup_bytes(const PolygonSoup& soup) {
  const auto& [positions, polygon_begin, indices, shares_vertices, attributes, crease_degrees, warnings] = soup;
  std::size_t bytes = capacity_bytes(positions, polygon_begin, indices);
  const auto& [colours, normals, scalars, uv, face_colours, material_of_face, materials] = attributes;
  bytes += capacity_bytes(colours, normals, uv, face_colours, material_of_face);
  for (const ScalarAttribute& scalar : scalars) bytes += capacity_bytes(scalar.values);
  std::set<const Image*> textures;
  for (const Material& material : materials) textures.insert(material.texture.get());
  for (const Image* texture : textures) bytes += texture != nullptr ? capacity_bytes(texture->rgba) : 0;
  return static_cast<double>(bytes);
}

absl::Status claim_reading(const MeshFile& file, MemoryClaim& claim) {
  const double bytes =
      kReading + kReadingPerByte * static_cast<double>(file.bytes.size()) + static_cast<double>(unpacking_bytes(file));
  return set(claim, bytes,
             absl::StrFormat("%s: to read %s takes %s of memory", file.name,
                             describe_bytes(static_cast<double>(file.bytes.size())), describe_bytes(bytes)));
}

absl::Status claim_repair(const MeshFile& file, const PolygonSoup& soup, MemoryClaim& claim) {
  const Counts counts = count(soup);
  const double bytes = kReading + repair_bytes(counts, soup);
  return set(
      claim, bytes,
      absl::StrFormat("%s: to repair %.0f triangles takes %s of memory", file.name, counts.triangles, describe_bytes(bytes)));
}

absl::Status claim_preprocessing(const MeshFile& file, const PolygonSoup& soup, const PreprocessOptions& options,
                                 const ExecutionContext& context, MemoryClaim& claim) {
  const Counts counts = count(soup);
  const double mesh = mesh_bytes(counts, soup, options, context), per_leaf = kPerLeaf + scalar_bytes(soup);
  const double bytes = mesh + kCurve + per_leaf * wanted_leaves(options);
  std::string what = absl::StrFormat("%s: to prepare %.0f triangles for %d points with omega %g takes %s of memory", file.name,
                                     counts.triangles, options.points, options.omega, describe_bytes(bytes));
  if (context.memory != nullptr && bytes > static_cast<double>(context.memory->most())) {
    what += what_fits(counts, mesh, per_leaf, options.omega, static_cast<double>(context.memory->most()));
  }
  return set(claim, bytes, what);
}

absl::Status claim_curve(const std::string& name, const PreprocessOptions& options, const ExecutionContext& context,
                         MemoryClaim& claim) {
  const double bytes = kCurve + kPerLeaf * wanted_leaves(options);
  std::string what = absl::StrFormat("%s: a curve for %d points with omega %g takes %s of memory", name, options.points,
                                     options.omega, describe_bytes(bytes));
  if (context.memory != nullptr && bytes > static_cast<double>(context.memory->most())) {
    const double points = fitting_points(0, kPerLeaf, options.omega, static_cast<double>(context.memory->most()));
    if (points >= 1) what += absl::StrFormat(", and %.0f points would fit", points);
  }
  return set(claim, bytes, what);
}

absl::Status claim_more_leaves(std::uint64_t leaves, const PreprocessOptions& options, MemoryClaim& claim) {
  const double more = kPerLeaf * std::max(0.0, static_cast<double>(leaves) - wanted_leaves(options));
  return set(claim, more,
             absl::StrFormat(
                 "a curve of %d vertices, for %d points with omega %g, takes %s more of memory than others; ask for fewer points",
                 leaves, options.points, options.omega, describe_bytes(more)));
}

}  // namespace curvecast
