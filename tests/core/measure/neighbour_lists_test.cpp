#include "core/measure/neighbour_lists.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <tuple>

#include "core/base/random.h"

namespace curvecast {
namespace {

using Points = std::vector<Vec3f>;

/// Places in a cube, of which some coincide.
Points noise(std::size_t n) {
  Points points;
  for (std::size_t i = 0; i < n; ++i) {
    const auto coordinate = [i](std::uint64_t axis) { return static_cast<float>(random_unit(4, 3 * i + axis)); };
    points.push_back(i % 50 == 49 ? points[i / 2] : Vec3f(coordinate(0), coordinate(1), coordinate(2)));
  }
  return points;
}

/// All others of every point, nearest first.
std::vector<std::vector<Neighbour>> by_brute_force(const Points& points) {
  std::vector<std::vector<Neighbour>> all(points.size());
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    for (std::uint32_t j = 0; j < points.size(); ++j) {
      const Vec3f d = points[j] - points[i];
      if (i != j) all[i].push_back({j, d.x() * d.x() + d.y() * d.y() + d.z() * d.z()});
    }
    std::sort(all[i].begin(), all[i].end(),
              [](const Neighbour& a, const Neighbour& b) { return std::tie(a.square, a.index) < std::tie(b.square, b.index); });
  }
  return all;
}

/// Puts what is handed over together again.
class Joined {
 public:
  TakeNeighbourLists taker() {
    return [this](const NeighbourLists& some) {
      auto next = some.neighbours.begin();
      for (const std::uint32_t length : some.lengths) {
        lists.emplace_back(next, next + length);
        next += length;
      }
      EXPECT_EQ(next, some.neighbours.end());
      return true;
    };
  }
  std::uint64_t total() const {
    std::uint64_t sum = 0;
    for (const auto& list : lists) sum += list.size();
    return sum;
  }

  std::vector<std::vector<Neighbour>> lists;
};

TEST(NeighbourLists, TheNearestAreThoseOfBruteForce) {
  for (const std::size_t n : {0, 1, 2, 63, 64, 65, 1000}) {
    const Points points = noise(n);
    const NeighbourTree tree(points);
    const auto truth = by_brute_force(points);
    for (const std::size_t k : {1, 8, 70}) {
      Joined joined;
      ASSERT_TRUE(list_nearest(tree, k, {}, joined.taker()).ok());
      ASSERT_EQ(joined.lists.size(), n);
      for (std::size_t i = 0; i < n; ++i) {
        const auto end = truth[i].begin() + static_cast<std::ptrdiff_t>(std::min(k, truth[i].size()));
        ASSERT_EQ(joined.lists[i], std::vector<Neighbour>(truth[i].begin(), end)) << n << " points, neighbours of " << i;
      }
    }
  }
}

TEST(NeighbourLists, ThoseWithinADistanceAreThoseOfBruteForce) {
  const Points points = noise(1500);
  const NeighbourTree tree(points);
  auto truth = by_brute_force(points);
  for (const float square : {0.0f, truth[7][3].square, 0.01f, 100.0f}) {
    std::uint64_t total = 0;
    std::vector<std::vector<Neighbour>> wanted;
    for (const auto& all : truth) {
      std::vector<Neighbour>& list = wanted.emplace_back();
      std::copy_if(all.begin(), all.end(), std::back_inserter(list), [&](const Neighbour& n) { return n.square <= square; });
      std::sort(list.begin(), list.end(), [](const Neighbour& a, const Neighbour& b) { return a.index < b.index; });
      total += list.size();
    }
    ASSERT_GT(total, 0u);
    Joined joined;
    ASSERT_TRUE(list_within(tree, square, total, {}, joined.taker()).ok());
    EXPECT_EQ(joined.lists, wanted);
    Joined cut;
    const absl::Status status = list_within(tree, square, total - 1, {}, cut.taker());
    EXPECT_TRUE(absl::IsOutOfRange(status));
    EXPECT_NE(status.message().find(std::to_string(total - 1)), std::string::npos);
    EXPECT_LT(cut.total(), total);
  }
}

TEST(NeighbourLists, TooManyAreKnownFromFew) {
  const NeighbourTree tree(Points(20'000, Vec3f(1, 2, 3)));  // 400 million pairs
  std::size_t taken = 0;
  const auto take = [&](const NeighbourLists& lists) {
    taken += lists.neighbours.size();
    return true;
  };
  EXPECT_TRUE(absl::IsOutOfRange(list_within(tree, 1, 10'000, {}, take)));
  EXPECT_EQ(taken, 0u);
}

TEST(NeighbourLists, AreTheSameForAnyNumberOfThreads) {
  const NeighbourTree tree(noise(20'000));
  Joined nearest[2], within[2];
  for (int run = 0; run < 2; ++run) {
    tbb::task_arena(run == 0 ? 1 : 4).execute([&] {
      EXPECT_TRUE(list_nearest(tree, 5, {}, nearest[run].taker()).ok());
      EXPECT_TRUE(list_within(tree, 0.001f, 10'000'000, {}, within[run].taker()).ok());
    });
  }
  EXPECT_EQ(nearest[0].lists, nearest[1].lists);
  EXPECT_EQ(within[0].lists, within[1].lists);
}

TEST(NeighbourLists, EndWhenNobodyWantsMore) {
  const NeighbourTree tree(noise(50'000));
  std::atomic<bool> cancel = false;
  ExecutionContext context{.cancel = &cancel};
  std::size_t taken = 0;
  const auto stop_at = [&](std::size_t most, bool answer) {
    taken = 0;
    return [&, most, answer](const NeighbourLists& lists) {
      taken += lists.lengths.size();
      if (taken < most) return true;
      cancel = answer;
      return answer;
    };
  };
  EXPECT_TRUE(absl::IsCancelled(list_nearest(tree, 4, context, stop_at(1000, false))));
  EXPECT_LT(taken, 2000u) << "refused";
  EXPECT_TRUE(absl::IsCancelled(list_nearest(tree, 4, context, stop_at(1000, true))));
  EXPECT_LT(taken, 10'000u) << "cancelled: what was made is handed over";
  EXPECT_TRUE(absl::IsCancelled(list_within(tree, 0.01f, 1'000'000, context, stop_at(1, true)))) << "from the beginning";
  EXPECT_EQ(taken, 0u);
}

TEST(NeighbourLists, TellHowFarTheyAre) {
  const NeighbourTree tree(noise(10'000));
  std::vector<double> fractions;
  ExecutionContext context;
  context.on_progress = [&](std::string_view stage, double fraction) {
    EXPECT_EQ(stage, "neighbours");
    fractions.push_back(fraction);
  };
  ASSERT_TRUE(list_nearest(tree, 1, context, [](const NeighbourLists&) { return true; }).ok());
  EXPECT_GT(fractions.size(), 1u);
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_EQ(fractions.back(), 1);
}

}  // namespace
}  // namespace curvecast
