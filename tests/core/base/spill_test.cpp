#include "core/base/spill.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace curvecast {
namespace {

constexpr std::size_t kBound = std::size_t{64} << 20, kBlock = std::size_t{16} << 20;

std::vector<std::uint64_t> block_of(std::uint64_t first) {
  std::vector<std::uint64_t> block(kBlock / sizeof(std::uint64_t));
  for (std::uint64_t& value : block) value = first++;
  return block;
}

/// The bytes that this process keeps in memory, of files too.
std::uint64_t resident_bytes() {
  std::uint64_t total = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> total >> resident;
  return resident * 4096;
}

class Spill : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(keep_memory_within(kBound, folder_.path()).ok()); }

  const testing::TemporaryFolder folder_;
};

TEST_F(Spill, KeepsWhatMemoryHasNoRoomForInAFileWithoutAName) {
  std::vector<std::vector<std::uint64_t>> blocks;
  for (std::uint64_t i = 0; i < 16; ++i) blocks.push_back(block_of(i));
  EXPECT_GE(spill_usage().bytes, 12 * kBlock);
  EXPECT_LT(spill_usage().bytes, 15 * kBlock);  // some have found room
  EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
  for (std::uint64_t i = 0; i < blocks.size(); ++i) {
    EXPECT_EQ(blocks[i].front(), i);
    EXPECT_EQ(blocks[i].back(), i + kBlock / sizeof(std::uint64_t) - 1);
  }
  blocks.clear();
  EXPECT_EQ(spill_usage().bytes, 0u);
  EXPECT_GE(spill_usage().peak, 12 * kBlock);
}

TEST_F(Spill, GivesPagesBack) {
  std::vector<std::vector<std::uint64_t>> blocks;
  for (std::uint64_t i = 0; i < 32; ++i) blocks.push_back(block_of(i));
  // Nobody touches them: sooner or later they are out of memory, however slow the machine.
  while (resident_bytes() > kBound + (std::uint64_t{64} << 20)) std::this_thread::yield();
  for (std::uint64_t i = 0; i < blocks.size(); ++i) EXPECT_EQ(blocks[i], block_of(i)) << i;
}

TEST_F(Spill, AlignsAndReusesItsPlaces) {
  std::vector<std::uint64_t> filler = block_of(0), more = block_of(1), rest = block_of(2);
  for (int round = 0; round < 100; ++round) {
    constexpr std::align_val_t kAlignment{std::size_t{2} << 20};
    void* const block = ::operator new(kBlock, kAlignment);
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(block) % (std::size_t{2} << 20), 0u);
    const auto many = std::make_unique<char[]>(kLeastSpill + 1);
    static_cast<char*>(block)[kBlock - 1] = many[kLeastSpill] = 1;
    ::operator delete(block, kAlignment);
  }
  EXPECT_LE(spill_usage().bytes, 3 * kBlock);
}

TEST_F(Spill, LeavesSmallBlocksInMemory) {
  const std::uint64_t before = spill_usage().bytes;
  std::vector<std::unique_ptr<char[]>> small;
  for (int i = 0; i < 1000; ++i) small.push_back(std::make_unique<char[]>(kLeastSpill / 2));
  EXPECT_EQ(spill_usage().bytes, before);
}

TEST_F(Spill, SaysThatTheDiskIsFull) {
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  rlimit little = before;
  little.rlim_cur = 8 * kBlock;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &little), 0);
  std::vector<std::vector<std::uint64_t>> blocks;
  std::string message;
  try {
    for (std::uint64_t i = 0; i < 100; ++i) blocks.push_back(block_of(i));
  } catch (const SpillError& error) {
    message = error.what();
  }
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  EXPECT_EQ(message, "the disk is full: the cache folder, or that for temporary files, holds what --memory leaves no room for");
  EXPECT_GT(blocks.size(), 4u);
  blocks.clear();
  EXPECT_EQ(spill_usage().bytes, 0u);
  blocks.assign(8, block_of(7));  // there is room again
  EXPECT_EQ(blocks.back(), block_of(7));
}

TEST_F(Spill, ServesManyThreads) {
  const std::vector<std::uint64_t> filler = block_of(0), more = block_of(1);
  std::vector<std::jthread> threads;
  for (std::uint64_t t = 0; t < 4; ++t) {
    threads.emplace_back([t] {
      for (std::uint64_t i = 0; i < 20; ++i) EXPECT_EQ(block_of(t + i).back(), t + i + kBlock / sizeof(std::uint64_t) - 1);
    });
  }
}

}  // namespace
}  // namespace curvecast
