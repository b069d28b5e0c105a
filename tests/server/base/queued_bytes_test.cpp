#include "server/base/queued_bytes.h"

#include <gtest/gtest.h>

namespace curvecast::server {
namespace {

constexpr absl::StatusCode kOk = absl::StatusCode::kOk, kRefused = absl::StatusCode::kResourceExhausted;

TEST(QueuedBytes, WhoDoesNotReadIsRefusedNotTheOthers) {
  QueuedBytes queued(1600);
  queued.add("lazy", 700);
  EXPECT_EQ(queued.check("lazy").code(), kOk) << "as long as nobody else wants it";
  EXPECT_FALSE(queued.is_half_full());
  queued.add("lazy", 101);
  EXPECT_TRUE(queued.is_half_full());
  EXPECT_EQ(queued.check("lazy").code(), kRefused);
  EXPECT_EQ(queued.check("polite").code(), kOk);
  queued.add("polite", 100);
  EXPECT_EQ(queued.check("polite").code(), kOk);
  queued.add("polite", 1);
  EXPECT_EQ(queued.check("polite").code(), kRefused);
  queued.add("polite", -101);
  EXPECT_EQ(queued.check("polite").code(), kOk);
  queued.add("lazy", -800);
  EXPECT_EQ(queued.check("lazy").code(), kOk);
  EXPECT_EQ(queued.bytes(), 1u);
}

TEST(QueuedBytes, WhoHasNothingMayBeginHoweverSmallASixteenthIs) {
  QueuedBytes queued(15);
  queued.add("other", 10);
  EXPECT_EQ(queued.check("one").code(), kOk);
}

TEST(QueuedBytes, BeyondAllOfItEverybodyIsRefused) {
  QueuedBytes queued(1600);
  queued.add("a", 1601);
  EXPECT_EQ(queued.check("b").code(), kRefused);
  queued.add("a", -1);
  EXPECT_EQ(queued.check("b").code(), kOk);
}

}  // namespace
}  // namespace curvecast::server
