// remesh() takes no more memory than it asks for.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <vector>

#include "core/remesh/remesh.h"
#include "tests/core/remesh/remesh_cases.h"
#include "tests/support/counted_memory.h"
#include "tests/support/counting_source.h"

namespace curvecast {
namespace {

TEST(RemeshMemory, IsNoMoreThanIsAskedFor) {
  const TriangleMesh ball = testing::make_mesh(testing::icosphere(6)), little = testing::make_mesh(testing::icosphere(2));
  for (const auto& [shape, n] : {std::pair(&ball, 1'000u), std::pair(&ball, 100'000u), std::pair(&little, 200'000u)}) {
    for (const RemeshOptions& options : {RemeshOptions(), RemeshOptions{.fit = true, .feature_degrees = 30}}) {
      const std::vector<FacePlace> places = testing::random_places(*shape, n);
      testing::CountingSource source;
      const testing::CountedMemory memory;
      ASSERT_TRUE(remesh(*shape, places, options, {.threads = 2, .memory = &source}).ok());
      const auto peak = static_cast<double>(memory.peak()), told = static_cast<double>(source.peak());
      std::printf("%zu faces, %u points: took %.1f MB, told %.1f MB, %.2f times\n", shape->face_count(), n, peak / 1e6,
                  told / 1e6, told / peak);
      EXPECT_LE(peak, told);
      EXPECT_LE(told, 4 * peak + (1 << 20));
    }
  }
}

TEST(RemeshMemory, ThatIsNotThereIsRefused) {
  const TriangleMesh ball = testing::make_mesh(testing::icosphere(2));
  testing::CountingSource source(1'000);
  const absl::Status refused = remesh(ball, testing::random_places(ball, 100), {}, {.memory = &source}).status();
  EXPECT_EQ(refused.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_NE(refused.message().find("a mesh of 100 points on 320 triangles takes"), std::string::npos) << refused;
}

}  // namespace
}  // namespace curvecast
