#include "client/bench/peers/simplification_chain.h"

#include <gmock/gmock.h>

#include "tests/support/shapes.h"

namespace curvecast::cli::bench {
namespace {

using ::testing::Each;
using ::testing::Gt;
using ::testing::IsEmpty;

TEST(SimplificationChain, HalvesDownToAFew) {
  const TriangleMesh mesh = curvecast::testing::make_mesh(curvecast::testing::icosphere(5));
  const std::vector<std::size_t> levels = simplification_chain(mesh, 500);
  ASSERT_GE(levels.size(), 5u);
  std::size_t before = mesh.face_count();
  for (const std::size_t faces : levels) {
    EXPECT_LE(faces, before / 2);
    EXPECT_GE(faces, before / 2 - 4);
    before = faces;
  }
  EXPECT_LE(levels.back(), 500u);
  EXPECT_THAT(levels, Each(Gt(200u)));
}

TEST(SimplificationChain, EndsWhereNothingIsToBeGained) {
  EXPECT_THAT(simplification_chain(curvecast::testing::make_mesh(curvecast::testing::cube()), 500), IsEmpty());
}

}  // namespace
}  // namespace curvecast::cli::bench
