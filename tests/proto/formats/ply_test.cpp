#include "proto/formats/ply.h"

#include <gtest/gtest.h>

#include <bit>

#include "tests/proto/formats/sphere_columns.h"

namespace curvecast::formats {
namespace {

TEST(Ply, HasAllColumnsInTheirOrder) {
  const SpherePoints sphere(20);
  const PointColumns columns = sphere.columns();
  const absl::StatusOr<std::string> file = make_ply(columns);
  ASSERT_TRUE(file.ok()) << file.status();
  const std::size_t end = file->find("end_header\n") + 11;
  const std::string header = file->substr(0, end);
  const bool has_doubles = columns.origin != std::array<double, 3>{};
  EXPECT_EQ(header.find("ply\nformat binary_little_endian 1.0\nelement vertex 20\n"), 0u);
  ByteReader reader(std::string_view(*file).substr(end));
  for (std::size_t i = 0; i < 20; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      const double read = has_doubles ? reader.next<double>() : double{reader.next<float>()};
      EXPECT_EQ(read, has_doubles ? columns.absolute(i, axis) : double{static_cast<float>(columns.absolute(i, axis))});
    }
    for (const float n : columns.normals[i]) EXPECT_EQ(reader.next<float>(), n);
    for (const std::uint8_t c : columns.colours[i]) EXPECT_EQ(reader.next<std::uint8_t>(), c);
    EXPECT_EQ(reader.next<float>(), columns.radii[i]);
    for (const float k : columns.curvatures[i]) EXPECT_EQ(reader.next<float>(), k);
    EXPECT_EQ(reader.next<std::uint32_t>(), columns.ranks[i]);
    EXPECT_EQ(reader.next<std::uint32_t>(), columns.faces[i]);
    for (const float w : columns.barycentric[i]) EXPECT_EQ(reader.next<float>(), w);
    for (const float d : columns.directions[i]) EXPECT_EQ(reader.next<float>(), d);
    for (const NamedColumn& column : columns.scalars) {  // which may be no number
      EXPECT_EQ(reader.next<std::uint32_t>(), std::bit_cast<std::uint32_t>(column.values[i]));
    }
  }
  EXPECT_TRUE(reader.at_end());
}

TEST(Ply, NamesCannotEndALine) {
  const std::array<std::array<float, 3>, 1> positions = {{{1, 2, 3}}};
  const std::array<float, 1> values = {4};
  PointColumns columns{.positions = positions};
  columns.scalars.push_back({"a b\nend_header", values});
  EXPECT_NE(make_ply(columns)->find("property float scalar_a_b_end_header\nend_header\n"), std::string::npos);
}

TEST(Ply, FarFromTheOriginCoordinatesAreDoubles) {
  const std::array<std::array<float, 3>, 1> positions = {{{0.25F, 0, 0}}};
  const PointColumns columns{.origin = {1e7, 0, 0}, .positions = positions};
  const std::string file = *make_ply(columns);
  EXPECT_NE(file.find("property double x\n"), std::string::npos);
  ByteReader reader(std::string_view(file).substr(file.size() - 24));
  EXPECT_EQ(reader.next<double>(), 1e7 + 0.25);
}

TEST(Ply, RefusesColumnsOfOtherLengths) {
  const std::array<std::array<float, 3>, 2> positions = {};
  const std::array<float, 1> radii = {1};
  EXPECT_TRUE(absl::IsInvalidArgument(make_ply({.positions = positions, .radii = radii}).status()));
}

}  // namespace
}  // namespace curvecast::formats
