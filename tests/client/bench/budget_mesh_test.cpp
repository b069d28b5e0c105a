#include "client/bench/picture/budget_mesh.h"

#include <gtest/gtest.h>

#include <atomic>

#include "core/mesh/repair.h"
#include "tests/support/shapes.h"

namespace curvecast::cli::bench {
namespace {

LoadedMesh bumpy_ball(bool has_colours) {
  PolygonSoup soup = testing::jittered(testing::icosphere(5), 0.01);
  if (has_colours) {
    for (const Vec3d& p : soup.positions)
      soup.attributes.colours.push_back({static_cast<std::uint8_t>(p.x() > 0 ? 255 : 0), 0, 0, 255});
  }
  absl::StatusOr<RepairedMesh> repaired = repair(std::move(soup));
  EXPECT_TRUE(repaired.ok()) << repaired.status();
  return {std::move(repaired->mesh), std::move(repaired->attributes), {}};
}

TEST(BudgetMeshes, AreAsLargeAsTheBytesAllow) {
  const ShadedMesh whole(bumpy_ball(false));
  BudgetMeshes meshes(whole);
  std::size_t fewer = 0;
  for (const std::uint64_t bytes : {2'000u, 5'000u, 20'000u}) {
    const auto mesh = meshes.of_bytes(bytes, {});
    ASSERT_TRUE(mesh.ok()) << mesh.status();
    EXPECT_LE(mesh->bytes, bytes);
    EXPECT_GT(mesh->bytes, bytes / 10 * 8);
    EXPECT_GT(mesh->smooth->mesh().face_count(), fewer);
    fewer = mesh->smooth->mesh().face_count();
    EXPECT_NEAR(surface_area(mesh->smooth->mesh()), 4 * 3.14159, 0.8);
  }
  EXPECT_LT(fewer, whole.mesh().face_count());
}

TEST(BudgetMeshes, AreWholeWhereThereAreBytesEnough) {
  const ShadedMesh whole(bumpy_ball(true));
  BudgetMeshes meshes(whole);
  const auto mesh = meshes.of_bytes(100'000'000, {});
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_EQ(mesh->smooth->mesh().face_count(), whole.mesh().face_count());
  EXPECT_TRUE(mesh->smooth->has_colours());
  EXPECT_EQ(mesh->smooth->attributes().colours.size(), whole.mesh().vertex_count());
}

TEST(BudgetMeshes, AreTheSmallestWhereNoneFits) {
  const ShadedMesh whole(bumpy_ball(false));
  const auto mesh = BudgetMeshes(whole).of_bytes(1, {});
  ASSERT_TRUE(mesh.ok()) << mesh.status();
  EXPECT_LT(mesh->smooth->mesh().face_count(), 200u);
}

TEST(BudgetMeshes, CanBeCancelled) {
  const ShadedMesh whole(bumpy_ball(false));
  const std::atomic<bool> cancel = true;
  EXPECT_TRUE(absl::IsCancelled(BudgetMeshes(whole).of_bytes(1000, {.cancel = &cancel}).status()));
}

}  // namespace
}  // namespace curvecast::cli::bench
