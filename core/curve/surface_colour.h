// The colour of a mesh's surface, anywhere on it: textures, vertex and face colours, materials.
//
// Textures are filtered with mip maps and bilinear interpolation in both nearest levels: Williams, "Pyramidal Parametrics",
// SIGGRAPH 1983.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "core/base/colour.h"
#include "core/mesh/mesh_attributes.h"
#include "core/mesh/triangle_mesh.h"

namespace curvecast {

/// What gives a surface its colour, where it lies: see MeshAttributes, which outlives it.
struct ColourView {
  ColourView() = default;
  ColourView(const MeshAttributes& a)  // NOLINT: it is one
      : colours(a.colours),
        uv(a.uv),
        face_colours(a.face_colours),
        material_of_face(a.material_of_face),
        materials(a.materials) {}

  std::span<const Rgba8> colours;
  std::span<const Vec2f> uv;
  std::span<const Rgba8> face_colours;
  std::span<const std::uint32_t> material_of_face;
  std::span<const Material> materials;
};

/// Tells whether the attributes give the surface any colour: vertex or face colours, a texture with coordinates, or a material
/// that is not plain white.
bool has_colour(const ColourView& attributes);

/// Thread-safe once made.
class SurfaceColour {
 public:
  /// `attributes` are those of `mesh` (C = 3 F, P = F); both must outlive it. Textures are reduced here, once, level by level: a
  /// third of their memory more.
  SurfaceColour(const MeshView& mesh, const ColourView& attributes);

  const ColourView& source() const { return attributes_; }

  /// Returns the texture of the face's material, else the vertex colours, else the face's colour, else white; times the
  /// material's colour. `weights`: barycentric, of the face's corners. Textures repeat, and are averaged over about `area` of the
  /// surface (squared units, 0: as sharp as they are), the same in all directions: where one is stretched along one direction
  /// only, that one is blurred more than it needs to be. Mixtures are made in nearly linear light, as the renderer makes them.
  Rgba8 at(std::uint32_t face, const Vec3f& weights, double area) const;

 private:
  using Levels = std::vector<const Image*>;  // each half as wide and high as the one before, down to one texel

  const Levels* texture_of(std::uint32_t face) const;

  const MeshView mesh_;
  const ColourView attributes_;
  std::vector<std::vector<Image>> reduced_;  // of every texture, all levels but the first
  std::vector<Levels> textures_;
  std::vector<std::size_t> texture_of_material_;  // textures_.size(): none
};

}  // namespace curvecast
