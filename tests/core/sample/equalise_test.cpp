#include "core/sample/equalise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "core/base/random.h"
#include "core/sample/sequence.h"

namespace curvecast {
namespace {

constexpr std::uint32_t kUntouched = 0xdeadbeef;

struct Curve {
  std::vector<float> density, area;

  std::size_t size() const { return density.size(); }
  double mass(std::size_t l) const { return static_cast<double>(density[l]) * static_cast<double>(area[l]); }
};

/// Random densities over random areas, with runs of zeros. With `whole` all masses are small whole numbers, so that every sum is
/// exact in whatever order it is taken.
Curve random_curve(std::uint64_t seed, std::size_t n, bool whole) {
  Curve curve;
  std::uint64_t counter = 0;
  bool zero = false;
  std::size_t run = 0;
  for (std::size_t l = 0; l < n; ++l) {
    if (run-- == 0) {
      zero = random_unit(seed, counter++) < 0.4;
      run = static_cast<std::size_t>(std::exp(6 * random_unit(seed, counter++)));
    }
    const double d = random_unit(seed, counter++), a = random_unit(seed, counter++);
    curve.density.push_back(zero ? 0.0f : static_cast<float>(whole ? std::floor(8 * d) : std::exp(12 * d - 6)));
    curve.area.push_back(static_cast<float>(whole ? std::exp2(std::floor(4 * a)) : 1e-3 * (0.1 + a)));
  }
  return curve;
}

std::vector<double> sequence_of(std::size_t n, std::uint64_t seed = 1, Sequence sequence = Sequence::kJittered) {
  std::vector<double> q(n);
  fill_sequence(sequence, seed, q);
  return q;
}

/// Equalises, and returns the whole mass.
double equalise_into(std::span<const float> density, std::span<const float> area, const std::vector<double>& q,
                     std::span<std::uint32_t> vertices) {
  const BlockMass fixed = block_mass(density, area);
  ViewMass mass;
  fixed_mass(fixed, mass);
  equalise(mass, fixed, q, vertices);
  return mass.total;
}

std::vector<std::uint32_t> equalised(const Curve& curve, const std::vector<double>& q) {
  std::vector<std::uint32_t> vertices(q.size(), kUntouched);
  EXPECT_GT(equalise_into(curve.density, curve.area, q, vertices), 0);
  return vertices;
}

void expect_sound(const Curve& curve, const std::vector<std::uint32_t>& vertices) {
  ASSERT_TRUE(std::is_sorted(vertices.begin(), vertices.end()));
  for (const std::uint32_t l : vertices) {
    ASSERT_LT(l, curve.size());
    ASSERT_GT(curve.mass(l), 0) << "vertex " << l << " has no density";
  }
}

TEST(Equalise, FindsTheBlockExactlyAndTheVertexWithinACode) {
  // Around the sizes of blocks, and far from them.
  for (const std::size_t n : {1u, 2u, 5u, 15u, 16u, 17u, 31u, 32u, 33u, 64u, 1000u, 4097u}) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      Curve curve = random_curve(100 * seed + n, n, true);
      curve.density[(n - 1) * seed / 20] = 3;
      std::vector<double> cumulative(n + 1, 0.0);  // exact
      for (std::size_t l = 0; l < n; ++l) cumulative[l + 1] = cumulative[l] + curve.mass(l);
      for (const std::size_t points : {1u, 2u, 17u, 300u, 5000u}) {
        const std::vector<double> q = sequence_of(points, seed);
        std::vector<std::uint32_t> vertices(points, kUntouched);
        ASSERT_EQ(equalise_into(curve.density, curve.area, q, vertices), cumulative[n]);
        expect_sound(curve, vertices);
        for (std::size_t i = 0; i < points; ++i) {
          const double wanted = q[i] * cumulative[n];
          const std::size_t v = vertices[i], begin = v / kBlockSize * kBlockSize, end = std::min(begin + kBlockSize, n);
          ASSERT_LE(cumulative[begin], wanted);
          ASSERT_GT(cumulative[end], wanted);
          const double code = 1.01 * (cumulative[end] - cumulative[begin]) / MassCodes::kWhole;
          ASSERT_LE(cumulative[v], wanted + code) << n << " vertices, " << points << " points, seed " << seed;
          ASSERT_GT(cumulative[v + 1], wanted - code) << n << " vertices, " << points << " points, seed " << seed;
        }
      }
    }
  }
}

/// The plainest way there is: block by block, point by point.
std::vector<std::uint32_t> merged(const Curve& curve, const std::vector<double>& q) {
  const BlockMass mass = block_mass(curve.density, curve.area);
  std::vector<std::uint32_t> vertices;
  double before = 0;
  for (std::size_t b = 0; b < mass.sum.size(); ++b) {
    const double sum = static_cast<double>(mass.sum[b]);
    while (vertices.size() < q.size() && q[vertices.size()] * mass.total < before + sum) {
      const auto part = static_cast<float>((q[vertices.size()] * mass.total - before) / sum);
      const std::size_t within = mass.codes[b].vertex(MassCodes::part(std::min(part, 0x1.fffffep-1f)));
      vertices.push_back(static_cast<std::uint32_t>(b * kBlockSize + within));
    }
    before += sum;
  }
  return vertices;
}

TEST(Equalise, IsThePlainMergeForAnySequence) {
  // From many points for each block to many blocks for each point, and more blocks than are done in one go.
  EqualiseScratch scratch;
  for (const std::size_t n : {40u, 3000u, 30'000u}) {
    for (const Sequence sequence : {Sequence::kJittered, Sequence::kRegular, Sequence::kVanDerCorput, Sequence::kGoldenRatio}) {
      for (const std::size_t points : {1u, 5u, 257u, 2000u, 50'000u}) {
        Curve curve = random_curve(n + points, n, points % 2 == 0);
        curve.density[n / 2] = 1;
        const std::vector<double> q = sequence_of(points, n, sequence);
        const BlockMass fixed = block_mass(curve.density, curve.area);
        ViewMass mass;
        fixed_mass(fixed, mass);
        std::vector<std::uint32_t> vertices(points, kUntouched);
        equalise(mass, fixed, q, vertices, scratch);
        ASSERT_EQ(vertices, merged(curve, q)) << n << " vertices, " << points << " points";
      }
    }
  }
}

TEST(Equalise, TakesAnyAscendingNumbers) {
  const Curve curve = random_curve(3, 20'000, false);
  for (const double exponent : {0.1, 0.5, 3.0, 30.0}) {  // nearly all at one end
    std::vector<double> q = sequence_of(5000);
    for (double& to : q) to = std::pow(to, exponent);
    EXPECT_EQ(equalised(curve, q), merged(curve, q));
  }
}

TEST(Equalise, InvertsTheCumulativeDensityWithinRounding) {
  for (const std::size_t n : {100u, 1000u, 50'000u}) {
    for (std::uint64_t seed = 0; seed < 5; ++seed) {
      Curve curve = random_curve(seed, n, false);
      curve.density[n / 2] = 1;
      std::vector<long double> cumulative(n + 1, 0);
      for (std::size_t l = 0; l < n; ++l) cumulative[l + 1] = cumulative[l] + curve.mass(l);
      const long double total = cumulative[n];
      for (const std::size_t points : {1u, 100u, 20'000u}) {
        const std::vector<double> q = sequence_of(points, seed);
        const std::vector<std::uint32_t> vertices = equalised(curve, q);
        expect_sound(curve, vertices);
        for (std::size_t i = 0; i < points; ++i) {
          // Masses are rounded to floats, and places in a block to its codes.
          const std::size_t begin = vertices[i] / kBlockSize * kBlockSize, end = std::min(begin + kBlockSize, n);
          const long double slack = 1e-6L * total + (cumulative[end] - cumulative[begin]) / MassCodes::kWhole;
          ASSERT_LE(cumulative[vertices[i]], q[i] * total + slack) << "point " << i;
          ASSERT_GE(cumulative[vertices[i] + 1], q[i] * total - slack) << "point " << i;
        }
      }
    }
  }
}

TEST(Equalise, GivesEveryIntervalItsShareOfThePoints) {
  // One point per stratum: any stretch of the curve gets its share of the points but for less than one at either end.
  const std::size_t n = 20'000;
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    const Curve curve = random_curve(seed, n, false);
    double total = 0;
    for (std::size_t l = 0; l < n; ++l) total += curve.mass(l);
    for (const std::size_t points : {10u, 3000u, 100'000u}) {
      std::vector<int> count(n, 0);
      for (const std::uint32_t l : equalised(curve, sequence_of(points, seed))) ++count[l];
      double excess = 0, least = 0, most = 0;  // points minus share, over all stretches that start with the curve
      for (std::size_t l = 0; l < n; ++l) {
        excess += count[l] - static_cast<double>(points) * curve.mass(l) / total;
        least = std::min(least, excess);
        most = std::max(most, excess);
      }
      const double rounding = 1e-4 * static_cast<double>(points);  // a code of a block, at most
      EXPECT_GT(least, -1 - rounding);
      EXPECT_LT(most, 1 + rounding);
    }
  }
}

TEST(Equalise, PutsAllPointsWhereAllMassIs) {
  const std::size_t n = 1000;
  for (const std::size_t only : {0u, 1u, 63u, 64u, 500u, 998u, 999u}) {
    Curve curve{std::vector<float>(n, 0.0f), std::vector<float>(n, 1.0f)};
    curve.density[only] = 1e-20f;
    EXPECT_EQ(equalised(curve, sequence_of(777)), std::vector<std::uint32_t>(777, static_cast<std::uint32_t>(only)));
  }
}

TEST(Equalise, SkipsVerticesWithoutArea) {
  Curve curve{std::vector<float>(300, 1.0f), std::vector<float>(300, 1.0f)};
  for (std::size_t l = 0; l < 300; l += 2) curve.area[l] = 0;
  const std::vector<std::uint32_t> vertices = equalised(curve, sequence_of(150));
  expect_sound(curve, vertices);
  EXPECT_EQ(vertices.front(), 1u);
  EXPECT_EQ(vertices.back(), 299u);
}

TEST(Equalise, ServesTheEndsOfTheUnitInterval) {
  const std::size_t n = 200;
  for (const std::size_t zeros : {0u, 1u, 100u}) {  // at both ends
    Curve curve{std::vector<float>(n, 0.3f), std::vector<float>(n, 0.7f)};
    for (std::size_t l = 0; l < zeros && 2 * zeros <= n; ++l) curve.density[l] = curve.density[n - 1 - l] = 0;
    if (zeros == 100) curve.density[77] = 1;
    const std::vector<std::uint32_t> vertices = equalised(curve, {0, 1 - 0x1p-53});
    EXPECT_EQ(vertices[0], zeros == 100 ? 77 : zeros);
    EXPECT_EQ(vertices[1], zeros == 100 ? 77 : n - 1 - zeros);
  }
}

TEST(Equalise, MovesOnWhereTheSumIsReachedExactly) {
  const std::size_t n = 256;
  const Curve curve{std::vector<float>(n, 1.0f), std::vector<float>(n, 1.0f)};
  std::vector<double> q;
  std::vector<std::uint32_t> expected;
  for (std::uint32_t l = 0; l < n; ++l) {
    q.push_back(l / 256.0);
    expected.push_back(l);
  }
  EXPECT_EQ(equalised(curve, q), expected);
}

TEST(Equalise, EndsAtTheLastVertexWithDensityHoweverSumsAreRounded) {
  for (std::uint64_t seed = 0; seed < 2000; ++seed) {
    const std::size_t n = 70 + seed % 120;
    const std::size_t end = n - 1 - seed % 7;  // nothing from here on
    Curve curve;
    for (std::size_t l = 0; l < n; ++l) {
      curve.density.push_back(l < end ? static_cast<float>(0.1 + random_unit(seed, 2 * l)) : 0.0f);
      curve.area.push_back(static_cast<float>(0.1 + random_unit(seed, 2 * l + 1)));
    }
    ASSERT_EQ(equalised(curve, {1 - 0x1p-53})[0], end - 1) << "seed " << seed;
  }
}

TEST(Equalise, StandsMassesOfVeryDifferentSizes) {
  // After the large masses the small ones vanish in the sum, alone or a block at a time.
  for (const std::size_t large : {0u, 100u, 499u}) {
    Curve curve{std::vector<float>(500, 1e-25f), std::vector<float>(500, 1.0f)};
    curve.density[large] = 1e25f;
    const std::vector<std::uint32_t> vertices = equalised(curve, sequence_of(1000));
    expect_sound(curve, vertices);
    EXPECT_EQ(vertices, std::vector<std::uint32_t>(1000, static_cast<std::uint32_t>(large)));
  }
}

TEST(Equalise, LeavesVerticesAloneWithoutAMass) {
  std::vector<std::uint32_t> vertices(10, kUntouched);
  const std::vector<double> q = sequence_of(10);
  const std::vector<float> zeros(500, 0.0f), ones(500, 1.0f);
  EXPECT_EQ(equalise_into(zeros, ones, q, vertices), 0);
  EXPECT_EQ(equalise_into(ones, zeros, q, vertices), 0);
  EXPECT_EQ(equalise_into({}, {}, q, vertices), 0);
  std::vector<float> wild = ones;
  wild[123] = std::numeric_limits<float>::infinity();
  EXPECT_FALSE(std::isfinite(equalise_into(wild, ones, q, vertices)));
  wild[123] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_FALSE(std::isfinite(equalise_into(wild, ones, q, vertices)));
  EXPECT_EQ(vertices, std::vector<std::uint32_t>(10, kUntouched));
}

}  // namespace
}  // namespace curvecast
