#include "core/base/memory_claim.h"

#include <gtest/gtest.h>

#include "tests/support/counting_source.h"

namespace curvecast {
namespace {

TEST(MemoryClaim, TakesTheDifferenceAndGivesAllBack) {
  testing::CountingSource source(100);
  const ExecutionContext context{.memory = &source};
  {
    MemoryClaim a(context), b(context);
    EXPECT_TRUE(a.set(60, "a").ok());
    EXPECT_TRUE(b.set(20, "b").ok());
    EXPECT_TRUE(a.set(80, "a").ok());
    EXPECT_EQ(source.taken(), 100u);
    EXPECT_EQ(b.set(21, "twenty-one").message(), "twenty-one");
    EXPECT_EQ(b.bytes(), 20u) << "as before";
    EXPECT_TRUE(a.set(10, "a").ok());
    EXPECT_EQ(source.taken(), 30u);
  }
  EXPECT_EQ(source.taken(), 0u);
}

TEST(MemoryClaim, TakesAllWhereNobodyCounts) {
  MemoryClaim claim{ExecutionContext()};
  EXPECT_TRUE(claim.set(std::uint64_t{1} << 60, "everything").ok());
}

TEST(MemoryClaim, DescribesBytesAsPeopleDo) {
  EXPECT_EQ(describe_bytes(0), "0 bytes");
  EXPECT_EQ(describe_bytes(999), "999 bytes");
  EXPECT_EQ(describe_bytes(1000), "1.0 kB");
  EXPECT_EQ(describe_bytes(9'960), "10 kB");
  EXPECT_EQ(describe_bytes(999'600), "1.0 MB");
  EXPECT_EQ(describe_bytes(17.2e9), "17 GB");
  EXPECT_EQ(describe_bytes(3e15), "3000 TB");
}

}  // namespace
}  // namespace curvecast
