#include "tests/client/sphere_points.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "client/lib/drc_file.h"

namespace curvecast::client {
namespace {

template <typename T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

void set_common(const Points& points, v1::PointBlock* block) {
  block->set_count(static_cast<std::uint32_t>(points.size()));
  block->mutable_origin()->set_x(points.origin[0]);
  block->mutable_origin()->set_y(points.origin[1]);
  block->mutable_origin()->set_z(points.origin[2]);
}

}  // namespace

Points sphere_points(std::size_t count) {
  Points points;
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 1 - (2.0 * static_cast<double>(i) + 1) / static_cast<double>(count);
    const double angle = static_cast<double>(i) * std::numbers::pi * (3 - std::sqrt(5.0));
    const double r = std::sqrt(1 - z * z);
    const std::array<float, 3> p = {static_cast<float>(r * std::cos(angle)), static_cast<float>(r * std::sin(angle)),
                                    static_cast<float>(z)};
    points.positions.push_back(p);
    points.normals.push_back(p);
    points.radii.push_back(static_cast<float>(0.015 + 0.005 * z));
  }
  return points;
}

void add_colours(Points* points) {
  for (std::size_t i = 0; i < points->size(); ++i) {
    points->colours.push_back(
        {static_cast<std::uint8_t>(i), static_cast<std::uint8_t>(i >> 8), static_cast<std::uint8_t>(255 - i % 256)});
  }
}

v1::PointBlock raw_block(const Points& points) {
  v1::PointBlock block;
  set_common(points, &block);
  block.mutable_raw()->set_positions(bytes_of(points.positions));
  block.mutable_raw()->set_normals(bytes_of(points.normals));
  block.mutable_raw()->set_radii(bytes_of(points.radii));
  block.mutable_raw()->set_colours(bytes_of(points.colours));
  return block;
}

v1::PointBlock draco_block(const Points& points, int position_bits) {
  v1::PointBlock block;
  set_common(points, &block);
  Points relative = points;
  relative.origin = {};
  block.mutable_draco()->set_data(*make_drc(relative, {.position_bits = position_bits, .normal_bits = 10}));
  const auto [min, max] = std::minmax_element(points.radii.begin(), points.radii.end());
  block.mutable_draco()->set_radius_min(*min);
  block.mutable_draco()->set_radius_max(*max);
  return block;
}

}  // namespace curvecast::client
