#include "proto/formats/las.h"

#include <absl/strings/str_cat.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tests/proto/formats/sphere_columns.h"

namespace curvecast::formats {
namespace {

struct Las {
  int format = 0;
  std::uint64_t points = 0, first_returns = 0;
  std::size_t offset = 0, point_bytes = 0;
  std::array<double, 3> scale{}, zero{}, low{}, high{};
  std::vector<std::string> extras;
  std::vector<int> extra_types;
  std::string bytes;

  ByteReader point(std::size_t index) const {
    return ByteReader(std::string_view(bytes).substr(offset + index * point_bytes, point_bytes));
  }
  double coordinate(std::size_t index, int axis) const {
    ByteReader reader = point(index);
    reader.skip(4 * static_cast<std::size_t>(axis));
    return reader.next<std::int32_t>() * scale[axis] + zero[axis];
  }
};

Las parse_las(const std::string& bytes) {
  Las las;
  las.bytes = bytes;
  ByteReader reader(bytes);
  EXPECT_EQ(reader.text(4), "LASF");
  reader.skip(2);
  EXPECT_EQ(reader.next<std::uint16_t>(), 16) << "well-known text";
  reader.skip(16);
  EXPECT_EQ(reader.next<std::uint8_t>(), 1);
  EXPECT_EQ(reader.next<std::uint8_t>(), 4);
  reader.skip(32);
  EXPECT_EQ(reader.text(32), "Curvecast");
  reader.skip(4);
  EXPECT_EQ(reader.next<std::uint16_t>(), 375);
  las.offset = reader.next<std::uint32_t>();
  const auto records = reader.next<std::uint32_t>();
  las.format = reader.next<std::uint8_t>();
  las.point_bytes = reader.next<std::uint16_t>();
  reader.skip(24);
  las.scale = reader.next<std::array<double, 3>>();
  las.zero = reader.next<std::array<double, 3>>();
  for (int axis = 0; axis < 3; ++axis) {
    las.high[axis] = reader.next<double>();
    las.low[axis] = reader.next<double>();
  }
  reader.skip(20);
  las.points = reader.next<std::uint64_t>();
  las.first_returns = reader.next<std::uint64_t>();
  reader.skip(14 * 8);
  EXPECT_EQ(reader.at(), 375U);
  if (records > 0) {
    reader.skip(2);
    EXPECT_EQ(reader.text(16), "LASF_Spec");
    EXPECT_EQ(reader.next<std::uint16_t>(), 4);
    const auto length = reader.next<std::uint16_t>();
    reader.skip(32);
    for (int i = 0; i < length / 192; ++i) {
      reader.skip(2);
      las.extra_types.push_back(reader.next<std::uint8_t>());
      reader.skip(1);
      las.extras.push_back(reader.text(32));
      reader.skip(192 - 36);
    }
  }
  EXPECT_EQ(reader.at(), las.offset);
  EXPECT_EQ(bytes.size(), las.offset + las.points * las.point_bytes);
  return las;
}

TEST(Las, HoldsAllColumnsInOrderOfRank) {
  const SpherePoints sphere(700);
  const auto bytes = make_las(sphere.columns());
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  const Las las = parse_las(*bytes);
  EXPECT_EQ(las.format, 7);
  EXPECT_EQ(las.points, 700U);
  EXPECT_EQ(las.first_returns, 700U);
  const std::vector<std::string> extras = {
      "radius", "NormalX",       "NormalY",       "NormalZ",         "curvature_min",   "curvature_max",   "rank",
      "face",   "barycentric_2", "barycentric_3", "direction_min_x", "direction_min_y", "direction_min_z", "height"};
  EXPECT_EQ(las.extras, extras);
  EXPECT_EQ(las.point_bytes, 36 + 4 * extras.size());
  for (std::size_t i = 0; i < extras.size(); ++i) {
    EXPECT_EQ(las.extra_types[i], extras[i] == "rank" || extras[i] == "face" ? 5 : 9) << extras[i];
  }
  for (std::size_t i = 0; i < 700; ++i) {
    const std::size_t point = sphere.with_rank(i);
    for (int axis = 0; axis < 3; ++axis) ASSERT_NEAR(las.coordinate(i, axis), sphere.positions[point][axis], 1e-8);
    ByteReader reader = las.point(i);
    reader.skip(12 + 2);
    ASSERT_EQ(reader.next<std::uint8_t>(), 0x11) << "the first of one return";
    reader.skip(15);
    for (const std::uint8_t channel : sphere.colours[point]) ASSERT_EQ(reader.next<std::uint16_t>(), 257 * channel);
    ASSERT_EQ(reader.next<float>(), sphere.radii[point]);
    for (const float n : sphere.normals[point]) ASSERT_EQ(reader.next<float>(), n);
    for (const float k : sphere.curvatures[point]) ASSERT_EQ(reader.next<float>(), k);
    ASSERT_EQ(reader.next<std::uint32_t>(), i);
    ASSERT_EQ(reader.next<std::uint32_t>(), sphere.faces[point]);
    for (const float weight : sphere.barycentric[point]) ASSERT_EQ(reader.next<float>(), weight);
    for (const float d : sphere.directions[point]) ASSERT_EQ(reader.next<float>(), d);
    const auto height = reader.next<float>();
    ASSERT_TRUE(height == sphere.heights[point] || std::isnan(sphere.heights[point]));
    ASSERT_TRUE(reader.at_end());
  }
}

// From specks to planets, near and far: the rounding has to stay below what floats of that size have, and the header's box true.
TEST(Las, RoundsLessThanFloats) {
  for (const double size : {1e-12, 3.3e-7, 0.021, 1.0, 2.147483647, 2.2, 214.7483648, 5e4, 7e9}) {
    for (const double far : {0.0, 4.6e6}) {
      SpherePoints sphere(50);
      for (std::array<float, 3>& position : sphere.positions) {
        for (float& coordinate : position) coordinate = static_cast<float>(coordinate * size);
      }
      PointColumns columns = sphere.columns();
      columns.origin = {far, -far, 0};
      const auto bytes = make_las(columns);
      ASSERT_TRUE(bytes.ok()) << bytes.status();
      const Las las = parse_las(*bytes);
      const double exponent = std::log10(las.scale[0]);
      EXPECT_NEAR(exponent, std::round(exponent), 1e-9) << "a power of ten";
      // Doubles have their own steps far out.
      const double most = 2 * size * 5e-9 + 2 * std::abs(far) * 2.3e-16;
      std::array<double, 3> low{}, high{};
      low.fill(1e300), high.fill(-1e300);
      for (std::size_t i = 0; i < 50; ++i) {
        for (int axis = 0; axis < 3; ++axis) {
          const double is = las.coordinate(i, axis);
          ASSERT_NEAR(is, columns.absolute(sphere.with_rank(i), axis), most) << size << " " << far;
          low[axis] = std::min(low[axis], is), high[axis] = std::max(high[axis], is);
        }
      }
      EXPECT_EQ(las.low, low);
      EXPECT_EQ(las.high, high);
    }
  }
}

TEST(Las, HoldsPointsThatLieTogether) {
  const std::vector<std::array<float, 3>> positions(3, {1.5F, -2.25F, 1e-3F});
  PointColumns columns;
  columns.positions = positions;
  const auto bytes = make_las(columns);
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  const Las las = parse_las(*bytes);
  EXPECT_EQ(las.format, 6) << "without colours";
  EXPECT_EQ(las.point_bytes, 30U);
  for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(las.coordinate(2, axis), positions[2][axis]);
}

TEST(Las, KeepsNamesShortAndApart) {
  const SpherePoints sphere(10);
  PointColumns columns = sphere.columns();
  const std::string name(40, 'n');
  columns.scalars = {{name, sphere.heights}, {name, sphere.heights}, {"rank", sphere.heights}, {"a b", sphere.heights}};
  const auto bytes = make_las(columns);
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  const Las las = parse_las(*bytes);
  const std::size_t last = las.extras.size() - 4;
  EXPECT_EQ(las.extras[last], name.substr(0, 32));
  EXPECT_EQ(las.extras[last + 1], absl::StrCat(name.substr(0, 30), "_2"));
  EXPECT_EQ(las.extras[last + 2], "rank_2");
  EXPECT_EQ(las.extras[last + 3], "a_b");
}

TEST(Las, RefusesWhatItCannotHold) {
  const SpherePoints sphere(10);
  PointColumns columns = sphere.columns();
  columns.scalars.assign(400, {"x", sphere.heights});
  EXPECT_TRUE(absl::IsInvalidArgument(make_las(columns).status()));
  SpherePoints broken(10);
  broken.colours.pop_back();
  EXPECT_TRUE(absl::IsInvalidArgument(make_las(broken.columns()).status()));
}

TEST(Las, HoldsNoPointsToo) {
  const auto bytes = make_las({});
  ASSERT_TRUE(bytes.ok()) << bytes.status();
  EXPECT_EQ(parse_las(*bytes).points, 0U);
}

TEST(Las, IsTheSameBytesAgain) {
  const SpherePoints sphere(300);
  EXPECT_EQ(*make_las(sphere.columns()), *make_las(sphere.columns()));
}

}  // namespace
}  // namespace curvecast::formats
