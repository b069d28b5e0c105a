#include "core/base/hash_buckets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "core/base/mutex.h"
#include "core/base/random.h"

namespace curvecast {
namespace {

/// Some things of each hash; those of one come in the same bucket.
void expect_buckets(std::size_t n, std::uint64_t hashes) {
  const auto hash_of = [&](std::size_t i) { return mix_bits(mix_bits(i) % hashes); };
  Mutex mutex;
  std::vector<int> seen(n, 0);
  std::map<std::uint64_t, const std::uint32_t*> bucket_of_hash;
  for_each_bucket({}, n, hash_of, [&](std::span<const std::uint32_t> bucket) {
    const MutexLock lock(mutex);
    EXPECT_TRUE(std::is_sorted(bucket.begin(), bucket.end()));
    for (const std::uint32_t i : bucket) {
      ++seen[i];
      EXPECT_EQ(bucket_of_hash.emplace(hash_of(i), bucket.data()).first->second, bucket.data());
    }
    if (hashes > n) {
      EXPECT_LT(bucket.size(), 40'000u) << "evenly divided";
    }
  });
  EXPECT_EQ(seen, std::vector<int>(n, 1));
}

TEST(HashBuckets, TakeEachThingOnceAndKeepEqualOnesTogether) {
  for (const std::size_t n : {0u, 1u, 100u, 16'383u, 16'384u, 50'000u, 600'000u}) {
    for (const std::uint64_t hashes : {1u, 7u, 5'000u, 10'000'000u}) expect_buckets(n, hashes);
  }
}

TEST(HashBuckets, BeginNoneOnceCancelled) {
  const std::atomic<bool> cancel = true;
  for_each_bucket(
      {.on_progress = {}, .cancel = &cancel}, 100'000, [](std::size_t i) { return mix_bits(i); },
      [](std::span<const std::uint32_t> /*bucket*/) { FAIL(); });
}

}  // namespace
}  // namespace curvecast
