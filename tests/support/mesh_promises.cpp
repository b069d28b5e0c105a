#include "tests/support/mesh_promises.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace curvecast::testing {
namespace {

bool all_finite(const std::vector<Vec3d>& positions) {
  return std::all_of(positions.begin(), positions.end(), [](const Vec3d& p) { return p.allFinite(); });
}

/// What is wrong with the attributes of something with so many vertices, corners and polygons; empty when nothing is.
std::string broken_promise(const MeshAttributes& attributes, std::size_t vertices, std::size_t corners, std::size_t polygons) {
  const auto fits = [](const auto& values, std::size_t count) { return values.empty() || values.size() == count; };
  if (!fits(attributes.colours, vertices)) return "the colours are not as many as the vertices";
  if (!fits(attributes.normals, vertices)) return "the normals are not as many as the vertices";
  if (!fits(attributes.uv, corners)) return "the texture coordinates are not as many as the corners";
  if (!fits(attributes.face_colours, polygons)) return "the faces' colours are not as many as the faces";
  if (!fits(attributes.material_of_face, polygons)) return "the faces' materials are not as many as the faces";
  for (const ScalarAttribute& scalar : attributes.scalars) {
    if (scalar.values.size() != vertices) return "the values of a scalar are not as many as the vertices";
  }
  for (const std::uint32_t material : attributes.material_of_face) {
    if (material != MeshAttributes::kNoMaterial && material >= attributes.materials.size()) return "a material is not there";
  }
  for (const Material& material : attributes.materials) {
    if (material.texture == nullptr) continue;
    const Image& image = *material.texture;
    if (image.width < 1 || image.height < 1) return "a texture has no pixels";
    const std::size_t pixels = static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
    if (image.rgba.size() != 4 * pixels) return "a texture's size is not that of its pixels";
  }
  return "";
}

}  // namespace

std::string broken_promise(const PolygonSoup& soup) {
  if (soup.polygon_count() < 1) return "there is no polygon";
  if (soup.polygon_begin.front() != 0 || soup.polygon_begin.back() != soup.indices.size()) return "polygons miss corners";
  for (std::size_t p = 0; p < soup.polygon_count(); ++p) {
    if (soup.polygon_begin[p + 1] < soup.polygon_begin[p] + 3) return "a polygon has fewer than three corners";
  }
  for (const std::uint32_t index : soup.indices) {
    if (index >= soup.positions.size()) return "a vertex index is out of range";
  }
  if (!all_finite(soup.positions)) return "a coordinate is not finite";
  return broken_promise(soup.attributes, soup.positions.size(), soup.indices.size(), soup.polygon_count());
}

std::string broken_promise(const RepairedMesh& repaired) {
  const TriangleMesh& mesh = repaired.mesh;
  if (mesh.face_count() < 1) return "there is no triangle";
  if (mesh.twins.size() != 3 * mesh.face_count()) return "the twins are not as many as the halfedges";
  for (const Triangle& triangle : mesh.triangles) {
    for (const std::uint32_t v : triangle) {
      if (v >= mesh.vertex_count()) return "a vertex index is out of range";
    }
  }
  for (std::uint32_t h = 0; h < mesh.twins.size(); ++h) {
    const std::uint32_t t = mesh.twins[h];
    if (t == kNone) continue;
    if (t >= mesh.twins.size() || t == h || mesh.twins[t] != h) return "a twin's twin is another";
    if (mesh.from(h) != mesh.to(t) || mesh.to(h) != mesh.from(t)) return "twins join different vertices";
  }
  if (!all_finite(mesh.positions)) return "a coordinate is not finite";
  return broken_promise(repaired.attributes, mesh.vertex_count(), 3 * mesh.face_count(), mesh.face_count());
}

bool is_safe_name(std::string_view name) {
  if (name.empty() || name.size() > 255) return false;
  const auto is_bad = [](char c) { return c == '\\' || c == ':' || c == '\x7f' || (c >= 0 && c < 0x20); };
  if (std::any_of(name.begin(), name.end(), is_bad)) return false;
  const std::string framed = std::string("/").append(name).append("/");
  for (const char* component : {"//", "/./", "/../"}) {
    if (framed.find(component) != std::string::npos) return false;
  }
  return true;
}

}  // namespace curvecast::testing
