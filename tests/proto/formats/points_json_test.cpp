#include "proto/formats/points_json.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "tests/proto/formats/sphere_columns.h"

namespace curvecast::formats {
namespace {

using Json = nlohmann::json;

TEST(PointsJson, ReadsBackExactly) {
  const SpherePoints sphere(30);
  const PointColumns columns = sphere.columns();
  const Json read = Json::parse(*make_points_json(columns));
  EXPECT_EQ(read["count"], 30);
  EXPECT_EQ(read["origin"].get<std::vector<double>>(), std::vector<double>(columns.origin.begin(), columns.origin.end()));
  ASSERT_EQ(read["positions"].size(), 90u);
  ASSERT_EQ(read["colours"].size(), 90u);
  ASSERT_EQ(read["curvatures"].size(), 60u);
  for (std::size_t i = 0; i < 30; ++i) {
    EXPECT_EQ(read["positions"][3 * i + 2].get<float>(), columns.positions[i][2]);
    EXPECT_EQ(read["colours"][3 * i + 1], columns.colours[i][1]);
    EXPECT_EQ(read["radii"][i].get<float>(), columns.radii[i]);
    EXPECT_EQ(read["ranks"][i], columns.ranks[i]);
  }
  EXPECT_EQ(read["scalars"].size(), columns.scalars.size());
}

TEST(PointsJson, WhatJsonCannotSayIsNull) {
  const std::array<std::array<float, 3>, 2> positions = {{{1, 2, 3}, {0.1F, 0, 0}}};
  const std::array<float, 2> values = {std::numeric_limits<float>::quiet_NaN(), 2};
  PointColumns columns{.positions = positions};
  columns.scalars.push_back({"a \"b\"\xff", values});
  const Json read = Json::parse(*make_points_json(columns));
  EXPECT_EQ(read["scalars"].begin().value(), Json::parse("[null, 2.0]"));
  EXPECT_FALSE(read.contains("normals"));
  EXPECT_EQ(read["positions"][3].get<float>(), 0.1F);
  EXPECT_EQ(Json::parse(*make_points_json({}))["count"], 0);
}

}  // namespace
}  // namespace curvecast::formats
