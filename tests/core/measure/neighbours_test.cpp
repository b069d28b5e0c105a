#include "core/measure/neighbours.h"

#include <gtest/gtest.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <iterator>
#include <tuple>

#include "core/base/random.h"
#include "core/pipeline/pipeline.h"
#include "tests/support/shapes.h"

namespace curvecast {
namespace {

using Points = std::vector<Vec3f>;

/// Every point as a neighbour of the query, in the order of answers.
std::vector<Neighbour> by_brute_force(const Points& points, const Vec3f& query, std::uint32_t but = Neighbour::kNobody) {
  std::vector<Neighbour> all;
  for (std::uint32_t i = 0; i < points.size(); ++i) {
    const Vec3f d = points[i] - query;
    const float square = d.x() * d.x() + d.y() * d.y() + d.z() * d.z();
    if (i != but) all.push_back({i, square});
  }
  std::sort(all.begin(), all.end(),
            [](const Neighbour& a, const Neighbour& b) { return std::tie(a.square, a.index) < std::tie(b.square, b.index); });
  return all;
}

void expect_same(std::span<const Neighbour> found, const std::vector<Neighbour>& truth, const std::string& where) {
  for (std::size_t j = 0; j < found.size(); ++j) {
    const Neighbour wanted = j < truth.size() ? truth[j] : Neighbour{};
    ASSERT_EQ(found[j].index, wanted.index) << where << ", neighbour " << j;
    ASSERT_EQ(found[j].square, wanted.square) << where << ", neighbour " << j;
  }
}

float unit(std::uint64_t seed, std::uint64_t i) { return static_cast<float>(random_unit(seed, i)); }

Points noise(std::size_t n, std::uint64_t seed, float scale = 1) {
  Points points;
  for (std::size_t i = 0; i < n; ++i) {
    points.push_back(scale * Vec3f(unit(seed, 3 * i), unit(seed, 3 * i + 1), unit(seed, 3 * i + 2)));
  }
  return points;
}

/// Asks everything of the tree that can be asked, near and far.
void expect_exact(const Points& points, const std::string& where) {
  const NeighbourTree tree(points);
  ASSERT_EQ(tree.points().size(), points.size());
  Points queries = noise(20, 7, 3);
  for (std::size_t i = 0; i < points.size(); i += 1 + points.size() / 30) queries.push_back(points[i]);
  for (const std::size_t k : {1, 2, 8, 16, 17, 70}) {
    std::vector<Neighbour> found(k);
    for (const Vec3f& query : queries) {
      const std::vector<Neighbour> truth = by_brute_force(points, query);
      EXPECT_EQ(tree.nearest(query, found), std::min(k, truth.size()));
      expect_same(found, truth, where);
    }
    std::vector<Neighbour> all(k * points.size());
    tree.all_nearest(k, all);
    for (std::uint32_t i = 0; i < points.size(); i += 1 + static_cast<std::uint32_t>(points.size() / 200)) {
      const std::vector<Neighbour> truth = by_brute_force(points, points[i], i);
      expect_same(std::span(all).subspan(i * k, k), truth, where + ", all of " + std::to_string(i));
    }
  }
}

TEST(Neighbours, WithinADistanceAreThoseOfBruteForce) {
  const Points points = noise(2000, 3);
  const NeighbourTree tree(points);
  std::vector<Neighbour> found;
  for (const Vec3f& query : noise(30, 8, 1.5f)) {
    std::vector<Neighbour> truth = by_brute_force(points, query);
    for (const float square : {0.0f, 1e-3f, truth[40].square, 0.3f, 100.0f}) {
      tree.within(query, square, found);
      std::vector<Neighbour> wanted;
      std::copy_if(truth.begin(), truth.end(), std::back_inserter(wanted),
                   [&](const Neighbour& n) { return n.square <= square; });
      std::sort(wanted.begin(), wanted.end(), [](const Neighbour& a, const Neighbour& b) { return a.index < b.index; });
      EXPECT_EQ(found, wanted);
    }
  }
  tree.within(Vec3f::Zero(), 100, found, 70);
  EXPECT_EQ(found.size(), 71u) << "one more than wanted tells that there are too many";
  NeighbourTree({}).within(Vec3f::Zero(), 1, found);
  EXPECT_TRUE(found.empty());
}

TEST(Neighbours, AreNotLookedForOnceNobodyWantsThem) {
  std::atomic<bool> cancel = false;
  const Points points = noise(3000, 6);
  const absl::StatusOr<NeighbourTree> built = NeighbourTree::build(points, {.cancel = &cancel});
  ASSERT_TRUE(built.ok()) << built.status();
  cancel = true;
  std::vector<Neighbour> found(9), truth(9);
  EXPECT_EQ(built->nearest(points[5], found), 9u) << "a tree that is there answers";
  NeighbourTree(points).nearest(points[5], truth);
  EXPECT_EQ(found, truth);
  EXPECT_TRUE(absl::IsCancelled(NeighbourTree::build(points, {.cancel = &cancel}).status()));
}

/// Curve vertices of a mesh, disc after disc.
Points curve_of(const PolygonSoup& soup, std::uint64_t points) {
  const absl::StatusOr<Preprocessed> result = preprocess({"shape.off", testing::to_off(soup)}, {.points = points});
  EXPECT_TRUE(result.ok()) << result.status();
  Points curve;
  for (std::size_t l = 0; l < result->curve->size(); ++l) curve.push_back(result->curve->position(l));
  return curve;
}

TEST(Neighbours, AreThoseOfBruteForceOnCurves) {
  using namespace testing;
  // Closed surfaces are cut open: both sides of a cut lie far apart on the curve and at one place in space.
  for (const PolygonSoup& soup :
       {sphere(12, 18), torus(16, 10), disc(6, 20), merged(cube(), translated(cube(), {0.5, 0.2, 1}))}) {
    expect_exact(curve_of(soup, 100), "curve");
  }
}

TEST(Neighbours, AreThoseOfBruteForceOnManySmallPieces) {
  PolygonSoup soup;
  for (int i = 0; i < 30; ++i) {
    const PolygonSoup part = testing::translated(testing::scaled(testing::tetrahedron(), 0.1),
                                                 {unit(5, 3 * i), unit(5, 3 * i + 1), unit(5, 3 * i + 2)});
    soup = i == 0 ? part : testing::merged(soup, part);
  }
  expect_exact(curve_of(soup, 150), "pieces");
}

TEST(Neighbours, NeedNoOrderToBeRight) {
  for (const std::size_t n : {1, 2, 15, 16, 17, 128, 129, 1000, 1025}) {
    expect_exact(noise(n, n), std::to_string(n) + " points without order");
  }
}

TEST(Neighbours, AtTheSamePlaceComeInTheOrderOfTheirIndices) {
  Points points(100, Vec3f(1, 2, 3));
  expect_exact(points, "all at one place");
  for (std::size_t i = 0; i < points.size(); ++i) points[i] = Vec3f(static_cast<float>(i % 5), static_cast<float>(i % 3), 0);
  expect_exact(points, "lattice");
}

TEST(Neighbours, WithoutPointsOrWishesAreNone) {
  const NeighbourTree empty(Points{});
  std::vector<Neighbour> found = {{1, 2}, {3, 4}};
  EXPECT_EQ(empty.nearest({0, 0, 0}, found), 0u);
  EXPECT_EQ(found, std::vector<Neighbour>(2));
  empty.all_nearest(3, {});
  const NeighbourTree tree(Points{{1, 1, 1}});
  EXPECT_EQ(tree.nearest({0, 0, 0}, {}), 0u);
  tree.all_nearest(0, {});
}

TEST(Neighbours, AreTheSameForAnyNumberOfThreads) {
  const Points points = noise(5000, 2);
  std::vector<Neighbour> answers[2];
  for (int run = 0; run < 2; ++run) {
    answers[run].resize(5 * points.size());
    tbb::task_arena(run == 0 ? 1 : 4).execute([&] { NeighbourTree(points).all_nearest(5, answers[run]); });
  }
  EXPECT_EQ(answers[0], answers[1]);
}

}  // namespace
}  // namespace curvecast
