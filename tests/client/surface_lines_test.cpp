#include "client/cli/surface_lines.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/render/curve_renderer.h"
#include "tests/client/strip_mesh.h"

namespace curvecast::cli {
namespace {

constexpr int kHeight = 100;
const RenderCamera kCamera{.eye = {100.5, 0.5, 3}, .target = {100.5, 0.5, 0}};

TEST(SurfaceLines, DotsLieOnTheLinesWithoutGaps) {
  const Vec3d origin(100, 0, 0);
  const LineDots dots = trace_cuts(strip(), {kCamera, kHeight, 1.5, origin});
  ASSERT_EQ(dots.positions.size(), dots.colors.size());
  for (std::size_t i = 0; i < dots.positions.size(); ++i) {
    const Vec3f& p = dots.positions[i];
    const bool on_cut = p.y() == 0 || p.y() == 1, on_border = p.x() == 0 || p.x() == 1;
    EXPECT_TRUE(on_cut || on_border);
    if (!on_border) {
      EXPECT_EQ(dots.colors[i], kCutColor);
    }
    if (!on_cut) {
      EXPECT_EQ(dots.colors[i], kBorderColor);
    }
    const double pixel = 2 * std::tan(15 * 3.14159265 / 180) * 3.2 / kHeight;
    if (i > 0 && dots.colors[i] == dots.colors[i - 1] && (p - dots.positions[i - 1]).norm() < 0.5f) {
      EXPECT_LT((p - dots.positions[i - 1]).norm(), pixel);
    }
  }
  // The side from x = 1 to 0 runs against the other one and is left out: it is drawn from the other side of the cut.
  EXPECT_TRUE(std::none_of(dots.positions.begin(), dots.positions.end(),
                           [](const Vec3f& p) { return p.y() == 1 && p.x() > 0.1f && p.x() < 0.9f; }));
}

TEST(SurfaceLines, LinesWithoutLengthAreDots) {
  client::ParameterMesh mesh = strip();
  for (auto& p : mesh.discs[0].positions) p = {1, 1, 1};
  EXPECT_EQ(trace_cuts(mesh, {kCamera, kHeight, 0}).positions.size(), 4u);
}

TEST(SurfaceLines, EdgesAreDrawnOnceAlsoAlongACut) {
  // The second disc is the first one's mirror image on the other side of x = 100: they share an edge.
  client::ParameterMesh mesh = strip();
  mesh.discs.push_back(mesh.discs[0]);
  mesh.discs[1].positions = {{100, 1, 0}, {99, 1, 0}, {99, 0, 0}, {100, 0, 0}};
  const LineDots dots = trace_edges(mesh, {kCamera, kHeight, 1.5, Vec3d(100, 0, 0)});
  // Nine edges: four horizontal ones, three vertical ones and two diagonals.
  std::multiset<std::pair<float, float>> places;
  std::size_t on_shared = 0;
  for (const Vec3f& p : dots.positions) {
    places.insert({p.x(), p.y()});
    on_shared += p.x() == 0 && p.y() > 0 && p.y() < 1;
  }
  EXPECT_GT(on_shared, 20u);
  for (const auto& place : places) {
    const bool is_corner = std::abs(place.first) == std::round(std::abs(place.first)) && (place.second == 0 || place.second == 1);
    if (!is_corner) {
      EXPECT_EQ(places.count(place), 1u) << place.first << ' ' << place.second;
    }
  }
  EXPECT_TRUE(std::all_of(dots.colors.begin(), dots.colors.end(), [](const Rgb8& c) { return c == kEdgeColor; }));
}

/// `n` vertices on a quarter of the unit circle, from x = 1 to y = 1, around `centre`.
client::CurveDisc arc(int n, const Vec3d& centre) {
  client::CurveDisc disc;
  for (int i = 0; i < n; ++i) {
    const double angle = 0.5 * 3.14159265358979 * i / (n - 1);
    const Vec3d normal(std::cos(angle), std::sin(angle), 0), p = centre + normal;
    disc.positions.push_back({static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())});
    disc.normals.push_back({static_cast<std::int16_t>(32767 * normal.x()), static_cast<std::int16_t>(32767 * normal.y()), 0});
    disc.areas.push_back(1);
    disc.cells.push_back({0, 0});
    disc.levels.push_back(0);
  }
  return disc;
}

TEST(SurfaceLines, CurvesBendWithTheSurfaceAndEndWithTheirDisc) {
  client::Curve curve;
  curve.discs = {arc(4, Vec3d(0, 0, 0)), arc(4, Vec3d(0, 0, 2))};
  curve.info.mutable_origin()->set_x(10);
  const LineView view{{.eye = {10.5, 0.5, 6}, .target = {10.5, 0.5, 0}}, kHeight, 3, Vec3d(10, 0, 0)};
  const LineDots dots = trace_curve(curve, view);
  ASSERT_EQ(dots.positions.size(), dots.colors.size());
  ASSERT_GT(dots.positions.size(), 100u);
  for (const Vec3f& p : dots.positions) {
    EXPECT_TRUE(std::abs(p.z()) < 1e-6f || std::abs(p.z() - 2) < 1e-6f);  // nothing between the discs
    // A straight line would sink to cos(15 degrees) = 0.966 of the radius.
    EXPECT_NEAR(std::hypot(p.x(), p.y()), 1, 0.004);
  }
  EXPECT_EQ(dots.colors.front(), curve_colour(0.5 / 3));
  EXPECT_EQ(dots.colors.back(), curve_colour(2.5 / 3));
  EXPECT_TRUE(trace_curve({}, view).positions.empty());
}

TEST(SurfaceLines, OfAClosedSurfaceTheFarSideIsLeftOut) {
  client::Curve curve;
  curve.discs = {arc(10, Vec3d::Zero())};
  LineView view{{.eye = {5, -5, 0}, .target = {0, 0, 0}}, kHeight, 1, Vec3d::Zero()};
  const std::size_t all = trace_curve(curve, view).positions.size();
  view.is_closed = true;
  const LineDots seen = trace_curve(curve, view);
  EXPECT_LT(seen.positions.size(), all * 2 / 3);
  ASSERT_FALSE(seen.positions.empty());
  for (const Vec3f& p : seen.positions) EXPECT_GT(p.x() * (5 - p.x()) + p.y() * (-5 - p.y()), -0.05);
}

}  // namespace
}  // namespace curvecast::cli
