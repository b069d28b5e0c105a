#include "server/base/spare_memory.h"

#include <gtest/gtest.h>
#include <malloc.h>

#include <chrono>
#include <memory>
#include <vector>

#include "server/base/process_usage.h"

namespace curvecast::server {
namespace {

using Block = std::unique_ptr<char[]>;

constexpr std::size_t kBlock = 1000, kBlocks = 64'000;  // 64 MB
constexpr std::uint64_t kMegabyte = 1'000'000;

/// Takes memory in small blocks.
std::vector<Block> take_some() {
  std::vector<Block> blocks;
  for (std::size_t i = 0; i < kBlocks; ++i) {
    blocks.push_back(std::make_unique<char[]>(kBlock));
    blocks.back()[0] = blocks.back()[kBlock / 2] = 1;
  }
  return blocks;
}

/// ... and frees all but the last one, which keeps the heap from shrinking by itself.
Block leave_some_behind() { return std::move(take_some().back()); }

class SpareMemoryTest : public ::testing::Test {
 protected:
  void SetUp() override {
    if (::mallinfo2().arena == 0) GTEST_SKIP() << "this allocator is not the one that is meant";
    spare_.give_back(time_);
    before_ = anonymous_bytes();
  }

  std::chrono::steady_clock::time_point time_ = std::chrono::steady_clock::now();
  SpareMemory spare_;
  std::uint64_t before_ = 0;
};

TEST_F(SpareMemoryTest, IsGivenBackNowAndThen) {
  const Block pin = leave_some_behind();
  ASSERT_GT(anonymous_bytes(), before_ + 50 * kMegabyte);
  spare_.give_back(time_ + std::chrono::hours(1));
  EXPECT_LT(anonymous_bytes(), before_ + 10 * kMegabyte);

  const Block second_pin = leave_some_behind();
  spare_.give_back(time_ + std::chrono::hours(1) + std::chrono::seconds(1));
  EXPECT_GT(anonymous_bytes(), before_ + 50 * kMegabyte) << "given back at once, again";
  spare_.give_back(time_ + std::chrono::hours(2));
  EXPECT_LT(anonymous_bytes(), before_ + 10 * kMegabyte);
}

TEST_F(SpareMemoryTest, MuchIsGivenBackSoon) {
  const Block pin = leave_some_behind();
  spare_.give_back(time_ += std::chrono::hours(1));
  std::vector<std::vector<Block>> taken;
  for (int i = 0; i < 3; ++i) taken.push_back(take_some());
  const Block second_pin = std::move(taken.back().back());
  taken.clear();
  ASSERT_GT(anonymous_bytes(), before_ + 150 * kMegabyte);
  spare_.give_back(time_ += std::chrono::seconds(1));
  EXPECT_LT(anonymous_bytes(), before_ + 10 * kMegabyte);
}

TEST_F(SpareMemoryTest, WhatIsFreedLaterIsGivenBackLater) {
  std::vector<Block> blocks = take_some();
  for (int i = 0; i < 100; ++i) spare_.give_back(time_ += std::chrono::seconds(10));
  ASSERT_GT(anonymous_bytes(), before_ + 50 * kMegabyte);
  const Block pin = std::move(blocks.back());
  blocks.clear();
  for (int i = 0; i < 20; ++i) spare_.give_back(time_ += std::chrono::seconds(10));
  EXPECT_LT(anonymous_bytes(), before_ + 10 * kMegabyte);
}

}  // namespace
}  // namespace curvecast::server
