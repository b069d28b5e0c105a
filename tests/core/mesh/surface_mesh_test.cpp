#include "core/mesh/surface_mesh.h"

#include <gtest/gtest.h>

#include <atomic>

#include "tests/core/remesh/remesh_cases.h"

namespace curvecast {
namespace {

using namespace curvecast::testing;

std::vector<std::uint32_t> borders_of(const TriangleMesh& mesh) {
  std::vector<std::uint32_t> borders;
  for (std::uint32_t h = 0; h < mesh.twins.size(); ++h) {
    if (mesh.twins[h] == kNone) borders.push_back(h);
  }
  return borders;
}

TEST(SurfaceMesh, HasTheNeighboursThatRepairFound) {
  auto shapes = remesh_shapes();
  // Three sheets at one edge, which repair opens: a book. And sheets that touch in a corner.
  shapes.emplace_back(
      "book", make_mesh(soup_of({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}}, {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}})));
  shapes.emplace_back("moebius strip", make_mesh(mobius_strip(20)));
  for (const auto& [name, shape] : shapes) {
    SCOPED_TRACE(name);
    const auto mesh = surface_mesh(shape, borders_of(shape));
    ASSERT_TRUE(mesh.ok()) << mesh.status();
    EXPECT_EQ(mesh->twins, shape.twins);
    EXPECT_EQ(mesh->triangles, shape.triangles);
    EXPECT_EQ(mesh->positions, shape.positions);
  }
}

TEST(SurfaceMesh, EdgesThatWereOpenedStayOpen) {
  // Two halves of a square that share their corners, with the diagonal between them open.
  TriangleMesh shape = make_mesh(square(1));
  std::fill(shape.twins.begin(), shape.twins.end(), kNone);
  const auto open = surface_mesh(shape, borders_of(shape));
  ASSERT_TRUE(open.ok()) << open.status();
  EXPECT_EQ(open->twins, shape.twins);
  // Four faces at one edge, of which two are opened: the other two find each other.
  const TriangleMesh four{{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}},
                          {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}, {1, 0, 5}},
                          {3, kNone, kNone, 0, kNone, kNone, kNone, kNone, kNone, kNone, kNone, kNone}};
  const auto found = surface_mesh(four, borders_of(four));
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_EQ(found->twins, four.twins);
}

TEST(SurfaceMesh, RefusesWhatCannotBeTold) {
  TriangleMesh four{{{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}},
                    {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}, {1, 0, 5}},
                    {3, kNone, kNone, 0, kNone, kNone, 9, kNone, kNone, 6, kNone, kNone}};
  EXPECT_EQ(surface_mesh(four, borders_of(four)).status().code(), absl::StatusCode::kFailedPrecondition);
  const std::atomic<bool> cancel = true;
  EXPECT_EQ(surface_mesh(four, {}, {.on_progress = {}, .cancel = &cancel}).status().code(), absl::StatusCode::kCancelled);
}

}  // namespace
}  // namespace curvecast
