#include "proto/formats/point_columns.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "tests/proto/formats/sphere_columns.h"

namespace curvecast::formats {
namespace {

TEST(PointColumns, AreInOrderOfRank) {
  const SpherePoints sphere(1000);
  const std::vector<std::uint32_t> order = rank_order(sphere.columns());
  ASSERT_EQ(order.size(), 1000U);
  for (std::size_t i = 0; i < order.size(); ++i) ASSERT_EQ(order[i], sphere.with_rank(i));
}

TEST(PointColumns, KeepTheirOrderWithoutRanks) {
  const SpherePoints sphere(100);
  PointColumns columns = sphere.columns();
  columns.ranks = {};
  const std::vector<std::uint32_t> order = rank_order(columns);
  for (std::uint32_t i = 0; i < order.size(); ++i) ASSERT_EQ(order[i], i);
}

TEST(PointColumns, OfTheSameRankStayAsTheyCome) {
  const std::vector<std::array<float, 3>> positions(6);
  const std::vector<std::uint32_t> ranks = {7, 2, 7, 2, 0, 7};
  PointColumns columns;
  columns.positions = positions;
  columns.ranks = ranks;
  EXPECT_EQ(rank_order(columns), (std::vector<std::uint32_t>{4, 1, 3, 0, 2, 5}));
}

TEST(PointColumns, HaveABox) {
  const std::vector<std::array<float, 3>> positions = {{1, 2, 3}, {-1, 5, 3}, {0, 0, 3.5}};
  const Box box = box_of(positions);
  EXPECT_EQ(box.low, (std::array<float, 3>{-1, 0, 3}));
  EXPECT_EQ(box.high, (std::array<float, 3>{1, 5, 3.5}));
  EXPECT_EQ(box.extent(), 5);
}

TEST(PointColumns, AreRefusedWhereTheyAreBroken) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  struct Fault {
    std::function<void(SpherePoints&, PointColumns&)> make;
    std::string says;
  };
  const std::vector<Fault> faults = {
      {[](SpherePoints&, PointColumns& c) { c.normals = c.normals.first(9); }, "9 values of normals"},
      {[](SpherePoints&, PointColumns& c) { c.radii = c.radii.first(9); }, "9 values of radii"},
      {[](SpherePoints&, PointColumns& c) { c.colours = c.colours.first(9); }, "9 values of colours"},
      {[](SpherePoints&, PointColumns& c) { c.curvatures = c.curvatures.first(9); }, "9 values of curvatures"},
      {[](SpherePoints&, PointColumns& c) { c.ranks = c.ranks.first(9); }, "9 values of ranks"},
      {[](SpherePoints&, PointColumns& c) { c.faces = c.faces.first(9); }, "9 values of faces"},
      {[](SpherePoints&, PointColumns& c) { c.barycentric = c.barycentric.first(9); }, "9 values of barycentric"},
      {[](SpherePoints&, PointColumns& c) { c.directions = c.directions.first(9); }, "9 values of directions"},
      {[](SpherePoints&, PointColumns& c) { c.scalars[0].values = c.scalars[0].values.first(9); }, "9 values of height"},
      {[nan](SpherePoints& s, PointColumns&) { s.positions[4][1] = nan; }, "position of point 4"},
      {[infinity](SpherePoints& s, PointColumns&) { s.positions[5][2] = -infinity; }, "position of point 5"},
      {[](SpherePoints& s, PointColumns&) {
         s.normals[6] = {0, 0, 0};
       },
       "normal of point 6"},
      {[nan](SpherePoints& s, PointColumns&) { s.normals[7][0] = nan; }, "normal of point 7"},
      {[](SpherePoints& s, PointColumns&) { s.radii[8] = -1; }, "radius of point 8"},
      {[infinity](SpherePoints& s, PointColumns&) { s.radii[9] = infinity; }, "radius of point 9"},
      {[nan](SpherePoints&, PointColumns& c) { c.origin[2] = double{nan}; }, "origin"},
  };
  for (const Fault& fault : faults) {
    SpherePoints sphere(10);
    PointColumns columns = sphere.columns();
    ASSERT_TRUE(check_columns(columns).ok());
    fault.make(sphere, columns);
    const absl::Status status = check_columns(columns);
    EXPECT_TRUE(absl::IsInvalidArgument(status)) << fault.says;
    EXPECT_NE(status.message().find(fault.says), absl::string_view::npos) << status << " says not " << fault.says;
  }
}

}  // namespace
}  // namespace curvecast::formats
