#include "client/lib/point_blocks.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "tests/client/sphere_points.h"

namespace curvecast::client {
namespace {

using ::testing::HasSubstr;

double distance(const std::array<float, 3>& a, const std::array<float, 3>& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

TEST(DecodeBlock, KeepsRawPointsExactly) {
  Points points = sphere_points(1000);
  points.origin = {1e6, -2, 3};
  const auto decoded = decode_block(raw_block(points));
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  EXPECT_EQ(decoded->origin, points.origin);
  EXPECT_EQ(decoded->positions, points.positions);
  EXPECT_EQ(decoded->normals, points.normals);
  EXPECT_EQ(decoded->radii, points.radii);
}

TEST(DecodeBlock, KeepsDracoPointsInOrderWithinTheLattice) {
  const Points points = sphere_points(5000);
  const auto decoded = decode_block(draco_block(points, 14));
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  ASSERT_EQ(decoded->size(), points.size());
  const double cell = 2.0 / ((1 << 14) - 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    ASSERT_LT(distance(decoded->positions[i], points.positions[i]), 0.9 * cell) << i;
    ASSERT_LT(distance(decoded->normals[i], points.normals[i]), 0.01) << i;
    ASSERT_NEAR(decoded->radii[i] / points.radii[i], 1, 0.5 * std::log(2.0) / 255 + 1e-5) << i;
  }
}

TEST(DecodeBlock, KeepsColoursExactly) {
  Points points = sphere_points(1000);
  EXPECT_TRUE(decode_block(draco_block(points))->colours.empty());
  const std::uint64_t uncoloured = encoded_bytes(raw_block(points));
  add_colours(&points);
  for (const v1::PointBlock& block : {raw_block(points), draco_block(points)}) {
    const auto decoded = decode_block(block);
    ASSERT_TRUE(decoded.ok()) << decoded.status();
    EXPECT_EQ(decoded->colours, points.colours);
  }
  EXPECT_EQ(encoded_bytes(raw_block(points)), uncoloured + 3000);
}

TEST(DecodeBlock, RefusesColoursOfAnotherNumber) {
  Points points = sphere_points(100);
  add_colours(&points);
  for (const std::size_t bytes : {1UL, 3UL, 100UL, 299UL, 301UL, 400UL}) {
    v1::PointBlock block = raw_block(points);
    block.mutable_raw()->mutable_colours()->resize(bytes);
    EXPECT_TRUE(absl::IsDataLoss(decode_block(block).status())) << bytes;
  }
}

template <typename T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// Points with directions, and scalars of which one is not a number.
v1::PointBlock described_block(const Points& points) {
  v1::PointBlock block = raw_block(points);
  block.mutable_attributes()->set_directions(bytes_of(points.normals));
  for (const char* name : {"heat", "age"}) {
    std::vector<float> values = points.radii;
    values[1] = std::numeric_limits<float>::quiet_NaN();
    v1::ScalarValues& scalar = *block.mutable_attributes()->add_scalars();
    scalar.set_name(name);
    scalar.set_values(bytes_of(values));
  }
  return block;
}

TEST(DecodeBlock, KeepsDirectionsAndNamedValues) {
  const Points points = sphere_points(100);
  const v1::PointBlock block = described_block(points);
  const auto decoded = decode_block(block);
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  EXPECT_EQ(decoded->directions, points.normals);
  ASSERT_EQ(decoded->scalars.size(), 2U);
  EXPECT_EQ(decoded->scalars[0].name, "heat");
  EXPECT_EQ(decoded->scalars[1].name, "age");
  for (const ScalarColumn& scalar : decoded->scalars) {
    ASSERT_EQ(scalar.values.size(), 100U);
    EXPECT_TRUE(std::isnan(scalar.values[1]));
    EXPECT_EQ(scalar.values[99], points.radii[99]);
  }
  EXPECT_EQ(encoded_bytes(block), encoded_bytes(raw_block(points)) + 100 * (12 + 4 + 4));
}

TEST(DecodeBlock, RefusesAttributesThatMakeNoSense) {
  const v1::PointBlock good = described_block(sphere_points(100));
  EXPECT_TRUE(decode_block(good).ok());
  const auto refused = [&](const auto& spoil) {
    v1::PointBlock block = good;
    spoil(*block.mutable_attributes());
    return absl::IsDataLoss(decode_block(block).status());
  };
  EXPECT_TRUE(refused([](auto& more) { more.mutable_directions()->pop_back(); }));
  EXPECT_TRUE(refused([](auto& more) { more.set_directions(bytes_of(std::vector<float>(300, INFINITY))); }));
  EXPECT_TRUE(refused([](auto& more) { more.mutable_scalars(1)->mutable_values()->pop_back(); }));
  EXPECT_TRUE(refused([](auto& more) { more.mutable_scalars(1)->clear_values(); }));
  EXPECT_TRUE(refused([](auto& more) { more.mutable_scalars(1)->set_name("heat"); }));
}

TEST(DecodeBlock, RefusesBlocksThatDisagreeWithTheirCount) {
  const Points points = sphere_points(100);
  for (v1::PointBlock block : {raw_block(points), draco_block(points)}) {
    for (const std::uint32_t count : {0U, 1U, 99U, 101U, 0xffffffffU}) {
      block.set_count(count);
      EXPECT_TRUE(absl::IsDataLoss(decode_block(block).status())) << count;
    }
  }
  EXPECT_TRUE(absl::IsDataLoss(decode_block(v1::PointBlock()).status()));
}

TEST(DecodeBlock, RefusesWhatIsNotFinite) {
  const float bad[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()};
  for (const float value : bad) {
    for (int field = 0; field < 3; ++field) {
      Points points = sphere_points(10);
      (field == 0 ? points.positions[7][1] : field == 1 ? points.normals[7][2] : points.radii[7]) = value;
      const absl::Status status = decode_block(raw_block(points)).status();
      EXPECT_TRUE(absl::IsDataLoss(status));
      EXPECT_THAT(std::string(status.message()), HasSubstr("point 7"));
    }
    v1::PointBlock block = draco_block(sphere_points(10));
    block.mutable_draco()->set_radius_max(value);
    EXPECT_TRUE(absl::IsDataLoss(decode_block(block).status()));
    block = raw_block(sphere_points(10));
    block.mutable_origin()->set_x(value);
    EXPECT_TRUE(absl::IsDataLoss(decode_block(block).status()));
  }
}

TEST(AppendPoints, KeepsAbsolutePositions) {
  Points all = sphere_points(3), more = sphere_points(5);
  add_colours(&all);
  add_colours(&more);
  all.origin = {100, 200, 300};
  more.origin = {101, 202, 297};
  append_points(more, &all);
  ASSERT_EQ(all.size(), 8U);
  EXPECT_EQ(all.normals.size(), 8U);
  EXPECT_EQ(all.radii.size(), 8U);
  ASSERT_EQ(all.colours.size(), 8U);
  EXPECT_EQ(all.colours[7], more.colours[4]);
  for (std::size_t i = 0; i < 5; ++i) {
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_NEAR(all.origin[axis] + all.positions[3 + i][axis], more.origin[axis] + more.positions[i][axis], 1e-5);
    }
  }
}

using Blocks = google::protobuf::RepeatedPtrField<v1::PointBlock>;

TEST(DecodeBlocks, JoinsNamedValuesOfTheSameNamesOnly) {
  Blocks blocks;
  *blocks.Add() = described_block(sphere_points(10));
  *blocks.Add() = described_block(sphere_points(20));
  const auto decoded = decode_blocks(blocks);
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  EXPECT_EQ(decoded->directions.size(), 30U);
  EXPECT_TRUE(std::isnan(decoded->scalars[1].values[11]));
  Points appended = *decode_block(blocks[0]);
  append_points(*decode_block(blocks[1]), &appended);
  EXPECT_TRUE(have_same_columns(appended, *decoded));
  EXPECT_EQ(appended.directions, decoded->directions);
  EXPECT_EQ(appended.scalars[0].values[29], decoded->scalars[0].values[29]);
  blocks[1].mutable_attributes()->mutable_scalars()->SwapElements(0, 1);
  EXPECT_TRUE(absl::IsDataLoss(decode_blocks(blocks).status()));
  EXPECT_FALSE(have_same_columns(appended, *decode_block(blocks[1])));
}

TEST(DecodeBlocks, JoinsThemInOrder) {
  Blocks blocks;
  Points all;
  for (const std::size_t n : {100u, 1u, 3000u, 7u, 20'000u}) {
    Points points = sphere_points(n);
    points.origin = {1, 2, 3};
    *blocks.Add() = raw_block(points);
    append_points(std::move(points), &all);
  }
  const auto decoded = decode_blocks(blocks);
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  EXPECT_EQ(decoded->origin, all.origin);
  EXPECT_EQ(decoded->positions, all.positions);
  EXPECT_EQ(decoded->radii, all.radii);
  EXPECT_EQ(encoded_bytes(blocks), 28 * all.size());
  EXPECT_EQ(decode_blocks({})->size(), 0u);
}

TEST(DecodeBlocks, RefusesThoseThatDoNotGoTogether) {
  const auto refused = [](v1::PointBlock second) {
    Blocks blocks;
    *blocks.Add() = raw_block(sphere_points(10));
    *blocks.Add() = std::move(second);
    return absl::IsDataLoss(decode_blocks(blocks).status());
  };
  EXPECT_FALSE(refused(raw_block(sphere_points(10))));
  EXPECT_TRUE(refused(v1::PointBlock()));
  v1::PointBlock elsewhere = raw_block(sphere_points(10));
  elsewhere.mutable_origin()->set_x(5);
  EXPECT_TRUE(refused(elsewhere));
  v1::PointBlock coloured = raw_block(sphere_points(10));
  coloured.mutable_raw()->set_colours(std::string(30, 'c'));
  EXPECT_TRUE(refused(coloured));
  EXPECT_TRUE(refused(described_block(sphere_points(10))));
  v1::PointBlock absurd = raw_block(sphere_points(10));
  absurd.set_count(4'000'000);
  EXPECT_TRUE(refused(absurd));
}

}  // namespace
}  // namespace curvecast::client
