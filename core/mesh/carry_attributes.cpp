#include "core/mesh/carry_attributes.h"

namespace curvecast {
namespace {

/// values[indices[i]] for each i; all of them, as they are, without indices.
template <class T>
std::vector<T> gather(const std::vector<T>& values, const std::vector<std::uint32_t>& indices) {
  if (values.empty() || indices.empty()) return values;
  std::vector<T> gathered;
  gathered.reserve(indices.size());
  for (const std::uint32_t index : indices) gathered.push_back(values[index]);
  return gathered;
}

bool colours_disagree(const std::vector<Rgba8>& colours, const std::vector<std::uint32_t>& weld_map) {
  for (std::size_t v = 0; v < weld_map.size(); ++v) {
    if (colours[v] != colours[weld_map[v]]) return true;
  }
  return false;
}

/// The colour of each polygon of the soup; empty where one has corners of different colours.
std::vector<Rgba8> single_colours(const PolygonSoup& soup) {
  std::vector<Rgba8> single;
  const std::vector<Rgba8>& colours = soup.attributes.colours;
  for (std::size_t p = 0; p < soup.polygon_count(); ++p) {
    const std::uint32_t first = soup.polygon_begin[p];
    for (std::uint32_t i = first + 1; i < soup.polygon_begin[p + 1]; ++i) {
      if (colours[soup.indices[i]] != colours[soup.indices[first]]) return {};
    }
    single.push_back(colours[soup.indices[first]]);
  }
  return single;
}

std::vector<Vec3f> mean_normals(std::vector<Vec3f> normals, const std::vector<std::uint32_t>& weld_map) {
  for (std::size_t v = 0; v < weld_map.size() && !normals.empty(); ++v) {
    if (weld_map[v] != v) normals[weld_map[v]] += normals[v];
  }
  for (std::size_t v = 0; v < weld_map.size() && !normals.empty(); ++v) {
    if (weld_map[v] != v) normals[weld_map[v]].normalize();
  }
  return normals;
}

}  // namespace

MeshAttributes carry_attributes(const PolygonSoup& soup, const std::vector<std::uint32_t>& weld_map, const FaceList& faces,
                                const std::vector<std::uint32_t>& source) {
  const MeshAttributes& from = soup.attributes;
  MeshAttributes to;
  std::vector<Rgba8> single;
  const bool hard = !from.colours.empty() && from.face_colours.empty() && colours_disagree(from.colours, weld_map);
  if (hard) single = single_colours(soup);
  to.face_colours = gather(single.empty() ? from.face_colours : single, faces.polygons);
  if (single.empty()) to.colours = gather(from.colours, source);
  to.normals = gather(weld_map.empty() ? from.normals : mean_normals(from.normals, weld_map), source);
  for (const ScalarAttribute& scalar : from.scalars) to.scalars.push_back({scalar.name, gather(scalar.values, source)});
  to.uv = gather(from.uv, faces.corners);
  to.material_of_face = gather(from.material_of_face, faces.polygons);
  to.materials = from.materials;
  return to;
}

}  // namespace curvecast
