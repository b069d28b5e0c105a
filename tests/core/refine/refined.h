// Curves that are to be refined, for the tests of how.
#pragma once

#include <absl/status/statusor.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string_view>
#include <vector>

#include "core/curve/curve_columns.h"
#include "core/pipeline/curve_surface.h"
#include "tests/support/shapes.h"

namespace curvecast::testing {

/// A mesh with its curve and what refinement starts from.
struct Refinable {
  explicit Refinable(Preprocessed preprocessed) : done(std::move(preprocessed)), base(*curve_base(done.flattened)) {}
  Refinable(const Refinable&) = delete;

  const SurfaceCurve& curve() const { return *done.curve; }

  Preprocessed done;
  std::shared_ptr<const CurveBase> base;
};

inline std::unique_ptr<Refinable> refinable(const MeshFile& file, const PreprocessOptions& options) {
  absl::StatusOr<Preprocessed> done = preprocess(file, options);
  EXPECT_TRUE(done.ok()) << done.status();
  return done.ok() ? std::make_unique<Refinable>(*std::move(done)) : nullptr;
}

inline std::unique_ptr<Refinable> refinable(const PolygonSoup& soup, std::uint64_t points = 500) {
  const std::string off = to_off(soup);
  return refinable({"shape.off", off}, {.points = points});
}

/// Shapes of one and several discs, with cuts, with faces large and small against the leaves.
inline std::vector<std::unique_ptr<Refinable>> refinable_shapes() {
  std::vector<std::unique_ptr<Refinable>> out;
  for (const PolygonSoup& soup :
       {disc(6, 20), jittered(icosphere(3), 0.02), torus(40, 20), open_cylinder(8, 24), perforated_slab(5, 3), tetrahedron(),
        single_triangle(), merged(icosphere(2), translated(torus(12, 9), {4, 0, 0}))}) {
    out.push_back(refinable(soup));
  }
  return out;
}

/// Every point of each square lies in exactly one leaf, in curve order; areas add up; positions lie where floats can say.
inline void expect_valid_curve(const SurfaceCurve& curve) {
  double sum = 0;
  for (std::size_t d = 0; d + 1 < curve.disc_begin.size(); ++d) {
    std::uint64_t expected = 0;
    for (std::size_t l = curve.disc_begin[d]; l < curve.disc_begin[d + 1]; ++l) {
      ASSERT_EQ(curve.key[l], expected) << "leaf " << l;
      expected += std::uint64_t{1} << 2 * (kMaxLevel - curve.level[l]);
      sum += static_cast<double>(curve.area[l]);
    }
    ASSERT_EQ(expected, std::uint64_t{1} << 2 * kMaxLevel);
  }
  EXPECT_EQ(curve.disc_begin.back(), curve.size());
  EXPECT_NEAR(sum / curve.total_area, 1, 1e-6);
}

/// Columns of vertex l of `a` and m of `b`, to the bit; but for what finer curves have from coarser ones: areas, and what is
/// beside.
inline ::testing::AssertionResult same_vertex(const SurfaceCurve& a, std::size_t l, const SurfaceCurve& b, std::size_t m) {
  const auto same = [&](const auto& x, const auto& y) { return x[l] == y[m]; };
  bool all = a.scalars.size() == b.scalars.size();
  visit_column_members([&](std::string_view name, auto column, ColumnLength /*length*/) {
    if (!all || name == "area" || name == "normal beside") return;
    all = (a.*column).empty() == (b.*column).empty() && ((a.*column).empty() || same(a.*column, b.*column));
  });
  for (std::size_t s = 0; all && s < a.scalars.size(); ++s) all = same(a.scalars[s].values, b.scalars[s].values);
  if (all) return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "vertex " << l << " of one, " << m << " of the other, level " << int{a.level[l]};
}

/// Calls visit(l, m) for the vertices of two curves on the same discs that have the same key and level.
template <typename Visit>
std::size_t for_each_common(const SurfaceCurve& a, const SurfaceCurve& b, Visit&& visit) {
  std::size_t found = 0;
  for (std::size_t d = 0; d + 1 < a.disc_begin.size(); ++d) {
    std::size_t m = b.disc_begin[d];
    for (std::size_t l = a.disc_begin[d]; l < a.disc_begin[d + 1]; ++l) {
      while (m < b.disc_begin[d + 1] && b.key[m] < a.key[l]) ++m;
      if (m == b.disc_begin[d + 1]) break;
      if (b.key[m] == a.key[l] && b.level[m] == a.level[l]) {
        ++found;
        visit(l, m);
      }
    }
  }
  return found;
}

}  // namespace curvecast::testing
