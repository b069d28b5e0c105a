// What the `vn` and `s` of an OBJ file say of its edges.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "core/mesh/polygon_soup.h"

namespace curvecast {

/// Of files of more than a million normals or polygons nothing is kept: nobody sets those by hand.
class ObjShading {
 public:
  /// Whether more is to be kept.
  bool is_open() const { return !too_large_; }
  /// `vn`; what is not finite is none.
  void add_normal(const Vec3d& normal);
  /// `s`: of the polygons to come; 0: "off".
  void use_group(std::int64_t number);
  /// The next corner has this normal, counted as the format does: from 1, or from -1 backwards. `corners`: those before it.
  void note_normal(std::size_t corners, std::int64_t number);
  /// A polygon is complete; `polygons`: those before it.
  void note_polygon(std::size_t polygons);
  /// See own_crease_angle().
  std::optional<double> crease_angle(const PolygonSoup& soup) const;

 private:
  bool has_room(std::size_t count);

  std::vector<Vec3f> normals_;
  std::vector<std::uint32_t> normal_of_corner_;  // of the corners up to the last that has one
  std::vector<std::uint32_t> group_of_polygon_;  // empty before the first `s`
  std::uint32_t group_ = 0;
  bool has_groups_ = false;
  bool too_large_ = false;
};

}  // namespace curvecast
