#include "core/mesh_io/gltf/gltf_unpacking.h"

#include <absl/status/statusor.h>

#include <algorithm>
#include <cstddef>
#include <set>
#include <vector>

#include "core/mesh_io/gltf/draco_primitive.h"
#include "core/mesh_io/gltf/gltf_accessor.h"
#include "core/mesh_io/gltf/gltf_document.h"
#include "core/mesh_io/gltf/meshopt_view.h"

namespace curvecast {
namespace {

constexpr std::uint64_t kMost = 1ULL << 50;  // that sums stay far from overflowing

bool mentions_compression(std::string_view bytes) {
  constexpr std::string_view kNames[] = {"KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_mesh_quantization"};
  return std::any_of(std::begin(kNames), std::end(kNames), [&](std::string_view name) { return bytes.find(name) != bytes.npos; });
}

std::uint64_t of_meshopt(const std::vector<GltfView>& views) {
  std::uint64_t sum = 0;
  for (const GltfView& view : views) {
    if (view.meshopt != nullptr) sum += std::min(kMost, most_meshopt_bytes(*view.meshopt));
    sum = std::min(kMost, sum);
  }
  return sum;
}

/// How often each mesh is shown.
std::vector<std::uint64_t> uses_of_meshes(const GltfModel& model) {
  std::vector<std::uint64_t> uses(model.meshes.size(), model.nodes.empty() ? 1 : 0);
  for (const GltfNode& node : model.nodes) {
    if (node.mesh >= 0 && node.mesh < static_cast<std::int64_t>(uses.size())) ++uses[static_cast<std::size_t>(node.mesh)];
  }
  return uses;
}

/// What a primitive without Draco data claims.
DracoClaim plain_claim(const GltfPrimitive& primitive, const GltfModel& model) {
  const auto count_of = [&](std::int64_t index) {
    const bool is_there = index >= 0 && index < static_cast<std::int64_t>(model.accessors.size());
    return is_there ? model.accessors[static_cast<std::size_t>(index)].count : 0;
  };
  const auto position = primitive.attributes.find("POSITION");
  const std::uint64_t vertices = position != primitive.attributes.end() ? count_of(position->second) : 0;
  const std::uint64_t corners = primitive.indices >= 0 ? count_of(primitive.indices) : vertices;
  return {.triangles = primitive.mode == GltfPrimitive::kTriangles ? corners / 3 : corners, .vertices = vertices};
}

/// What the primitive adds to a soup. Each factor is below 2^40.
std::uint64_t soup_bytes(const GltfPrimitive& primitive, const DracoClaim& size, bool has_materials) {
  const auto has = [&](const char* name) { return primitive.attributes.contains(name) ? std::uint64_t{1} : std::uint64_t{0}; };
  const auto next = primitive.attributes.lower_bound("TEXCOORD_");
  const bool has_uv = next != primitive.attributes.end() && next->first.starts_with("TEXCOORD_");
  const std::uint64_t per_vertex = 24 + 12 * has("NORMAL") + 4 * has("COLOR_0");
  const std::uint64_t per_triangle = 12 + 4 + (has_uv ? 24 : 0) + (has_materials ? 4 : 0);
  constexpr std::uint64_t kGrowing = 2;
  return kGrowing * (per_vertex * size.vertices + per_triangle * size.triangles);
}

}  // namespace

std::uint64_t gltf_unpacking_bytes(std::string_view bytes) {
  if (!is_gltf(bytes) || !mentions_compression(bytes)) return 0;
  const absl::StatusOr<GltfDocument> document = parse_gltf(bytes);
  if (!document.ok()) return 0;
  const GltfModel& model = document->model;
  std::uint64_t sum = of_meshopt(model.views);
  const std::vector<std::uint64_t> uses = uses_of_meshes(model);
  std::set<std::int64_t> draco_views;
  for (std::size_t mesh = 0; mesh < model.meshes.size(); ++mesh) {
    for (const GltfPrimitive& primitive : model.meshes[mesh]) {
      DracoClaim claim = plain_claim(primitive, model);
      claim.vertices = std::min<std::uint64_t>(claim.vertices, UINT32_MAX);
      claim.triangles = std::min<std::uint64_t>(claim.triangles, UINT32_MAX);
      if (primitive.draco != nullptr) {
        const std::int64_t view = primitive.draco->view;
        const bool is_there = view >= 0 && view < static_cast<std::int64_t>(model.views.size());
        const std::uint64_t length = is_there ? std::min(kMost, model.views[static_cast<std::size_t>(view)].length) : 0;
        claim.vertices = std::min(claim.vertices, most_draco_elements(length));
        claim.triangles = std::min(claim.triangles, most_draco_elements(length));
        if (const absl::StatusOr<DracoClaim> told = draco_claim(primitive, model.accessors); told.ok()) {
          claim.bytes_per_vertex = std::min<std::uint64_t>(told->bytes_per_vertex, 512);
        }
        if (draco_views.insert(view).second) sum += draco_decoding_bytes(claim);
      }
      const std::uint64_t soup = soup_bytes(primitive, claim, !model.materials.empty());
      // Where there are nodes, as many as show the mesh; the product stays below 2^64.
      sum = std::min(kMost, sum + std::min(kMost, std::min<std::uint64_t>(uses[mesh], 1 << 20) * soup));
    }
  }
  return sum;
}

}  // namespace curvecast
