#include "client/lib/neighbours.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <string>

#include "client/lib/client.h"
#include "tests/client/fake_connection.h"
#include "tests/client/sphere_points.h"

namespace curvecast::client {
namespace {

using ::testing::_;
using ::testing::ElementsAre;
using ::testing::Return;

using Responses = std::vector<v1::FindNeighboursResponse>;

template <typename T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

v1::FindNeighboursRequest request(std::uint64_t points, std::uint32_t count) {
  v1::FindNeighboursRequest request;
  request.mutable_sample()->set_points(points);
  request.set_count(count);
  return request;
}

/// Of three points in two blocks, their two neighbours each in two chunks, the first of which ends within a list.
Responses responses() {
  Responses all(4);
  *all[0].mutable_points()->mutable_points() = raw_block(sphere_points(2));
  *all[1].mutable_points()->mutable_points() = raw_block(sphere_points(1));
  all[1].mutable_points()->mutable_statistics()->set_curve_vertices(99);
  all[2].mutable_neighbours()->set_counts(bytes_of<std::uint32_t>({2, 2}));
  all[2].mutable_neighbours()->set_indices(bytes_of<std::uint32_t>({2, 1, 0}));
  all[2].mutable_neighbours()->set_distances(bytes_of<float>({0, 1, 1}));
  all[3].mutable_neighbours()->set_counts(bytes_of<std::uint32_t>({2}));
  all[3].mutable_neighbours()->set_indices(bytes_of<std::uint32_t>({2, 0, 1}));
  all[3].mutable_neighbours()->set_distances(bytes_of<float>({1.5F, 0, 1.5F}));
  return all;
}

TEST(Neighbours, AreJoined) {
  for (const std::uint32_t count : {2u, 8u}) {  // there are not so many
    const auto found = decode_neighbours(responses(), request(3, count));
    ASSERT_TRUE(found.ok()) << found.status();
    EXPECT_EQ(found->points.size(), 3u);
    EXPECT_EQ(found->statistics.curve_vertices(), 99u);
    EXPECT_THAT(found->begins, ElementsAre(0, 2, 4, 6));
    EXPECT_THAT(found->of(0), ElementsAre(2, 1));
    EXPECT_THAT(found->of(1), ElementsAre(0, 2));
    EXPECT_THAT(found->of(2), ElementsAre(0, 1));
    EXPECT_THAT(found->distances, ElementsAre(0, 1, 1, 1.5F, 0, 1.5F));
  }
}

TEST(Neighbours, WithinARadiusAreAsManyAsThereAre) {
  Responses all = responses();
  v1::FindNeighboursRequest wanted = request(3, 1);
  wanted.set_radius(2);
  all[2].mutable_neighbours()->set_counts(bytes_of<std::uint32_t>({0, 5}));
  all[3].mutable_neighbours()->set_counts(bytes_of<std::uint32_t>({1}));
  all[2].mutable_neighbours()->set_indices(bytes_of<std::uint32_t>({0, 2, 0}));
  const auto found = decode_neighbours(all, wanted);
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_TRUE(found->of(0).empty());
  EXPECT_EQ(found->of(1).size(), 5u);
  EXPECT_THAT(found->of(2), ElementsAre(1));
}

TEST(Neighbours, RefuseWhatMakesNoSense) {
  const std::vector<std::function<void(Responses&)>> spoilers = {
      [](auto& all) { all.clear(); },
      [](auto& all) { all.erase(all.begin()); },
      [](auto& all) { all.pop_back(); },
      [](auto& all) { all[0].mutable_points()->mutable_points()->set_count(7); },
      [](auto& all) { *all[0].mutable_points()->mutable_points() = raw_block(sphere_points(3)); },
      [](auto& all) { all[2].mutable_neighbours()->mutable_counts()->pop_back(); },
      [](auto& all) { all[2].mutable_neighbours()->mutable_indices()->pop_back(); },
      [](auto& all) { all[2].mutable_neighbours()->mutable_distances()->resize(8); },
      [](auto& all) { all[3].mutable_neighbours()->set_counts(bytes_of<std::uint32_t>({1})); },
      [](auto& all) { all[3].mutable_neighbours()->set_counts(bytes_of<std::uint32_t>({~0u})); },
      [](auto& all) {
        all[2].mutable_neighbours()->set_counts(bytes_of<std::uint32_t>({1, 3}));
      },
      [](auto& all) {
        all[3].mutable_neighbours()->set_indices(bytes_of<std::uint32_t>({2, 0, 3}));
      },
      [](auto& all) {
        all[3].mutable_neighbours()->set_indices(bytes_of<std::uint32_t>({2, 0, 2}));
      },
      [](auto& all) {
        all[3].mutable_neighbours()->set_distances(bytes_of<float>({1, 0, NAN}));
      },
      [](auto& all) {
        all[3].mutable_neighbours()->set_distances(bytes_of<float>({1, 0, -1}));
      },
  };
  for (std::size_t i = 0; i < spoilers.size(); ++i) {
    Responses all = responses();
    spoilers[i](all);
    EXPECT_EQ(decode_neighbours(all, request(3, 2)).status().code(), absl::StatusCode::kDataLoss) << i;
  }
  EXPECT_EQ(decode_neighbours(responses(), request(3, 1)).status().code(), absl::StatusCode::kDataLoss);
  EXPECT_EQ(decode_neighbours(responses(), request(2, 2)).status().code(), absl::StatusCode::kDataLoss);
  EXPECT_EQ(decode_neighbours(responses(), request(4, 2)).status().code(), absl::StatusCode::kDataLoss);
}

TEST(Neighbours, ClientsAskForThem) {
  const auto connection = std::make_shared<FakeConnection>();
  EXPECT_CALL(*connection, find_neighbours(_, _, _)).WillOnce(Return(responses()));
  const auto found = Client(connection).find_neighbours(request(3, 2));
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_EQ(found->indices.size(), 6u);
}

}  // namespace
}  // namespace curvecast::client
