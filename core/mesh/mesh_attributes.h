// What a mesh carries besides its shape: colours, normals, texture coordinates, materials and named values.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/base/colour.h"
#include "core/base/image.h"
#include "core/base/vec.h"

namespace curvecast {

struct Material {
  std::string name;
  Rgba8 colour;                          // diffuse or base colour; multiplies the texture
  std::shared_ptr<const Image> texture;  // null: colour only; shared by the materials that use it
};

/// One number for each vertex, under the name that the file gives it.
struct ScalarAttribute {
  std::string name;
  std::vector<float> values;  // V; NaN and infinities as in the file
};

/// Every array is empty where the file has no such thing. V, C and P: vertices, polygon corners and polygons of the soup or
/// mesh that it belongs to (for a triangle mesh C = 3 F and P = F).
struct MeshAttributes {
  std::vector<Rgba8> colours;                   // V
  std::vector<Vec3f> normals;                   // V, as in the file
  std::vector<ScalarAttribute> scalars;         // names differ
  std::vector<Vec2f> uv;                        // C; v grows upwards from the picture's lower edge
  std::vector<Rgba8> face_colours;              // P
  std::vector<std::uint32_t> material_of_face;  // P: index into `materials`, kNoMaterial without one
  std::vector<Material> materials;

  static constexpr std::uint32_t kNoMaterial = UINT32_MAX;
};

}  // namespace curvecast
