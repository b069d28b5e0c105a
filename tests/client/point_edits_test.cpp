#include "client/lib/point_edits.h"

#include <google/protobuf/util/json_util.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "client/lib/protocol.h"

namespace curvecast::client {
namespace {

/// A point that is known by its number.
Points numbered(const std::vector<int>& numbers) {
  Points points;
  ScalarColumn heat{"heat", {}};
  for (const int n : numbers) {
    const auto value = static_cast<float>(n);
    points.positions.push_back({value, 2 * value, -value});
    points.normals.push_back({0, 0, 1});
    points.radii.push_back(1);
    points.ranks.push_back(static_cast<std::uint32_t>(n));
    points.directions.push_back({value, 0, 1});
    heat.values.push_back(3 * value);
  }
  points.scalars = {heat, {"age", std::vector<float>(numbers.size(), 4)}};
  return points;
}

void write(const std::vector<std::uint32_t>& indices, google::protobuf::RepeatedField<std::uint32_t>* out) {
  std::uint32_t last = 0;
  for (const std::uint32_t i : indices) out->Add(i - std::exchange(last, i));
}

/// Points of the shared cases: of each its number and the rung of its disc.
Points listed(const nlohmann::json& rows, double largest) {
  std::vector<int> numbers;
  for (const nlohmann::json& row : rows) numbers.push_back(row[0]);
  Points points = numbered(numbers);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    points.radii[i] = static_cast<float>(largest * std::exp2(-rows[i][1].get<int>() / 2.0));
  }
  return points;
}

TEST(PointEdits, TheSharedCases) {
  std::ifstream file(CURVECAST_POINT_EDITS);
  const nlohmann::json cases = nlohmann::json::parse(file);
  EXPECT_GT(cases.size(), 30u);
  for (const nlohmann::json& one : cases) {
    SCOPED_TRACE(one["name"].get<std::string>());
    v1::PointEdits edits;
    ASSERT_TRUE(google::protobuf::util::JsonStringToMessage(one["edits"].dump(), &edits).ok());
    const double largest = edits.radius_max() > 0 && std::isfinite(edits.radius_max()) ? edits.radius_max() : 1;
    const absl::StatusOr<Points> after = apply_edits(listed(one["before"], largest), edits, listed(one["fresh"], largest));
    if (one["after"].is_null()) {
      EXPECT_TRUE(absl::IsInvalidArgument(after.status()));
      continue;
    }
    ASSERT_TRUE(after.ok()) << after.status();
    const Points expected = listed(one["after"], largest);
    EXPECT_EQ(after->positions, expected.positions);
    EXPECT_EQ(after->ranks, expected.ranks);
    ASSERT_EQ(after->radii.size(), expected.radii.size());
    for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_FLOAT_EQ(after->radii[i], expected.radii[i]);
  }
}

TEST(PointEdits, RandomEditsGiveTheNewList) {
  std::mt19937 random(1);
  const auto below = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  std::vector<int> list;
  Points held;
  for (int round = 0; round < 300; ++round) {
    std::vector<int> next;
    std::vector<std::uint32_t> removed, added;
    std::vector<int> fresh;
    const int keep_of_10 = below(11), runs = 1 + below(5);
    for (std::size_t i = 0; i <= list.size(); ++i) {
      if (below(4) == 0) {
        for (int k = below(runs + 1); k > 0; --k) {
          fresh.push_back(1000 * round + static_cast<int>(fresh.size()));
          added.push_back(static_cast<std::uint32_t>(next.size()));
          next.push_back(fresh.back());
        }
      }
      if (i == list.size()) break;
      if (below(10) < keep_of_10 && next.size() < 500) {
        next.push_back(list[i]);
      } else {
        removed.push_back(static_cast<std::uint32_t>(i));
      }
    }
    v1::PointEdits edits;
    write(removed, edits.mutable_removed());
    write(added, edits.mutable_added());
    const absl::StatusOr<Points> points = apply_edits(held, edits, numbered(fresh));
    ASSERT_TRUE(points.ok()) << points.status();
    const Points expected = numbered(next);
    ASSERT_EQ(points->positions, expected.positions);
    ASSERT_EQ(points->ranks, expected.ranks);
    ASSERT_EQ(points->directions, expected.directions);
    ASSERT_EQ(points->scalars, expected.scalars);
    ASSERT_EQ(points->radii.size(), next.size());
    list = next;
    held = *points;
  }
}

TEST(PointEdits, DiscsClimbTheLadder) {
  Points held = numbered({0, 1, 2, 3});
  v1::PointEdits edits;
  edits.set_radius_max(8);
  edits.add_resized(2 * 1);      // point 1 one rung larger
  edits.add_resized(2 * 0);      // and another one
  edits.add_resized(2 * 2 + 1);  // point 3 one rung smaller
  const absl::StatusOr<Points> points = apply_edits(held, edits, {});
  ASSERT_TRUE(points.ok()) << points.status();
  EXPECT_EQ(points->radii[0], 1);
  EXPECT_FLOAT_EQ(points->radii[1], static_cast<float>(std::exp2(1.0)));
  EXPECT_EQ(points->radii[2], 1);
  EXPECT_FLOAT_EQ(points->radii[3], static_cast<float>(std::exp2(-0.5)));
  for (int i = 0; i < 50; ++i) edits.add_resized(0);  // no disc is larger than the largest
  const absl::StatusOr<Points> huge = apply_edits(held, edits, {});
  ASSERT_TRUE(huge.ok());
  EXPECT_EQ(huge->radii[3], 8);
}

TEST(PointEdits, RefusesWhatDoesNotFit) {
  const Points held = numbered({0, 1, 2, 3});
  const auto refused = [&](const std::vector<std::uint32_t>& removed, const std::vector<std::uint32_t>& added,
                           const Points& fresh) {
    v1::PointEdits edits;
    for (const std::uint32_t i : removed) edits.add_removed(i);
    for (const std::uint32_t i : added) edits.add_added(i);
    return apply_edits(held, edits, fresh).status().code() == absl::StatusCode::kInvalidArgument;
  };
  EXPECT_TRUE(refused({4}, {}, {}));
  EXPECT_TRUE(refused({3, 1}, {}, {}));
  EXPECT_TRUE(refused({1, 0}, {}, {}));
  EXPECT_TRUE(refused({0, 0xffffffffu, 0xffffffffu}, {}, {}));
  EXPECT_TRUE(refused({}, {5}, numbered({7})));
  EXPECT_TRUE(refused({}, {0}, {}));
  EXPECT_TRUE(refused({}, {}, numbered({7})));
  EXPECT_TRUE(refused({}, {0, 0}, numbered({7, 8})));
  Points bare = numbered({7});
  bare.ranks.clear();
  EXPECT_TRUE(refused({}, {0}, bare));
  Points elsewhere = numbered({7});
  elsewhere.origin[1] = 3;
  EXPECT_TRUE(refused({}, {0}, elsewhere));
  EXPECT_FALSE(refused({0}, {0, 2}, numbered({7, 8})));
  v1::PointEdits resized;
  resized.set_radius_max(1);
  resized.add_resized(8);
  EXPECT_EQ(apply_edits(held, resized, {}).status().code(), absl::StatusCode::kInvalidArgument);
  resized.clear_resized();
  resized.add_resized(0);
  for (const float largest : {0.0F, -1.0F, INFINITY, NAN}) {
    resized.set_radius_max(largest);
    EXPECT_EQ(apply_edits(held, resized, {}).status().code(), absl::StatusCode::kInvalidArgument) << largest;
  }
}

TEST(PointEdits, DoNotGrowAListForEver) {
  Points held, added;
  held.positions.resize(kMaxPoints);
  added.positions.resize(1);
  v1::PointEdits edits;
  edits.add_added(5);
  EXPECT_TRUE(absl::IsInvalidArgument(apply_edits(held, edits, added).status()));
  edits.add_removed(0);
  EXPECT_TRUE(apply_edits(held, edits, added).ok());
}

}  // namespace
}  // namespace curvecast::client
