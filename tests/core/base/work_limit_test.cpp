#include "core/base/work_limit.h"

#include <gtest/gtest.h>

#include "core/base/execution_context.h"

namespace curvecast {
namespace {

using Nanoseconds = WorkLimit::Nanoseconds;

TEST(WorkLimit, IsSpentByAllTogether) {
  WorkLimit limit(Nanoseconds(10));
  const ExecutionContext context{.limit = &limit};
  limit.spend(Nanoseconds(4));
  limit.spend(Nanoseconds(5));
  EXPECT_TRUE(context.check_limit().ok());
  limit.spend(Nanoseconds(1));
  EXPECT_TRUE(limit.is_spent());
  EXPECT_EQ(context.check_limit().code(), absl::StatusCode::kDeadlineExceeded);
  EXPECT_TRUE(context.check().ok()) << "only who asks for it is bound by it";
}

TEST(WorkLimit, IsChargedWhatAThreadTakes) {
  WorkLimit limit(std::chrono::microseconds(1));
  WorkLimit::Meter meter(&limit);
  while (!limit.is_spent()) meter.settle();
  WorkLimit::Meter(nullptr).settle();
}

}  // namespace
}  // namespace curvecast
