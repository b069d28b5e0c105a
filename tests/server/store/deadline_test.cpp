#include "server/store/deadline.h"

#include <gtest/gtest.h>

#include <thread>

namespace curvecast::server {
namespace {

using std::chrono::hours;
using std::chrono::milliseconds;
using std::chrono::seconds;

TEST(Deadline, IsOverAfterItsTime) {
  EXPECT_EQ(Deadline(hours(1), nullptr).check(), absl::OkStatus());
  const absl::Status status = Deadline(seconds(0), nullptr).check();
  EXPECT_TRUE(absl::IsUnavailable(status)) << status;
}

TEST(Deadline, IsCancelled) {
  std::atomic<bool> cancel = false;
  const Deadline deadline(hours(1), &cancel);
  EXPECT_EQ(deadline.check(), absl::OkStatus());
  cancel = true;
  EXPECT_TRUE(absl::IsCancelled(deadline.check()));
}

TEST(Deadline, HasTimeForBytesOnce) {
  Deadline deadline(seconds(0), nullptr);
  deadline.allow(99, 100);
  EXPECT_FALSE(deadline.check().ok()) << "less than a second's";
  deadline.allow(360'000, 100);
  EXPECT_EQ(deadline.check(), absl::OkStatus());
  Deadline twice(-hours(2), nullptr);
  twice.allow(3600 * 100, 100);
  twice.allow(3600 * 100, 100);
  twice.allow(3600 * 150, 100);
  EXPECT_FALSE(twice.check().ok()) << "the same bytes again";
  twice.allow(3600 * 201, 100);
  EXPECT_EQ(twice.check(), absl::OkStatus());
}

TEST(Deadline, BelievesNoAbsurdLength) {
  Deadline deadline(-hours(13), nullptr);
  deadline.allow(~std::uint64_t{0}, 1);
  EXPECT_FALSE(deadline.check().ok());
}

TEST(Deadline, SleepsUntilThereIsNoReasonTo) {
  EXPECT_EQ(Deadline(hours(1), nullptr).sleep(milliseconds(10)), absl::OkStatus());
  EXPECT_TRUE(absl::IsUnavailable(Deadline(milliseconds(10), nullptr).sleep(hours(1))));
  std::atomic<bool> cancel = false;
  std::thread canceller([&] {
    std::this_thread::sleep_for(milliseconds(50));
    cancel = true;
  });
  EXPECT_TRUE(absl::IsCancelled(Deadline(hours(1), &cancel).sleep(hours(1))));
  canceller.join();
}

}  // namespace
}  // namespace curvecast::server
