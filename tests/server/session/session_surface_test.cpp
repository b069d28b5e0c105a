#include "server/session/session_surface.h"

#include <gtest/gtest.h>

#include "tests/server/ball_session.h"

namespace curvecast::server {
namespace {

TEST(SessionSurface, LiesBelowItsOwnCurveOnly) {
  const std::shared_ptr<Session> session = make_session(100);
  const std::shared_ptr<const SurfaceCurve> own = session->curve();
  const auto leaves = session->surface->leaves(own);
  ASSERT_TRUE(leaves.ok()) << leaves.status();
  EXPECT_EQ(*leaves, *session->surface->leaves(own)) << "made once";
  auto other = std::make_shared<SurfaceCurve>();
  other->disc_begin = own->disc_begin;
  EXPECT_TRUE(session->surface->leaves(other).ok());
  other->scalars.push_back({"heat", {}});
  EXPECT_TRUE(absl::IsDataLoss(session->surface->leaves(other).status())) << "of another mesh, which has a named value";
  other->scalars.clear();
  other->disc_begin.push_back(own->disc_begin.back());
  EXPECT_TRUE(absl::IsDataLoss(session->surface->leaves(other).status())) << "with another disc";
  EXPECT_TRUE(absl::IsUnavailable(SessionSurface().leaves(own).status()));
}

}  // namespace
}  // namespace curvecast::server
