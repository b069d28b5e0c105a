#include "core/progressive/rank_selection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>
#include <utility>

#include "core/base/random.h"
#include "tests/core/progressive/ranked_ball.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

using Terms = Density;

RankSelection select(const std::shared_ptr<const RankTree>& tree, const Terms& terms, std::uint64_t n,
                     const FixedDensity* density = nullptr) {
  RankSelector selector;
  RankSelection selection;
  selector.select(tree, density, ViewFactor(*ball_curve(), terms), n, selection);
  return selection;
}

/// The scale that each point of the tree with a density needs, and its rank, ascending; by looking at all points.
std::vector<std::pair<float, std::uint32_t>> needed_scales(const RankTree& tree, const Terms& terms,
                                                           const FixedDensity* density = nullptr) {
  const ViewFactor view(*ball_curve(), terms);
  std::vector<std::pair<float, std::uint32_t>> needed;
  for (const auto& chunk : tree.chunks()) {
    for (std::size_t i = 0; i < chunk->size(); ++i) {
      float factor = density == nullptr ? 1 : density->density[chunk->vertex[i]];
      if (view.is_fixed_by_detail()) factor = chunk->detail[i];
      view.multiply({&chunk->x[i], &chunk->y[i], &chunk->z[i], &chunk->nx[i], &chunk->ny[i], &chunk->nz[i]}, 1, &factor);
      if (factor > 0) needed.emplace_back(static_cast<float>(chunk->rank[i] + 1) / factor, chunk->rank[i]);
    }
  }
  std::sort(needed.begin(), needed.end());
  return needed;
}

/// The n ranks that need the least scale.
std::vector<std::uint32_t> expected_ranks(const RankTree& tree, const Terms& terms, std::uint64_t n,
                                          const FixedDensity* density = nullptr) {
  std::vector<std::pair<float, std::uint32_t>> needed = needed_scales(tree, terms, density);
  needed.resize(std::min<std::size_t>(n, needed.size()));
  std::vector<std::uint32_t> ranks;
  for (const auto& [key, rank] : needed) ranks.push_back(rank);
  std::sort(ranks.begin(), ranks.end());
  return ranks;
}

/// A density between 0 and 3 with steep slopes, and none at all on a part.
std::vector<float> some_density(std::uint64_t seed) {
  const SurfaceCurve& curve = *ball_curve();
  std::vector<float> density(curve.size());
  for (std::size_t l = 0; l < curve.size(); ++l) {
    const float value = 1 + std::sin(9 * curve.x[l]) + std::cos(7 * curve.y[l] * curve.z[l]);
    density[l] = curve.z[l] < -0.7f ? 0 : std::max(0.0f, value) * static_cast<float>(0.5 + random_unit(seed, l));
  }
  return density;
}

FixedDensity fixed(const std::vector<float>& density) {
  FixedDensity out{Column<float>(density), {}, block_mass(density, ball_curve()->area)};
  out.most.resize(block_count(density.size()));
  for (std::size_t b = 0; b < out.most.size(); ++b) {
    out.most[b] = *std::max_element(&density[b * kBlockSize], density.data() + std::min(density.size(), (b + 1) * kBlockSize));
  }
  return out;
}

Camera from(const Vec3d& eye, double fov = 0.8) {
  return {.eye = eye, .target = Vec3d::Zero(), .up = Vec3d(0.1, 1, 0.2), .fov = fov};
}

const Terms kViews[] = {{},
                        {{ViewTerm{}}, {from({0.3, 2, 2})}},
                        {{ViewTerm{.s0 = 0.01}}, {from({0, 0, 1.05})}},
                        {{ViewTerm{.s0 = 100}}, {from({3, 0, 0})}},
                        {{ViewTerm{}}, {from({3, 0, 0}), from({0, 3, 0.1})}},
                        {{ScreenTerm{}, FrustumTerm{}}, {from({0, 1, 3}, 0.1)}},
                        {{DistanceTerm{}}, {from({1.2, 0, 0})}}};

TEST(RankSelection, IsWhatLookingAtAllPointsGives) {
  const auto tree = ball_tree(8);
  const FixedDensity own = fixed(some_density(1));
  for (const Terms& terms : kViews) {
    for (const std::uint64_t n : {1u, 2u, 63u, 1000u, 4096u, 5000u, 11111u}) {
      SCOPED_TRACE(n);
      const RankSelection even = select(tree, terms, n);
      EXPECT_EQ(even.count, ranks_of(even).size());
      EXPECT_EQ(ranks_of(even), expected_ranks(*tree, terms, n));
      EXPECT_EQ(ranks_of(select(tree, terms, n, &own)), expected_ranks(*tree, terms, n, &own));
    }
  }
}

TEST(RankSelection, OfAPictureTakesTheDetailThatPointsKnow) {
  const auto tree = ball_tree(8);
  const Terms picture = {{PictureTerm{}}, {from({0.3, 2, 2})}}, painted = {{PictureTerm{}, BrushTerm{}}, picture.cameras};
  const auto detail = make_fixed_density(*ball_curve(), picture.terms);
  ASSERT_TRUE(detail.ok()) << detail.status();
  for (const std::uint64_t n : {63u, 1000u, 5000u}) {
    const std::vector<std::uint32_t> own = ranks_of(select(tree, picture, n, detail->get()));
    EXPECT_EQ(own, expected_ranks(*tree, picture, n));
    // Where other terms are fixed too, their product is what counts; here it is the same but for rounding.
    std::vector<std::uint32_t> both;
    std::ranges::set_intersection(own, ranks_of(select(tree, painted, n, detail->get())), std::back_inserter(both));
    EXPECT_GT(both.size(), n - n / 200 - 2) << n;
  }
}

TEST(RankSelection, OfAUniformDensityTheLowestRanks) {
  const RankSelection selection = select(ball_tree(7), {}, 10'000);
  const std::vector<std::uint32_t> ranks = ranks_of(selection);
  ASSERT_EQ(ranks.size(), 10'000u);
  EXPECT_EQ(ranks.back(), 9'999u);
  EXPECT_EQ(selection.scale, 10'000);
  EXPECT_TRUE(selection.lacking.empty());
}

TEST(RankSelection, WhatIsExpectedMakesNoDifference) {
  const auto tree = ball_tree(8);
  const FixedDensity own = fixed(some_density(5));
  for (const Terms& terms : kViews) {
    for (const std::uint64_t n : {std::uint64_t{1}, std::uint64_t{700}, std::uint64_t{1'000'000}}) {
      const RankSelection plain = select(tree, terms, n, &own);
      for (const double factor : {1e-300, 1e-9, 0.3, 0.96, 1.0, 1.02, 1.3, 7.0, 1e9, 1e300}) {
        RankSelector selector;
        RankSelection selection;
        selector.select(tree, &own, ViewFactor(*ball_curve(), terms), n, selection, factor * plain.similar_scale());
        EXPECT_EQ(ranks_of(selection), ranks_of(plain)) << n << " points, " << factor;
        EXPECT_EQ(selection.scale, plain.scale);
        EXPECT_EQ(selection.lacking, plain.lacking);
      }
    }
  }
}

TEST(RankSelection, OnAllCoresTheSame) {
  const auto tree = ball_tree(9);
  const FixedDensity own = fixed(some_density(6));
  RankSelector parallel(true);
  RankSelection selection;
  for (const Terms& terms : kViews) {
    for (const std::uint64_t n : {std::uint64_t{1}, std::uint64_t{20'000}, std::uint64_t{200'000}, std::uint64_t{1'000'000}}) {
      const RankSelection plain = select(tree, terms, n, &own);
      parallel.select(tree, &own, ViewFactor(*ball_curve(), terms), n, selection);
      EXPECT_EQ(selection.shown, plain.shown);
      EXPECT_EQ(selection.count, plain.count);
      EXPECT_EQ(selection.scale, plain.scale);
      EXPECT_EQ(selection.lacking, plain.lacking);
    }
  }
}

TEST(RankSelection, DoesNotDependOnWhatElseThereIsOnceNothingLacks) {
  const FixedDensity own = fixed(some_density(2));
  const auto deep = ball_tree(9);
  for (const Terms& terms : kViews) {
    const auto grower = ball_grower(6);
    RankSelection selection = select(grower->tree(), terms, 800, &own);
    for (int round = 0; round < 4 * kMaxRankLevel && !selection.lacking.empty(); ++round) {
      ASSERT_TRUE(grower->grow(selection.most_lacking(), 4'000'000).ok());
      selection = select(grower->tree(), terms, 800, &own);
    }
    ASSERT_TRUE(selection.lacking.empty());
    ASSERT_EQ(selection.count, 800u);
    const RankSelection of_more = select(deep, terms, 800, &own);
    if (!of_more.lacking.empty()) continue;  // a view so near goes deeper still
    EXPECT_EQ(ranks_of(selection), ranks_of(of_more));
  }
}

TEST(RankSelection, WhatIsUrgentSpellsLessToMake) {
  std::size_t made[2] = {0, 0};
  for (const double aside : {0.01, -0.04}) {  // a view on one spot may need all that is near
    const Terms near{{ScreenTerm{}, FrustumTerm{}},
                     {{.eye = Vec3d(0, aside, 1.02), .target = Vec3d(aside, aside, 1), .up = Vec3d(0, 1, 0)}}};
    RankSelection selection[2];
    for (const bool all : {false, true}) {
      const auto grower = ball_grower(6);
      RankSelection& here = selection[all];
      for (here = select(grower->tree(), near, 800); !here.lacking.empty(); here = select(grower->tree(), near, 800)) {
        ASSERT_GT(here.urgent, 0u);
        ASSERT_LE(here.urgent, here.lacking.size());
        ASSERT_TRUE(grower->grow(all ? std::span<const ChunkId>(here.lacking) : here.most_lacking(), 4'000'000).ok());
      }
      EXPECT_EQ(here.urgent, 0u);
      EXPECT_EQ(here.count, 800u);
      made[all] += grower->tree()->points();
    }
    EXPECT_EQ(ranks_of(selection[false]), ranks_of(selection[true]));
  }
  EXPECT_LT(made[false], made[true]);
}

/// As many points as need the scale or less.
RankSelection select_upto(const std::shared_ptr<const RankTree>& tree, const Terms& terms, float scale,
                          const FixedDensity* density) {
  const std::vector<std::pair<float, std::uint32_t>> needed = needed_scales(*tree, terms, density);
  const auto n = std::count_if(needed.begin(), needed.end(), [&](const auto& point) { return point.first <= scale; });
  return select(tree, terms, static_cast<std::uint64_t>(std::max<std::ptrdiff_t>(n, 1)), density);
}

/// The scale that the n points need which need the least.
float scale_of(const RankTree& tree, const Terms& terms, std::uint64_t n, const FixedDensity* density) {
  const std::vector<std::pair<float, std::uint32_t>> needed = needed_scales(tree, terms, density);
  return needed[std::min<std::size_t>(n, needed.size()) - 1].first;
}

TEST(RankSelection, OfAGreaterDensityShowsAllOfALesserOne) {
  const auto grower = ball_grower(8);
  std::vector<float> lesser = some_density(3), greater = lesser;
  for (std::size_t l = 0; l < greater.size(); ++l) greater[l] += static_cast<float>(random_unit(4, l) * (l % 3 == 0));
  const FixedDensity less = fixed(lesser), more = fixed(greater);
  const auto includes = [&](const RankSelection& some, const RankSelection& all) {
    const std::vector<std::uint32_t> inner = ranks_of(some), outer = ranks_of(all);
    return std::includes(outer.begin(), outer.end(), inner.begin(), inner.end());
  };
  for (const Terms& terms : kViews) {
    for (const std::uint64_t n : {30, 1000, 6000}) {
      const auto tree = grower->tree();
      const RankSelection selection = select(tree, terms, n, &less);
      ASSERT_GT(selection.count, 0u);
      const float scale = scale_of(*tree, terms, n, &less);
      // The greater one's tree has more in it.
      ASSERT_TRUE(grower->grow(std::vector<ChunkId>{{9, 5}, {9, 40}}, 4'000'000).ok());
      EXPECT_TRUE(includes(selection, select_upto(grower->tree(), terms, scale, &more))) << n;
      EXPECT_TRUE(includes(selection, select_upto(grower->tree(), terms, 1.5f * scale, &less))) << n;
    }
  }
  for (const Terms& terms : kViews) {
    const RankSelection a = select(grower->tree(), terms, 100), b = select(grower->tree(), terms, 101);
    EXPECT_TRUE(includes(a, b));
    EXPECT_EQ(b.count, a.count + 1);
  }
  // A silhouette that is more pronounced is a lesser density.
  const auto silhouette = [](double s0) { return view_from(Vec3d(2, 1, 1), s0); };
  const RankSelection pronounced = select(grower->tree(), silhouette(0.05), 2000);
  const float scale = scale_of(*grower->tree(), silhouette(0.05), 2000, nullptr);
  EXPECT_TRUE(includes(pronounced, select_upto(grower->tree(), silhouette(0.3), scale, nullptr)));
}

TEST(RankSelection, ShowsWhatThereIsWhereMoreIsAskedFor) {
  const RankSelection selection = select(ball_tree(6), {}, 50'000);
  EXPECT_EQ(selection.count, 4096u);
  EXPECT_EQ(selection.lacking.size(), 4096 / kChunkStrata * 4);
}

TEST(RankSelection, OfNothingIsEmpty) {
  const FixedDensity none = fixed(std::vector<float>(ball_curve()->size(), 0.0f));
  for (const Terms& terms : kViews) {
    const RankSelection selection = select(ball_tree(7), terms, 100, &none);
    EXPECT_EQ(selection.count, 0u);
    EXPECT_TRUE(selection.lacking.empty());
  }
  const RankSelection inside = select(ball_tree(7), view_from(Vec3d(0.2, 0.1, -0.1)), 100);
  EXPECT_EQ(inside.count, 0u);
}

TEST(RankSelection, OneSelectorServesManyViews) {
  const auto small = ball_tree(6), large = ball_tree(8);
  RankSelector selector;
  RankSelection selection;
  for (int i = 0; i < 30; ++i) {
    const Terms& terms = kViews[static_cast<std::size_t>(i) % std::size(kViews)];
    const auto& tree = i % 2 ? small : large;
    const std::uint64_t n = 1 + static_cast<std::uint64_t>(random_unit(9, i) * 3000);
    selector.select(tree, nullptr, ViewFactor(*ball_curve(), terms), n, selection);
    EXPECT_EQ(ranks_of(selection), ranks_of(select(tree, terms, n)));
  }
}

}  // namespace
}  // namespace curvecast
