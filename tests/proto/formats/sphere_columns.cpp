#include "tests/proto/formats/sphere_columns.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace curvecast::formats {

SpherePoints::SpherePoints(std::size_t count) {
  const double radius = 1.25 * std::sqrt(4 * std::numbers::pi / static_cast<double>(count));
  points_.resize(count);
  for (std::size_t i = 0; i < count; ++i) {
    const double z = 1 - (2 * static_cast<double>(i) + 1) / static_cast<double>(count);
    const double angle = static_cast<double>(i) * std::numbers::pi * (3 - std::sqrt(5.0)), across = std::sqrt(1 - z * z);
    const std::array<float, 3> place = {static_cast<float>(across * std::cos(angle)),
                                        static_cast<float>(across * std::sin(angle)), static_cast<float>(z)};
    positions.push_back(place);
    normals.push_back(place);
    directions.push_back({static_cast<float>(-std::sin(angle)), static_cast<float>(std::cos(angle)), 0.0F});
    std::array<std::uint8_t, 3> colour;
    for (int axis = 0; axis < 3; ++axis) colour[axis] = static_cast<std::uint8_t>(127.5 + 127.5 * place[axis]);
    colours.push_back(colour);
    curvatures.push_back({0.5F, 1.0F + static_cast<float>(i)});
    barycentric.push_back({0.25F, static_cast<float>(i) / static_cast<float>(count)});
    radii.push_back(static_cast<float>(radius * (1 + 0.5 * z)));
    heights.push_back(i % 5 == 3 ? std::numeric_limits<float>::quiet_NaN() : static_cast<float>(i));
    // A generator of the numbers below count, where count is no multiple of it.
    const std::size_t rank = i * 7919 % count;
    ranks.push_back(static_cast<std::uint32_t>(rank));
    faces.push_back(static_cast<std::uint32_t>(4'000'000'000U + i));
    points_[rank] = i;
  }
}

PointColumns SpherePoints::columns() const {
  PointColumns columns;
  columns.positions = positions;
  columns.normals = normals;
  columns.radii = radii;
  columns.colours = colours;
  columns.curvatures = curvatures;
  columns.ranks = ranks;
  columns.faces = faces;
  columns.barycentric = barycentric;
  columns.directions = directions;
  columns.scalars = {{"height", heights}};
  return columns;
}

std::string ByteReader::text(std::size_t length) {
  std::string out;
  for (std::size_t i = 0; i < length; ++i) out += next<char>();
  return out.substr(0, out.find('\0'));
}

}  // namespace curvecast::formats
