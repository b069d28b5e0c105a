#include "core/base/for_all.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstddef>
#include <vector>

namespace curvecast {
namespace {

TEST(ForBlocks, TakesEachThingOnce) {
  for (const std::size_t n : {0u, 1u, 9u, 10u, 11u, 1'000u}) {
    std::vector<int> seen(n, 0), in_turn(n, 0);
    for_blocks({}, n, 10, [&](std::size_t begin, std::size_t end) {
      EXPECT_EQ(begin % 10, 0u);
      EXPECT_TRUE(begin < end && end - begin <= 10 && end <= n);
      for (std::size_t i = begin; i < end; ++i) ++seen[i];
    });
    std::size_t next = 0;
    for_blocks_in_turn({}, n, 10, [&](std::size_t begin, std::size_t end) {
      EXPECT_EQ(begin, next);
      next = end;
      for (std::size_t i = begin; i < end; ++i) ++in_turn[i];
    });
    EXPECT_EQ(seen, std::vector<int>(n, 1));
    EXPECT_EQ(in_turn, std::vector<int>(n, 1));
  }
}

TEST(ForBlocks, BeginsNoBlockOnceCancelled) {
  std::atomic<bool> cancel = false;
  std::atomic<int> begun = 0;
  const ExecutionContext context{.on_progress = {}, .cancel = &cancel};
  for_blocks_in_turn(context, 1'000, 1, [&](std::size_t i, std::size_t /*end*/) {
    ++begun;
    if (i == 4) cancel = true;
  });
  EXPECT_EQ(begun, 5);
  for_blocks(context, 1'000, 1, [&](std::size_t /*begin*/, std::size_t /*end*/) { ++begun; });
  EXPECT_EQ(begun, 5);
  cancel = false;
  for_blocks(context, 100'000, 1, [&](std::size_t /*begin*/, std::size_t /*end*/) {
    ++begun;
    cancel = true;
  });
  EXPECT_LT(begun, 5 + 1'000) << "each thread may have begun one";
}

}  // namespace
}  // namespace curvecast
