// remesh() takes no more memory than it asks for.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "core/base/memory_claim.h"
#include "core/remesh/remesh.h"
#include "tests/core/remesh/remesh_cases.h"
#include "tests/support/counted_memory.h"

namespace curvecast {
namespace {

/// Remembers the most that was taken at once.
class Source final : public MemorySource {
 public:
  explicit Source(std::uint64_t most) : most_(most) {}
  absl::Status take(std::uint64_t bytes, const std::string& what) override {
    if (taken_ + bytes > most_) return absl::ResourceExhaustedError(what);
    peak = std::max(peak, taken_ += bytes);
    return absl::OkStatus();
  }
  void give_back(std::uint64_t bytes) override { taken_ -= bytes; }
  std::uint64_t most() const override { return most_; }

  std::uint64_t peak = 0;

 private:
  const std::uint64_t most_;
  std::uint64_t taken_ = 0;
};

TEST(RemeshMemory, IsNoMoreThanIsAskedFor) {
  const TriangleMesh ball = testing::make_mesh(testing::icosphere(6)), little = testing::make_mesh(testing::icosphere(2));
  for (const auto& [shape, n] : {std::pair(&ball, 1'000u), std::pair(&ball, 100'000u), std::pair(&little, 200'000u)}) {
    for (const RemeshOptions& options : {RemeshOptions(), RemeshOptions{.fit = true, .feature_degrees = 30}}) {
      const std::vector<FacePlace> places = testing::random_places(*shape, n);
      Source source(std::uint64_t{1} << 50);
      const testing::CountedMemory memory;
      ASSERT_TRUE(remesh(*shape, places, options, {.threads = 2, .memory = &source}).ok());
      const auto peak = static_cast<double>(memory.peak()), told = static_cast<double>(source.peak);
      std::printf("%zu faces, %u points: took %.1f MB, told %.1f MB, %.2f times\n", shape->face_count(), n, peak / 1e6,
                  told / 1e6, told / peak);
      EXPECT_LE(peak, told);
      EXPECT_LE(told, 4 * peak + (1 << 20));
    }
  }
}

TEST(RemeshMemory, ThatIsNotThereIsRefused) {
  const TriangleMesh ball = testing::make_mesh(testing::icosphere(2));
  Source source(1'000);
  const absl::Status refused = remesh(ball, testing::random_places(ball, 100), {}, {.memory = &source}).status();
  EXPECT_EQ(refused.code(), absl::StatusCode::kResourceExhausted);
  EXPECT_NE(refused.message().find("a mesh of 100 points on 320 triangles takes"), std::string::npos) << refused;
}

}  // namespace
}  // namespace curvecast
