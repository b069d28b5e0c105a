#include "core/remesh/chart_borders.h"

#include <gtest/gtest.h>

#include "core/flatten/flatten.h"
#include "tests/core/remesh/remesh_cases.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

TEST(ChartBorders, RunAlongEveryCutTwiceAndEveryBorderOnce) {
  for (const auto& [name, shape] : remesh_shapes()) {
    SCOPED_TRACE(name);
    FlattenTimes times;
    const auto charts = flatten(shape, {.most_whole_faces = 2'000, .chart_faces = 1'000}, {}, times);
    ASSERT_TRUE(charts.ok()) << charts.status();
    std::vector<std::vector<BorderPiece>> borders;
    for (const Chart& chart : *charts) {
      const std::vector<BorderPiece>& border = borders.emplace_back(chart_border(shape, chart));
      EXPECT_EQ(border.size(), chart.disc.border.size());
      for (std::size_t i = 0; i < border.size(); ++i) {
        const BorderPiece &piece = border[i], &next = border[(i + 1) % border.size()];
        EXPECT_EQ(chart.disc.to(piece.halfedge), chart.disc.from(next.halfedge));
        EXPECT_LT(piece.first, piece.last);
        // It lies where it says.
        const Vec3d &a = shape.positions[shape.from(piece.edge)], &b = shape.positions[shape.to(piece.edge)];
        EXPECT_LT((a + piece.first * (b - a) - chart.disc.positions[chart.disc.from(piece.halfedge)]).norm(), 1e-12);
        EXPECT_LT((a + piece.last * (b - a) - chart.disc.positions[chart.disc.to(piece.halfedge)]).norm(), 1e-12);
      }
    }
    std::vector<double> covered(shape.twins.size(), 0);
    for (const std::vector<BorderPiece>& border : borders) {
      for (const BorderPiece& piece : border) covered[piece.edge] += piece.last - piece.first;
    }
    const std::vector<bool> is_cut = cut_edges(shape, borders);
    for (std::uint32_t h = 0; h < shape.twins.size(); ++h) {
      EXPECT_NEAR(covered[h], is_cut[h] || shape.twins[h] == kNone ? 1 : 0, 1e-12);
      if (shape.twins[h] == kNone) {
        EXPECT_FALSE(is_cut[h]);
      } else {
        EXPECT_EQ(is_cut[h], is_cut[shape.twins[h]]);
      }
    }
  }
}

}  // namespace
}  // namespace curvecast
