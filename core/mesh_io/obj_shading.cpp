#include "core/mesh_io/obj_shading.h"

#include "core/mesh/own_crease_angle.h"
#include "core/mesh/triangle_mesh.h"
#include "core/mesh_io/reading/mesh_reading.h"

namespace curvecast {
namespace {

constexpr std::size_t kMost = 1'000'000;

}  // namespace

bool ObjShading::has_room(std::size_t count) {
  if (count >= kMost && !too_large_) {
    too_large_ = true;
    normals_ = {};
    normal_of_corner_ = group_of_polygon_ = {};
  }
  return !too_large_;
}

void ObjShading::add_normal(const Vec3d& normal) {
  if (!has_room(normals_.size())) return;
  normals_.push_back(is_finite(normal) ? Vec3f(normal.normalized().cast<float>()) : Vec3f(Vec3f::Zero()));
}

void ObjShading::use_group(std::int64_t number) {
  group_ = static_cast<std::uint32_t>(number);
  has_groups_ = true;
}

void ObjShading::note_normal(std::size_t corners, std::int64_t number) {
  if (too_large_) return;
  // A number that has no normal yet gets none: files have their normals before their faces.
  const std::int64_t index = number > 0 ? number - 1 : static_cast<std::int64_t>(normals_.size()) + number;
  const bool is_there = index >= 0 && index < static_cast<std::int64_t>(normals_.size());
  normal_of_corner_.resize(corners, kNone);
  normal_of_corner_.push_back(is_there ? static_cast<std::uint32_t>(index) : kNone);
}

void ObjShading::note_polygon(std::size_t polygons) {
  if (!has_room(polygons) || !has_groups_) return;
  group_of_polygon_.resize(polygons, 0);
  group_of_polygon_.push_back(group_);
}

std::optional<double> ObjShading::crease_angle(const PolygonSoup& soup) const {
  return own_crease_angle(soup, {normals_, normal_of_corner_, group_of_polygon_});
}

}  // namespace curvecast
